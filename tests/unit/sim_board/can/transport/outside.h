#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "sim_board/can/transport/transport.h"

namespace koboshi::sim_board::test {

// Whoever is at the other end of a transport: keeps what it hears, and says what a test puts into its mouth.
class Outside final : public Transport {
 public:
  bool send(const hal::CanFrame& frame, std::uint64_t time_us) override {
    if (full) return false;
    heard.push_back(frame);
    times_us.push_back(time_us);
    return true;
  }
  std::optional<hal::CanFrame> receive() override {
    if (said.empty()) return std::nullopt;
    const hal::CanFrame frame = said.front();
    said.pop_front();
    return frame;
  }
  std::uint64_t dropped() const override { return lost_by_system; }
  std::string place() const override { return "outside"; }

  std::vector<hal::CanFrame> heard;
  std::vector<std::uint64_t> times_us;
  std::deque<hal::CanFrame> said;
  std::uint64_t lost_by_system = 0;
  bool full = false;
};

}  // namespace koboshi::sim_board::test
