#pragma once

#include <array>
#include <cstdint>

#include "hal/port/side.h"

namespace koboshi::hal {

// One sample of a six-axis force/torque sensor below the ankle, in the sensor's own frame and counts:
// the wrench that the ground side exerts on the shank side, at the sensor's origin.
struct AnkleSample {
  std::uint32_t time_us = 0;  // low 32 bits of board time at the sampling instant
  std::array<std::int16_t, 3> force_raw{};
  std::array<std::int16_t, 3> torque_raw{};

  friend bool operator==(const AnkleSample&, const AnkleSample&) = default;
};

// The two ankle sensors. Each keeps its latest sample only.
class AnklePort {
 public:
  // Takes the sample that came since the last read. False, and `sample` untouched, when none did.
  [[nodiscard]] virtual bool read(Side side, AnkleSample& sample) = 0;

 protected:
  ~AnklePort() = default;
};

}  // namespace koboshi::hal
