#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "hal/port/ankle.h"
#include "hal/port/can.h"
#include "hal/port/imu.h"

namespace koboshi::hal {

// Converts the PDOs of an inertial unit and two ankle sensors on the CAN bus to the samples of the ports.
// TPDO 1 carries gyro or force, TPDO 2 accelerometer or torque: three axes and the number of the sample, 16
// bits each. Pressure cells and contact switches have TPDO 1 only: four cells of 16 bits, or a byte with the
// switch in bit 0 and the number of the sample.
class CanSensors {
 public:
  static constexpr std::uint8_t kInertialNode = 36;
  static constexpr std::uint8_t kLeftAnkleNode = 37;
  static constexpr std::uint8_t kRightAnkleNode = 38;
  static constexpr std::array<std::uint8_t, 3> kNodes{kInertialNode, kLeftAnkleNode, kRightAnkleNode};
  // Age of the last sample after which the inertial unit counts as silent. Set by hand (2026-11-22): four
  // samples in a row, one every 4 ms, may be lost; the firmware itself tolerates 50 ms without samples.
  static constexpr std::uint64_t kTimeout_us = 20'000;

  // Sets the kind of the ankle sensors; six axes at first.
  void set_ankles(AnkleKind kind) { ankles_ = kind; }
  // Takes a received frame. Returns whether it belongs to a sample. `now_us`: time of reception.
  bool on_frame(const CanFrame& frame, std::uint64_t now_us);
  // Returns the latest sample of the inertial unit, to be repeated at the 1 kHz that the firmware expects;
  // nothing while the unit is silent.
  std::optional<ImuSample> inertial(std::uint64_t now_us) const;
  // Returns the sample of an ankle if a new one has arrived since the last call.
  std::optional<AnkleSample> take_ankle(Side side);

 private:
  using Axes = std::array<std::int16_t, 3>;
  // The two halves of a sample, and the number of the sample of each.
  struct Sensor {
    std::array<Axes, 2> axes{};
    std::array<std::uint16_t, 2> numbers{};
    std::array<bool, 2> seen{};
    std::uint64_t time_us = 0;  // of the last complete sample
    bool complete = false;
    bool fresh = false;
  };

  // Takes TPDO 1 of pressure cells or a contact switch. Returns false if it is none.
  bool take_whole(const CanFrame& frame, Sensor& sensor) const;

  AnkleKind ankles_ = AnkleKind::kSixAxis;
  std::array<Sensor, 3> sensors_;
};

}  // namespace koboshi::hal
