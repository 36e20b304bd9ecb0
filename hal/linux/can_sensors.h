#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "hal/port/ankle.h"
#include "hal/port/can.h"
#include "hal/port/imu.h"

namespace koboshi::hal {

// Inertial unit and ankle sensors that are nodes of the bus, as the ports that a controller with sensors of
// its own has. Their PDOs: TPDO 1 gyro or force, TPDO 2 accelerometer or torque, three axes and the number of
// the sample, 16 bits each.
class CanSensors {
 public:
  static constexpr std::uint8_t kInertialNode = 36;
  static constexpr std::uint8_t kLeftAnkleNode = 37;
  static constexpr std::uint8_t kRightAnkleNode = 38;
  static constexpr std::array<std::uint8_t, 3> kNodes{kInertialNode, kLeftAnkleNode, kRightAnkleNode};
  // Later than this a sensor is silent.
  static constexpr std::uint64_t kTimeout_us = 20'000;

  // True when the frame was a sample's. `now_us` is when it came.
  bool on_frame(const CanFrame& frame, std::uint64_t now_us);
  // The inertial unit's latest sample, which stands for one of the 1 kHz that the firmware expects; nothing
  // while the unit is silent.
  std::optional<ImuSample> inertial(std::uint64_t now_us) const;
  // The sample of an ankle that has come since the last call.
  std::optional<AnkleSample> take_ankle(Side side);

 private:
  using Axes = std::array<std::int16_t, 3>;
  // The two halves of a sample, and which sample each is of.
  struct Sensor {
    std::array<Axes, 2> axes{};
    std::array<std::uint16_t, 2> numbers{};
    std::array<bool, 2> seen{};
    std::uint64_t time_us = 0;  // when it was complete last
    bool complete = false;
    bool fresh = false;
  };

  std::array<Sensor, 3> sensors_;
};

}  // namespace koboshi::hal
