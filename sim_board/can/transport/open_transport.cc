#include <charconv>
#include <stdexcept>

#include "hal/linux/interface_kind.h"
#include "sim_board/can/transport/log_transport.h"
#include "sim_board/can/transport/slcan.h"
#include "sim_board/can/transport/socketcan_transport.h"
#include "sim_board/can/transport/transport.h"
#include "sim_board/can/transport/udp_multicast.h"

namespace koboshi::sim_board {
namespace {

std::unique_ptr<Transport> open_socketcan(const std::string& interface, bool real_bus) {
  if (!real_bus && !hal::is_virtual_can(interface)) {
    throw std::invalid_argument(
        interface +
        " is neither vcan nor vxcan: what is sent there may move real servos; --real-bus allows it");
  }
  return std::make_unique<SocketCanTransport>(interface);
}

// GROUP:PORT, with an IPv6 group in brackets.
std::unique_ptr<Transport> open_udp(const std::string& place, const TransportOptions& options) {
  const std::size_t colon = place.rfind(':');
  std::uint16_t port = 0;
  if (colon != std::string::npos) {
    const char* const end = place.data() + place.size();
    const auto [last, error] = std::from_chars(place.data() + colon + 1, end, port);
    std::string group = place.substr(0, colon);
    const bool bracketed = group.size() > 2 && group.front() == '[' && group.back() == ']';
    if (bracketed) group = group.substr(1, group.size() - 2);
    const bool is_group = bracketed == (group.find(':') != std::string::npos);
    if (error == std::errc() && last == end && port != 0 && is_group) {
      return std::make_unique<UdpMulticast>(
          group, port, UdpOptions{.ttl = options.ttl.value_or(0), .interface = options.interface});
    }
  }
  throw std::invalid_argument("udp:" + place + " is not udp:GROUP:PORT, such as udp:239.74.163.2:43113");
}

std::invalid_argument not_of_udp(const std::string& option, const std::string& name) {
  return std::invalid_argument("found " + option + " with the CAN transport '" + name +
                               "', expected udp:GROUP:PORT");
}

}  // namespace

std::unique_ptr<Transport> open_transport(const std::string& name, const TransportOptions& options) {
  const bool udp = name.starts_with("udp:");
  if (options.ttl && !udp) throw not_of_udp("--ttl", name);
  if (!options.interface.empty() && !udp) throw not_of_udp("--interface", name);
  if (name == "none") return nullptr;
  if (name == "slcan") return std::make_unique<Slcan>();
  const std::size_t colon = name.find(':');
  const std::string kind = name.substr(0, colon);
  const std::string place = colon == std::string::npos ? "" : name.substr(colon + 1);
  if (!place.empty()) {
    if (kind == "socketcan") return open_socketcan(place, options.real_bus);
    if (kind == "udp") return open_udp(place, options);
    if (kind == "log") return std::make_unique<LogTransport>(place);
  }
  throw std::invalid_argument("found the CAN transport '" + name +
                              "', expected none, socketcan:INTERFACE, udp:GROUP:PORT, slcan or log:FILE");
}

}  // namespace koboshi::sim_board
