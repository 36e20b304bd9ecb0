#pragma once

#include <array>
#include <cstdint>

#include "hal/port/side.h"

namespace koboshi::hal {

// One sample of a six-axis force/torque sensor below the ankle, in the sensor's own frame and counts:
// the wrench that the ground side exerts on the shank side, at the sensor's origin.
struct AnkleSample {
  std::uint32_t time_us = 0;                 // low 32 bits of board time at the sampling instant
  std::array<std::int16_t, 3> force_raw{};   // x, y, z; 2^15 counts are the full scale in the robot's model
  std::array<std::int16_t, 3> torque_raw{};  // likewise

  friend bool operator==(const AnkleSample&, const AnkleSample&) = default;
};

// The two ankle sensors, at 100 Hz or more. Each keeps its latest sample only.
class AnklePort {
 public:
  // Reads the newest sample. Returns false, with `sample` unchanged, if no new one has arrived since the last
  // read.
  [[nodiscard]] virtual bool read(Side side, AnkleSample& sample) = 0;

 protected:
  ~AnklePort() = default;
};

}  // namespace koboshi::hal
