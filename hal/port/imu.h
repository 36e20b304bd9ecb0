#pragma once

#include <array>
#include <cstdint>

namespace koboshi::hal {

// One sample of a six-axis inertial unit, in the sensor's own frame and counts.
struct ImuSample {
  std::uint32_t time_us = 0;               // low 32 bits of board time at the sampling instant
  std::array<std::int16_t, 3> gyro_raw{};  // x, y, z; 2^15 counts are the full scale in the robot's model
  std::array<std::int16_t, 3> accelerometer_raw{};  // likewise; specific force, +1 g upwards at rest

  friend bool operator==(const ImuSample&, const ImuSample&) = default;
};

// The FIFO of an inertial unit that samples at 1 kHz. It holds at least the samples of 10 ms.
class ImuPort {
 public:
  // Removes the oldest sample. Returns false, with `sample` unchanged, if there is none.
  [[nodiscard]] virtual bool read(ImuSample& sample) = 0;
  // Returns the number of samples lost because the FIFO was full; saturates.
  [[nodiscard]] virtual std::uint16_t overruns() const = 0;

 protected:
  ~ImuPort() = default;
};

}  // namespace koboshi::hal
