#include "tools/cli/commands.h"

#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "firmware/canopen/frame.h"
#include "tools/can/frame_text.h"
#include "tools/can/source.h"
#include "tools/can/statistics.h"
#include "tools/cli/options.h"
#include "tools/run/interrupt.h"
#include "tools/run/pacer.h"

namespace koboshi::tools {
namespace {

using canopen::NmtCommand;

void add_send(CLI::App& can) {
  struct Arguments {
    std::vector<std::string> frames;
    CanOptions can;
  };
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command =
      can.add_subcommand("send", fmt::format("Send frames: {}, 000#0110, 123#R", kSampleFrame));
  command->add_option("FRAME", arguments->frames, "ID#DATA in hexadecimal, as for cansend")->required();
  add_can_options(*command, arguments->can);
  command->callback([arguments] {
    std::vector<hal::CanFrame> frames;
    for (const std::string& text : arguments->frames) frames.push_back(parse_frame(text));
    const auto transport = open_can(arguments->can);
    for (const hal::CanFrame& frame : frames) send_surely(*transport, frame);
  });
}

void add_nmt(CLI::App& can) {
  struct Arguments {
    std::string order;
    std::string node;
    CanOptions can;
  };
  static const std::map<std::string, NmtCommand> kOrders{
      {"start", NmtCommand::kStart},
      {"stop", NmtCommand::kStop},
      {"pre-operational", NmtCommand::kEnterPreOperational},
      {"reset", NmtCommand::kResetNode},
      {"reset-communication", NmtCommand::kResetCommunication}};
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command = can.add_subcommand("nmt", "Change the NMT state of a node, or of all nodes");
  std::vector<std::string> names;
  for (const auto& [name, order] : kOrders) names.push_back(name);
  command
      ->add_option("COMMAND", arguments->order, "start, stop, pre-operational, reset or reset-communication")
      ->required()
      ->check(CLI::IsMember(names));
  command->add_option("NODE", arguments->node, "1 to 127, decimal, or all")->required();
  add_can_options(*command, arguments->can);
  command->callback([arguments] {
    const std::uint8_t node = arguments->node == "all" ? std::uint8_t{0} : parse_node(arguments->node);
    const canopen::NmtMessage message{kOrders.at(arguments->order), node};
    send_surely(*open_can(arguments->can), canopen::encode(message));
  });
}

void add_statistics(CLI::App& can) {
  struct Arguments {
    std::filesystem::path log;
    double duration_s = 10.0;
    CanOptions can;
  };
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command =
      can.add_subcommand("stats", "Show frame rates, the bus load, and the jitter of SYNC and PDOs");
  CLI::Option* log = command->add_option(
      "LOG", arguments->log, "A log of candump -L or the folder of a run (default: the live bus)");
  command->add_option("--duration", arguments->duration_s, "Seconds to listen to a live bus (default: 10)")
      ->check(CLI::Range(0.1, 86400.0))
      ->excludes(log);
  add_can_options(*command, arguments->can, log);
  command->callback([arguments] {
    const OpenedSource opened = open_source(arguments->log, arguments->can);
    const auto end_us = static_cast<std::uint64_t>(1e6 * arguments->duration_s);
    Interrupt interrupt;
    BusStatistics statistics;
    for (std::uint64_t last_us = 0; !interrupt.requested();) {
      if (opened.source->is_live() && last_us >= end_us) break;
      const auto timed = opened.source->next(end_us - std::min(last_us, end_us));
      if (!timed) break;
      last_us = timed->time_us;
      statistics.add(*timed);
    }
    fmt::print("{}", statistics_table(statistics));
  });
}

void add_replay(CLI::App& can) {
  struct Arguments {
    std::filesystem::path log;
    double speed = 1.0;
    CanOptions can;
  };
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command = can.add_subcommand("replay", "Send the frames of a log with their timing");
  command->add_option("LOG", arguments->log, "A log of candump -L, or the folder of a run")->required();
  command->add_option("--speed", arguments->speed, "Speed relative to the log (default: 1)")
      ->check(CLI::Range(0.01, 1000.0));
  add_can_options(*command, arguments->can);
  command->callback([arguments] {
    const auto source = open_log(arguments->log);
    const auto transport = open_can(arguments->can);
    Interrupt interrupt;
    std::optional<std::uint64_t> first_us;
    Pacer pacer(0, arguments->speed);
    std::uint64_t frames = 0;
    while (const auto timed = source->next(0)) {
      if (interrupt.requested()) break;
      if (!first_us) first_us = timed->time_us;
      pacer.wait_for(timed->time_us - *first_us);
      send_surely(*transport, timed->frame);
      ++frames;
    }
    fmt::print("{} frames sent\n", frames);
  });
}

}  // namespace

void add_can_command(CLI::App& program, Invocation& invocation) {
  CLI::App* can = program.add_subcommand("can", "Watch a CAN bus and talk to it");
  can->require_subcommand(1);
  can->footer(fmt::format(
      R"(Numbers: identifiers, indices, sub-indices and data are hexadecimal, as candump writes them;
nodes and values are decimal. The prefix 0x means hexadecimal everywhere; an ambiguous number is
refused (sub-index 10: write 0x10 or 0xA).

Examples:
  koboshi can dump runs/walk                        the log of a run, decoded
  koboshi can dump --can socketcan:vcan0 --node 16
  koboshi can send {:<32} tells the controller to enable the drives
  koboshi can sdo read 1 1008
  koboshi can nmt start all
  koboshi can stats runs/walk
  koboshi can replay runs/walk/can.log --can udp:239.74.163.2:43113
)",
      kSampleFrame));
  add_can_dump_command(*can, invocation);
  add_send(*can);
  add_can_sdo_command(*can, invocation);
  add_nmt(*can);
  add_statistics(*can);
  add_replay(*can);
}

}  // namespace koboshi::tools
