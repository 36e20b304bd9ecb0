#include "tools/cli/commands.h"

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

#include "tools/can/describe.h"
#include "tools/can/frame_text.h"
#include "tools/cli/options.h"
#include "tools/dictionary/network.h"
#include "tools/run/interrupt.h"

namespace koboshi::tools {
namespace {

constexpr std::uint64_t kPatience_us = 100'000;  // between two checks for Ctrl-C

struct CanDumpArguments {
  std::filesystem::path log;
  std::vector<std::string> nodes;
  std::vector<std::string> kinds;
  std::vector<std::string> identifiers;
  std::uint64_t count = 0;
  std::filesystem::path robot;
  CanOptions can;
};

const std::map<std::string, FrameKind>& kinds() {
  static const std::map<std::string, FrameKind> names{
      {"nmt", FrameKind::kNmt}, {"sync", FrameKind::kSync}, {"emcy", FrameKind::kEmergency},
      {"pdo", FrameKind::kPdo}, {"sdo", FrameKind::kSdo},   {"heartbeat", FrameKind::kHeartbeat}};
  return names;
}

// The frames that the options select; all frames without such options.
class Filter {
 public:
  explicit Filter(const CanDumpArguments& arguments) {
    for (const std::string& text : arguments.nodes) nodes_.insert(parse_node(text));
    for (const std::string& name : arguments.kinds) kinds_.insert(kinds().at(name));
    for (const std::string& text : arguments.identifiers)
      identifiers_.insert(parse_hexadecimal(text, "the identifier", 0x7FF, 3));
  }

  bool passes(const hal::CanFrame& frame) const {
    return (nodes_.empty() || nodes_.contains(node_of(frame))) &&
           (kinds_.empty() || kinds_.contains(kind_of(frame))) &&
           (identifiers_.empty() || identifiers_.contains(frame.identifier));
  }

 private:
  std::set<int> nodes_;
  std::set<FrameKind> kinds_;
  std::set<std::uint64_t> identifiers_;
};

fmt::color color_of(FrameKind kind) {
  switch (kind) {
    case FrameKind::kEmergency:
      return fmt::color::orange_red;
    case FrameKind::kNmt:
      return fmt::color::gold;
    case FrameKind::kSdo:
      return fmt::color::sky_blue;
    case FrameKind::kPdo:
      return fmt::color::light_green;
    default:
      return fmt::color::gray;
  }
}

// Decodes a PDO by the robot's object dictionaries: its name, then each value with its unit or its name.
std::string values_text(const Network& network, const hal::CanFrame& frame) {
  const Message* message = network.find(frame.identifier);
  if (message == nullptr) return {};
  std::string text = message->name + ":";
  for (const Reading& reading : decode(network, frame)) {
    text += fmt::format(" {}=", reading.signal->name);
    text += reading.name.empty() ? fmt::format("{:.6g}", reading.value) : fmt::format("'{}'", reading.name);
    if (reading.name.empty() && !reading.signal->unit.empty()) text += " " + reading.signal->unit;
  }
  return text;
}

void print(const TimedFrame& timed, const Network& network, bool colored) {
  std::string text = describe(timed.frame);
  if (text.empty()) text = values_text(network, timed.frame);
  const std::string line = fmt::format("{:12.6f}  {:<22}{}{}\n", 1e-6 * static_cast<double>(timed.time_us),
                                       frame_text(timed.frame), text.empty() ? "" : "  ", text);
  if (colored) {
    fmt::print(fmt::fg(color_of(kind_of(timed.frame))), "{}", line);
  } else {
    std::fwrite(line.data(), 1, line.size(), stdout);
  }
}

void dump(const CanDumpArguments& arguments) {
  const Filter filter(arguments);
  const Network network = network_of(arguments.robot);
  const OpenedSource opened = open_source(arguments.log, arguments.can);
  const bool colored = isatty(STDOUT_FILENO) != 0;
  Interrupt interrupt;
  for (std::uint64_t shown = 0; arguments.count == 0 || shown < arguments.count;) {
    const auto timed = opened.source->next(kPatience_us);
    if (interrupt.requested() || (!timed && !opened.source->is_live())) return;
    if (!timed) {
      std::fflush(stdout);
      continue;
    }
    if (!filter.passes(timed->frame)) continue;
    print(*timed, network, colored);
    ++shown;
  }
}

}  // namespace

void add_can_dump_command(CLI::App& can, Invocation&) {
  auto arguments = std::make_shared<CanDumpArguments>();
  CLI::App* command = can.add_subcommand("dump", "Show frames and decode them");
  CLI::Option* log = command->add_option(
      "LOG", arguments->log, "A log of candump -L or the folder of a run (default: the live bus)");
  command->add_option("--node", arguments->nodes, "Show only frames of this node; may be repeated")
      ->allow_extra_args(false);
  std::vector<std::string> names;
  for (const auto& [name, kind] : kinds()) names.push_back(name);
  command
      ->add_option("--kind", arguments->kinds,
                   "Show only nmt, sync, emcy, pdo, sdo or heartbeat; may be repeated")
      ->allow_extra_args(false)
      ->check(CLI::IsMember(names));
  command
      ->add_option("--id", arguments->identifiers,
                   "Show only this identifier, in hexadecimal; may be repeated")
      ->allow_extra_args(false);
  command->add_option(
      "--robot", arguments->robot,
      "Robot that names the PDOs (default: Koboshi, from the repository of this folder or of the program)");
  command->add_option("--count", arguments->count, "Stop after this many frames");
  add_can_options(*command, arguments->can, log);
  command->callback([arguments] { dump(*arguments); });
}

}  // namespace koboshi::tools
