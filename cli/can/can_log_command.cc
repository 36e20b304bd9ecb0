// koboshi can stats, replay and export: what one does with a log.

#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/file/output_file.h"
#include "base/file/overwrite.h"
#include "base/file/standard_streams.h"
#include "base/text/error.h"
#include "base/text/foreign_text.h"
#include "base/text/text.h"
#include "bus/can/export.h"
#include "bus/can/source.h"
#include "bus/can/statistics.h"
#include "cli/can/frame_description.h"
#include "cli/commands.h"
#include "cli/options.h"
#include "tools/run/interrupt.h"
#include "tools/run/pacer.h"

namespace koboshi::cli {
namespace {

// --- stats

struct CanStatisticsArguments {
  bus::LogChoice log;
  double duration_s = 10.0;
  double kbit_per_s = 1000.0;
  CanOptions can;
};

// A table for each interface of a log.
void show_statistics(const CanStatisticsArguments& arguments) {
  tools::Interrupt interrupt;
  const OpenedSource opened = open_source(arguments.log, arguments.can, interrupt);
  const auto end_us = static_cast<std::uint64_t>(1e6 * arguments.duration_s);
  std::map<std::string, bus::BusStatistics> buses;
  std::uint64_t frames = 0;
  std::optional<int> signal;
  for (std::uint64_t last_us = 0; !(signal = interrupt.requested());) {
    if (opened.source->is_live() && last_us >= end_us) break;
    const auto timed = opened.source->next(end_us - std::min(last_us, end_us));
    if (!timed) {  // the end, or a signal ended the wait
      signal = interrupt.requested();
      break;
    }
    last_us = timed->time_us;
    buses[timed->interface].add(*timed);
    ++frames;
  }
  if (signal && !opened.source->is_arriving())
    throw tools::Interrupted(*signal, fmt::format("interrupted after {}", count_text(frames, "frame")));
  if (buses.empty()) buses[""];
  const char* separator = "";
  for (const auto& [interface, statistics] : buses) {
    fmt::print("{}{}{}", separator, buses.size() > 1 ? interface + ": " : "",
               bus::statistics_table(statistics, 1e3 * arguments.kbit_per_s));
    separator = "\n";
  }
  print_remarks(*opened.source);
}

void add_statistics(CLI::App& can) {
  auto arguments = std::make_shared<CanStatisticsArguments>();
  CLI::App* command =
      can.add_subcommand("stats", "Show frame rates, the bus load, and the jitter of SYNC and PDOs");
  command->footer(
      R"(On a live bus and a pipe, Ctrl-C or SIGTERM ends the measurement early: the statistics so far are shown, with
status 0. While a file is read, either is an interruption, with status 130 or 143.
)");
  CLI::Option* log = add_log_options(*command, arguments->log, kLogOrBusHelp);
  command->add_option("--duration", arguments->duration_s, "Seconds to listen to a live bus (default: 10)")
      ->check(CLI::Range(0.1, 86400.0))
      ->excludes(log);
  command->add_option("--bitrate", arguments->kbit_per_s, "Bit rate of the bus in kbit/s (default: 1000)")
      ->check(CLI::Range(1.0, 1000.0))
      ->type_name("KBIT");
  add_can_options(*command, arguments->can, log);
  command->callback([arguments] { show_statistics(*arguments); });
}

// --- replay

struct CanReplayArguments {
  bus::LogChoice log;
  double speed = 1.0;
  CanOptions can;
};

// Sends nothing unless the whole log is readable and of one bus.
void check_before_replay(const bus::LogChoice& log) {
  const std::vector<std::string> interfaces = bus::check_log(log);
  if (log.interface.empty() && interfaces.size() > 1)
    throw InputError(log.place, 0, "frames of several buses",
                     "--bus with one of " + join_alternatives(interfaces));
}

void replay_log(const CanReplayArguments& arguments) {
  check_before_replay(arguments.log);
  const auto transport = open_can(arguments.can);
  tools::Interrupt interrupt;
  const auto source = bus::open_log(arguments.log, [&](int descriptor, std::uint64_t timeout_us) {
    return interrupt.wait_for_input(descriptor, timeout_us);
  });
  std::optional<std::uint64_t> first_us;
  std::string interface;
  tools::Pacer pacer(0, arguments.speed, tools::interruptible(interrupt));
  bus::ForeignCount skipped;
  std::uint64_t frames = 0;
  for (;;) {
    const auto timed = source->next(0);
    if (timed) {
      if (!first_us) interface = timed->interface;
      if (timed->interface != interface)  // of a pipe, which was not read before
        throw InputError(arguments.log.place, 0, "frames of " + interface + " and " + timed->interface,
                         "--bus with one of them");
      if (!first_us) first_us = timed->time_us;
      pacer.wait_for(timed->time_us - *first_us);
    }
    print_remarks(*source);  // before an hour of frames, whose times it may concern
    if (const auto signal = interrupt.requested())
      throw tools::Interrupted(*signal, fmt::format("interrupted after {}", count_text(frames, "frame")));
    if (!timed) break;
    if (timed->standard() == nullptr) {
      skipped.add(timed->frame);
      continue;
    }
    bus::send_surely(*transport, *timed->standard());
    ++frames;
  }
  fmt::print("{} frames sent\n", frames);
  if (!skipped.empty()) print_error("koboshi: not sent: {}\n", skipped.text());
}

void add_replay(CLI::App& can) {
  auto arguments = std::make_shared<CanReplayArguments>();
  CLI::App* command = can.add_subcommand("replay", "Send the frames of a log with their timing");
  command->footer("Ctrl-C ends it early with status 130, SIGTERM with 143.\n");
  add_log_options(*command, arguments->log, kLogHelp)->required();
  command->add_option("--speed", arguments->speed, "Speed relative to the log (default: 1)")
      ->check(CLI::Range(0.01, 1000.0));
  add_can_options(*command, arguments->can);
  command->callback([arguments] { replay_log(*arguments); });
}

// --- export

struct CanExportArguments {
  bus::LogChoice log;
  std::filesystem::path out;
  std::filesystem::path robot;
};

void write_export(const CanExportArguments& arguments) {
  const std::string extension = extension_of(arguments.out);
  if (extension != ".csv" && extension != ".asc")
    throw InputError("--out", 0, one_line(arguments.out.string()), "a file with the extension .csv or .asc");
  bus::check_log(arguments.log);
  refuse_to_overwrite({arguments.log.place, arguments.log.place / "can.log"}, arguments.out);
  const bus::Network network = network_of(arguments.robot);
  tools::Interrupt interrupt;
  const OpenedSource opened = open_source(arguments.log, {}, interrupt);
  OutputFile file(arguments.out);
  FollowedBlocks blocks;
  bus::AscWriter asc;
  const bool is_csv = extension == ".csv";
  file.write(is_csv ? bus::csv_head() : bus::AscWriter::head());
  std::uint64_t frames = 0;
  std::uint64_t omitted = 0;
  for (;;) {
    const auto timed = opened.source->next(0);
    if (const auto signal = interrupt.requested())
      throw tools::Interrupted(*signal, fmt::format("interrupted after {}", count_text(frames, "frame")));
    if (!timed) break;
    const bool is_segment = blocks.follow(*timed);
    const std::string line = is_csv
                                 ? bus::csv_row(*timed, frame_description(timed->frame, network, is_segment))
                                 : asc.line(*timed);
    ++(line.empty() ? omitted : frames);
    file.write(line);
  }
  file.close();
  fmt::print("{} in {}\n", count_text(frames, "frame"), arguments.out.string());
  print_remarks(*opened.source);
  if (omitted > 0) warn(fmt::format("{} of CAN XL left out", count_text(omitted, "frame")));
}

void add_export(CLI::App& can) {
  auto arguments = std::make_shared<CanExportArguments>();
  CLI::App* command = can.add_subcommand("export", "Convert a log for other programs");
  command->footer(
      R"(The extension of --out selects the kind:
  .csv  a table: time, interface, identifier, data, and each frame in words
  .asc  Vector's ASCII format, for CANalyzer, SavvyCAN and asc2log, with the times of the log

Examples:
  koboshi can export runs/walk --out walk.csv
  koboshi can export runs/walk --out walk.asc
)");
  add_log_options(*command, arguments->log, kLogHelp)->required();
  command->add_option("-o,--out", arguments->out, "The file to write")->required()->type_name("FILE");
  command->add_option(
      "--robot", arguments->robot,
      "Robot that names the PDOs (default: Koboshi, from the repository of this folder or of the program)");
  command->callback([arguments] { write_export(*arguments); });
}

}  // namespace

void add_can_log_commands(CLI::App& can, Invocation&) {
  add_statistics(can);
  add_replay(can);
  add_export(can);
}

}  // namespace koboshi::cli
