#pragma once

#include <deque>
#include <optional>
#include <string>

#include "hal/port/can.h"
#include "sim_board/can/transport/transport.h"

namespace koboshi::bus {

// The far end of a cable: its frames arrive in their order.
class FarEnd : public sim_board::Transport {
 public:
  void arrive(const hal::CanFrame& frame) { answers_.push_back(frame); }
  std::optional<hal::CanFrame> receive() final {
    if (answers_.empty()) return std::nullopt;
    const hal::CanFrame frame = answers_.front();
    answers_.pop_front();
    return frame;
  }
  std::string place() const final { return "a cable"; }

 protected:
  std::deque<hal::CanFrame> answers_;
};

}  // namespace koboshi::bus
