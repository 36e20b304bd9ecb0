#include "base/file/standard_streams.h"
#include "cli/commands.h"

#include <fmt/color.h>
#include <fmt/core.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "base/text/text.h"
#include "bus/can/describe.h"
#include "bus/can/frame_text.h"
#include "bus/dictionary/network.h"
#include "cli/can/frame_description.h"
#include "cli/options.h"
#include "tools/run/interrupt.h"

namespace koboshi::cli {
namespace {

constexpr std::uint64_t kPatience_us = 100'000;  // of the live bus, without effect on Ctrl-C

struct CanDumpArguments {
  bus::LogChoice log;
  std::vector<std::string> nodes;
  std::vector<std::string> kinds;
  std::vector<std::string> identifiers;
  std::uint64_t count = 0;
  std::filesystem::path robot;
  CanOptions can;
};

const std::map<std::string, bus::FrameKind>& kinds() {
  static const std::map<std::string, bus::FrameKind> names{
      {"nmt", bus::FrameKind::kNmt},        {"sync", bus::FrameKind::kSync},
      {"emcy", bus::FrameKind::kEmergency}, {"pdo", bus::FrameKind::kPdo},
      {"sdo", bus::FrameKind::kSdo},        {"heartbeat", bus::FrameKind::kHeartbeat},
      {"lss", bus::FrameKind::kLss}};
  return names;
}

constexpr const char* kForeign = "foreign";
constexpr std::size_t kExtendedDigits = 8;
constexpr std::uint64_t kExtendedMark = std::uint64_t{1} << 32;  // apart from 11-bit identifiers

// An identifier of three digits has 11 bits, one of eight has 29, as for candump.
std::uint64_t parse_identifier(const std::string& text) {
  if (text.size() != kExtendedDigits) return bus::parse_hexadecimal(text, "the identifier", 0x7FF, 3);
  return kExtendedMark | bus::parse_hexadecimal(text, "the identifier", 0x1FFF'FFFF, kExtendedDigits);
}

// The frames that the options select; all frames without such options.
class Filter {
 public:
  explicit Filter(const CanDumpArguments& arguments) {
    for (const std::string& text : arguments.nodes) nodes_.insert(parse_node(text));
    for (const std::string& name : arguments.kinds) {
      if (name == kForeign) {
        foreign_ = true;
      } else {
        kinds_.insert(kinds().at(name));
      }
    }
    for (const std::string& text : arguments.identifiers) identifiers_.insert(parse_identifier(text));
  }

  bool passes(const sim_board::BusFrame& frame) const {
    return std::visit([this](const auto& one) { return passes(one); }, frame);
  }

 private:
  bool any_kind() const { return kinds_.empty() && !foreign_; }
  bool passes(const sim_board::ForeignFrame& frame) const {
    const std::uint64_t identifier = frame.identifier | (frame.extended ? kExtendedMark : 0);
    return (any_kind() || foreign_) && nodes_.empty() &&
           (identifiers_.empty() || identifiers_.contains(identifier));
  }
  bool passes(const hal::CanFrame& frame) const {
    const bool of_kind = any_kind() || kinds_.contains(bus::kind_of(frame)) || (foreign_ && frame.remote);
    return of_kind && (nodes_.empty() || nodes_.contains(bus::node_of(frame))) &&
           (identifiers_.empty() || identifiers_.contains(frame.identifier));
  }

  std::set<int> nodes_;
  std::set<bus::FrameKind> kinds_;
  bool foreign_ = false;
  std::set<std::uint64_t> identifiers_;
};

fmt::color color_of(bus::FrameKind kind) {
  switch (kind) {
    case bus::FrameKind::kEmergency:
      return fmt::color::orange_red;
    case bus::FrameKind::kNmt:
      return fmt::color::gold;
    case bus::FrameKind::kSdo:
      return fmt::color::sky_blue;
    case bus::FrameKind::kPdo:
      return fmt::color::light_green;
    default:
      return fmt::color::gray;
  }
}

fmt::color color_of(const sim_board::BusFrame& frame) {
  const auto* standard = std::get_if<hal::CanFrame>(&frame);
  return standard != nullptr ? color_of(bus::kind_of(*standard)) : fmt::color::gray;
}

// Prints frames, a line for each.
class Printer {
 public:
  // `with_interface`: the log has several.
  Printer(const bus::Network& network, bool with_interface)
      : network_(network), with_interface_(with_interface) {}

  void print(const bus::TimedFrame& timed, bool is_segment) const {
    const std::string text = frame_description(timed.frame, network_, is_segment);
    const std::string line =
        fmt::format("{:12.6f}  {}{:<22}{}{}\n", 1e-6 * static_cast<double>(timed.time_us),
                    with_interface_ ? fmt::format("{:<6} ", timed.interface) : "",
                    sim_board::frame_notation(timed.frame), text.empty() ? "" : "  ", text);
    if (colored_) {
      fmt::print(fmt::fg(color_of(timed.frame)), "{}", line);
    } else {
      std::fwrite(line.data(), 1, line.size(), stdout);
    }
  }

 private:
  const bus::Network& network_;
  bool with_interface_;
  bool colored_ = isatty(STDOUT_FILENO) != 0;
};

void dump(const CanDumpArguments& arguments) {
  const Filter filter(arguments);
  const bus::Network network = network_of(arguments.robot);
  const bool several = !arguments.log.place.empty() && arguments.log.interface.empty() &&
                       bus::interfaces_of(arguments.log).size() > 1;
  const Printer printer(network, several);
  tools::Interrupt interrupt;
  const OpenedSource opened = open_source(arguments.log, arguments.can, interrupt);
  FollowedBlocks blocks;
  bus::ForeignCount foreign;
  std::uint64_t shown = 0;
  std::optional<int> signal;
  while (arguments.count == 0 || shown < arguments.count) {
    const auto timed = opened.source->next(kPatience_us);
    signal = interrupt.requested();
    if (signal || (!timed && !opened.source->is_live())) break;
    if (!timed) continue;
    const bool is_segment = blocks.follow(*timed);  // also frames that are not shown
    if (!filter.passes(timed->frame)) continue;
    foreign.add(timed->frame);
    printer.print(*timed, is_segment);
    ++shown;
  }
  print_remarks(*opened.source);
  if (!foreign.empty()) print_error("koboshi: not decoded: {}\n", foreign.text());
  if (signal && (arguments.count > 0 || !opened.source->is_arriving()))
    throw tools::Interrupted(*signal, fmt::format("interrupted after {}", count_text(shown, "frame")));
}

}  // namespace

void add_can_dump_command(CLI::App& can, Invocation&) {
  auto arguments = std::make_shared<CanDumpArguments>();
  CLI::App* command = can.add_subcommand("dump", "Show frames and decode them");
  command->footer(
      R"(A live bus and a pipe are shown until Ctrl-C or SIGTERM, which is then the normal end, with status 0. With --count,
and for a file, either is an interruption, with status 130 or 143.
)");
  CLI::Option* log = add_log_options(*command, arguments->log, kLogOrBusHelp);
  command->add_option("--node", arguments->nodes, "Show only frames of this node; may be repeated")
      ->allow_extra_args(false)
      ->check(taken_by(parse_node));
  std::vector<std::string> names;
  for (const auto& [name, kind] : kinds()) names.push_back(name);
  names.emplace_back(kForeign);
  command
      ->add_option(
          "--kind", arguments->kinds,
          "Show only nmt, sync, emcy, pdo, sdo, heartbeat, lss or foreign (29-bit identifiers, CAN FD, "
          "remote\nand error frames); may be repeated")
      ->allow_extra_args(false)
      ->check(CLI::IsMember(names));
  command
      ->add_option("--id", arguments->identifiers,
                   "Show only this identifier, in hexadecimal; eight digits: of 29 bits; may be repeated")
      ->allow_extra_args(false);
  command->add_option(
      "--robot", arguments->robot,
      "Robot that names the PDOs (default: Koboshi, from the repository of this folder or of the program)");
  command->add_option("--count", arguments->count, "Stop after this many frames")->check(CLI::PositiveNumber);
  add_can_options(*command, arguments->can, log);
  command->callback([arguments] { dump(*arguments); });
}

}  // namespace koboshi::cli
