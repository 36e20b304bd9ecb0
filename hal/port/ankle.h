#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "hal/port/side.h"

namespace koboshi::hal {

// The sensor of a foot. A robot has the same kind in both feet.
enum class AnkleKind : std::uint8_t {
  kSixAxis = 0,        // force and torque between shank and sole
  kPressureCells = 1,  // the normal force at four points of the sole
  kContactSwitch = 2,  // closed while the foot bears a load
  kNone = 3,
};
inline constexpr std::size_t kPressureCells = 4;  // of a foot

// A sample of a foot's sensor, in counts; 2^15 counts are the full scale in the robot's model. The content
// depends on the kind of sensor:
//   six axes         the wrench that the ground side exerts on the shank side, at the sensor's origin, in the
//                    sensor's own frame
//   pressure cells   the cells 0 to 2 in force_raw, the cell 3 in torque_raw[0], the rest zero
//   contact switch   force_raw[2] is 1 while it is closed, the rest zero
struct AnkleSample {
  std::uint32_t time_us = 0;  // low 32 bits of board time at the sampling instant
  std::array<std::int16_t, 3> force_raw{};
  std::array<std::int16_t, 3> torque_raw{};

  friend bool operator==(const AnkleSample&, const AnkleSample&) = default;
};

// The sensors of the two feet, at 100 Hz or more. Each keeps its latest sample only. A robot without them
// never has a sample.
class AnklePort {
 public:
  // Reads the newest sample. Returns false, with `sample` unchanged, if no new one has arrived since the last
  // read.
  [[nodiscard]] virtual bool read(Side side, AnkleSample& sample) = 0;

 protected:
  ~AnklePort() = default;
};

}  // namespace koboshi::hal
