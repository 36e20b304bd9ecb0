#pragma once

#include <cstdint>

#include "firmware/canopen/node/device_services.h"
#include "firmware/canopen/node/node.h"
#include "sim_board/can/bus.h"

namespace koboshi::sim_board {

// The acceptance filter of a simulated CANopen device: its CAN controller passes on only the frames that the
// device acts on. A device must not rely on hearing of impostors and of emergency messages of other nodes.
class CanopenFilter {
 public:
  // Sets the filter if the device's communication parameters may have changed: call it after the device's
  // start and after each frame that it has taken.
  void update(Bus& bus, NodeHandle handle, const canopen::Node& node,
              const canopen::DeviceServices& services) {
    if (node.configuration() != configuration_) set(bus, handle, node, services);
  }
  // Sets it in any case: call it after the device has been restored.
  void set(Bus& bus, NodeHandle handle, const canopen::Node& node, const canopen::DeviceServices& services) {
    configuration_ = node.configuration();
    AcceptanceFilter filter;
    const auto accept = [&filter](std::uint16_t identifier) { filter.accept(identifier); };
    node.for_each_identifier(accept);
    services.for_each_identifier(accept);
    bus.set_filter(handle, filter);
  }

 private:
  std::uint32_t configuration_ = 0;  // of the node, for which the filter was set; 0: none yet
};

}  // namespace koboshi::sim_board
