#pragma once

#include <cstdint>
#include <limits>

#include "sim_board/can/bus.h"

namespace koboshi::sim_board {

// Content and timing of a babbling node's traffic.
struct Babble {
  hal::CanFrame frame;
  std::uint64_t interval_us = 0;  // 0: as fast as the bus permits
  std::uint64_t from_us = 0;
  std::uint64_t until_us = std::numeric_limits<std::uint64_t>::max();
};

// A babbling node: it sends one frame repeatedly and receives nothing. It is on the bus only during this
// time.
class Babbler final : private BusNode {
 public:
  // The bus must outlive the babbler.
  Babbler(Bus& bus, const Babble& babble);
  ~Babbler() { bus_.power_off(handle_); }
  Babbler(const Babbler&) = delete;
  Babbler& operator=(const Babbler&) = delete;

  // Queues the frames up to `end_us`, the time to which the bus advances next. Call it once per millisecond.
  void advance(std::uint64_t end_us);

  void archive(StateArchive& archive);

 private:
  // More than the number of shortest frames in a millisecond.
  static constexpr std::size_t kTransmitFifo = 32;

  void on_frame(const hal::CanFrame&, std::uint64_t) override {}

  Bus& bus_;
  Babble babble_;
  NodeHandle handle_;
  std::uint64_t next_us_;
};

}  // namespace koboshi::sim_board
