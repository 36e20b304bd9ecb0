#pragma once

#include <algorithm>

#include "hal/port/can.h"

namespace koboshi::sim_board {

// Fault confinement of one CAN controller (ISO 11898-1, "Fault confinement"): transmit and receive error
// counts and the state that follows from them.
class ErrorCounters {
 public:
  hal::CanErrorState state() const {
    if (transmit_ > 255) return hal::CanErrorState::kBusOff;
    return transmit_ > 127 || receive_ > 127 ? hal::CanErrorState::kErrorPassive
                                             : hal::CanErrorState::kErrorActive;
  }
  bool error_passive() const { return state() == hal::CanErrorState::kErrorPassive; }
  bool bus_off() const { return state() == hal::CanErrorState::kBusOff; }
  // The counts saturate at 255. Receive overruns are zero: the owner of the receive ring counts them.
  hal::CanStatus status() const {
    return {.state = state(),
            .transmit_error_count = static_cast<std::uint8_t>(std::min(transmit_, 255)),
            .receive_error_count = static_cast<std::uint8_t>(receive_),
            .receive_overruns = 0};
  }
  int transmit() const { return transmit_; }
  int receive() const { return receive_; }

  void on_transmitted() { transmit_ = std::max(transmit_ - 1, 0); }
  void on_received() { receive_ = receive_ > 127 ? 127 : std::max(receive_ - 1, 0); }
  void on_transmit_error() { transmit_ = std::min(transmit_ + 8, 256); }
  // An error-passive node without an acknowledgement keeps its count: alone on the bus, it must not go
  // bus-off.
  void on_missing_acknowledge() {
    if (!error_passive()) on_transmit_error();
  }
  void on_receive_error() { receive_ = std::min(receive_ + 1, 128); }
  // Counts eight more consecutive dominant bits after an error flag.
  void on_dominant_bits(bool transmits) {
    if (transmits) {
      on_transmit_error();
    } else {
      receive_ = std::min(receive_ + 8, 128);
    }
  }
  void reset() { transmit_ = receive_ = 0; }

 private:
  int transmit_ = 0;  // 0..256
  int receive_ = 0;   // 0..128
};

}  // namespace koboshi::sim_board
