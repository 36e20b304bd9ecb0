#pragma once

#include <cstdint>

#include "sim_board/can/bus.h"

namespace koboshi::sim_board {

// Recovers a simulated node from bus-off after a pause, so that a defective transceiver cannot fill the bus
// with error frames. The pause equals the usual `ip link set can0 type can restart-ms` of Linux users.
class BusOffPause {
 public:
  static constexpr std::uint64_t kPause_us = 100'000;

  // Checks the node's status and recovers it after the pause. Returns true if the node has entered bus-off
  // since the last call.
  bool step(Bus& bus, NodeHandle node, const hal::CanStatus& status, std::uint64_t now_us) {
    const bool was_off = off_;
    off_ = status.state == hal::CanErrorState::kBusOff;
    if (off_ && !was_off) since_us_ = now_us;
    if (off_ && now_us - since_us_ >= kPause_us) bus.recover(node);
    return off_ && !was_off;
  }

 private:
  bool off_ = false;
  std::uint64_t since_us_ = 0;
};

}  // namespace koboshi::sim_board
