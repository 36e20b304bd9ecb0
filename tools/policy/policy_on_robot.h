#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "bus/can/sdo_transfer.h"
#include "sim_board/can/transport/transport.h"

namespace koboshi::tools {

// The policy of a robot on the bus, by the controller's objects 0x2420 to 0x2422. All functions block; they
// throw SdoAborted, and NoSdoAnswer if the controller does not answer.
class PolicyOnRobot {
 public:
  // The transport must outlive this.
  explicit PolicyOnRobot(sim_board::Transport& transport);

  // Stores an image and reads it back. Throws std::runtime_error if the robot returns other bytes, and with
  // the reason if it refuses the policy.
  void upload(std::span<const std::byte> image);
  // Returns the image of the robot's policy.
  std::vector<std::uint8_t> download();

 private:
  bus::SdoTransfer sdo_;
};

}  // namespace koboshi::tools
