#include <charconv>
#include <stdexcept>

#include "hal/linux/interface_kind.h"
#include "sim_board/can/transport/log_transport.h"
#include "sim_board/can/transport/slcan.h"
#include "sim_board/can/transport/socketcan_transport.h"
#include "sim_board/can/transport/transport.h"
#include "sim_board/can/transport/udp_multicast.h"

namespace koboshi::sim {
namespace {

std::unique_ptr<Transport> open_socketcan(const std::string& interface, bool real_bus) {
  if (!real_bus && !hal::is_virtual_can(interface)) {
    throw std::invalid_argument(
        interface +
        " is neither vcan nor vxcan: what is sent there may move real servos; --real-bus allows it");
  }
  return std::make_unique<SocketCanTransport>(interface);
}

// GROUP:PORT
std::unique_ptr<Transport> open_udp(const std::string& place) {
  const std::size_t colon = place.rfind(':');
  std::uint16_t port = 0;
  if (colon != std::string::npos) {
    const char* const end = place.data() + place.size();
    const auto [last, error] = std::from_chars(place.data() + colon + 1, end, port);
    if (error == std::errc() && last == end && port != 0)
      return std::make_unique<UdpMulticast>(place.substr(0, colon), port);
  }
  throw std::invalid_argument("udp:" + place + " is not udp:GROUP:PORT, such as udp:239.74.163.2:43113");
}

}  // namespace

std::unique_ptr<Transport> open_transport(const std::string& name, bool real_bus) {
  if (name == "none") return nullptr;
  if (name == "slcan") return std::make_unique<Slcan>();
  const std::size_t colon = name.find(':');
  const std::string kind = name.substr(0, colon);
  const std::string place = colon == std::string::npos ? "" : name.substr(colon + 1);
  if (!place.empty()) {
    if (kind == "socketcan") return open_socketcan(place, real_bus);
    if (kind == "udp") return open_udp(place);
    if (kind == "log") return std::make_unique<LogTransport>(place);
  }
  throw std::invalid_argument("found the CAN transport '" + name +
                              "', expected none, socketcan:INTERFACE, udp:GROUP:PORT, slcan or log:FILE");
}

}  // namespace koboshi::sim
