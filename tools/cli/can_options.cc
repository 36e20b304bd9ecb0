#include "tools/cli/can_options.h"

#include <stdexcept>

#include "firmware/canopen/frame.h"
#include "tools/can/frame_text.h"

namespace koboshi::tools {

void add_can_options(CLI::App& command, CanOptions& options, CLI::Option* log) {
  CLI::Option* can = command.add_option(
      "--can", options.can,
      "The bus: socketcan:vcan0 (default) or udp:239.74.163.2:43113 (python-can's udp_multicast)");
  CLI::Option* real_bus = command.add_flag(
      "--real-bus", options.real_bus,
      "Allows an interface that is neither vcan nor vxcan. What is sent there may move real servos");
  if (log == nullptr) return;
  can->excludes(log);
  real_bus->excludes(log);
}

std::unique_ptr<sim::Transport> open_can(const CanOptions& options) {
  auto transport = sim::open_transport(options.can, options.real_bus);
  if (!transport || !transport->is_live() || options.can == "slcan")
    throw std::invalid_argument("found --can " + options.can +
                                ", expected socketcan:INTERFACE or udp:GROUP:PORT");
  return transport;
}

OpenedSource open_source(const std::filesystem::path& log, const CanOptions& options) {
  if (!log.empty()) return {nullptr, open_log(log)};
  auto transport = open_can(options);
  auto source = listen_to(*transport);
  return {std::move(transport), std::move(source)};
}

std::uint8_t parse_node(const std::string& text) {
  const auto node = static_cast<std::uint8_t>(parse_number(text, "the node", canopen::kMaxNodeId));
  if (node == 0) throw std::invalid_argument("found node 0, expected 1 to 127");
  return node;
}

}  // namespace koboshi::tools
