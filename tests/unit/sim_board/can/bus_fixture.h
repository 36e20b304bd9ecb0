#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "hal/port/can.h"
#include "sim_board/can/bus.h"
#include "tests/unit/sim_board/can/reference_encoder.h"

namespace koboshi::sim_board::test {

struct SeenFrame {
  hal::CanFrame frame;
  std::uint64_t time_us = 0;

  friend bool operator==(const SeenFrame&, const SeenFrame&) = default;
};

// Keeps what it is told and may answer.
class ListeningNode final : public BusNode {
 public:
  void on_frame(const hal::CanFrame& frame, std::uint64_t time_us) override {
    seen.push_back({frame, time_us});
    if (answer) answer(frame, time_us);
  }

  std::vector<SeenFrame> seen;
  std::function<void(const hal::CanFrame&, std::uint64_t)> answer;
};

class ListeningObserver final : public BusObserver {
 public:
  struct Seen {
    hal::CanFrame frame;
    std::uint64_t start_us;
    std::uint64_t end_us;
  };
  void on_bus_frame(const hal::CanFrame& frame, std::uint64_t start_us, std::uint64_t end_us) override {
    seen.push_back({frame, start_us, end_us});
  }

  std::vector<Seen> seen;
};

// Destroys as many frames as it is told to.
class Destroyer final : public BusDisturbance {
 public:
  WireEffect on_transmission(const hal::CanFrame&, NodeHandle, std::uint64_t) override {
    return left > 0 && left-- > 0 ? WireEffect::kDestroyed : WireEffect::kNone;
  }
  Reception on_reception(const hal::CanFrame&, NodeHandle, std::uint64_t) override { return {}; }

  int left = 0;
};

inline hal::CanFrame make_frame(std::uint16_t identifier, std::vector<std::uint8_t> data) {
  hal::CanFrame frame{
      .identifier = identifier, .size = static_cast<std::uint8_t>(data.size()), .remote = false, .data = {}};
  for (std::size_t i = 0; i < data.size(); ++i) frame.data[i] = data[i];
  return frame;
}

// The frame's length by the reference encoder, in microseconds at 1 Mbit/s.
inline std::uint64_t length_us(const hal::CanFrame& frame) { return encode(frame).wire.size(); }

}  // namespace koboshi::sim_board::test
