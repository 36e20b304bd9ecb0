#pragma once

#include <cstdint>
#include <limits>

#include "sim_board/can/bus.h"

namespace koboshi::sim {

// What a babbling node says, and when.
struct Babble {
  hal::CanFrame frame;
  std::uint64_t interval_us = 0;  // 0: as fast as the bus takes it
  std::uint64_t from_us = 0;
  std::uint64_t until_us = std::numeric_limits<std::uint64_t>::max();
};

// A node that babbles: it sends one frame over and over, hears nothing, and is on the bus only while it does
// so.
class Babbler final : private BusNode {
 public:
  // The bus must outlive the babbler.
  Babbler(Bus& bus, const Babble& babble);
  ~Babbler() { bus_.power_off(handle_); }
  Babbler(const Babbler&) = delete;
  Babbler& operator=(const Babbler&) = delete;

  // Queues what it says up to `end_us`, to which the bus is brought next. Once a millisecond.
  void advance(std::uint64_t end_us);

  void archive(StateArchive& archive) { archive(next_us_); }

 private:
  // More than the shortest frames of a millisecond.
  static constexpr std::size_t kTransmitFifo = 32;

  void on_frame(const hal::CanFrame&, std::uint64_t) override {}

  Bus& bus_;
  Babble babble_;
  NodeHandle handle_;
  std::uint64_t next_us_;
};

}  // namespace koboshi::sim
