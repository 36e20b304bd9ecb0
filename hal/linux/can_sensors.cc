#include "hal/linux/can_sensors.h"

namespace koboshi::hal {
namespace {

constexpr std::uint16_t kFirstTpdo = 0x180;
constexpr std::uint16_t kSecondTpdo = 0x280;

std::uint16_t word_of(const CanFrame& frame, std::size_t number) {
  return static_cast<std::uint16_t>(frame.data[2 * number] | frame.data[2 * number + 1] << 8);
}

}  // namespace

bool CanSensors::take_whole(const CanFrame& frame, Sensor& sensor) const {
  sensor.axes = {};
  if (ankles_ == AnkleKind::kPressureCells && frame.size == 8) {
    for (std::size_t cell = 0; cell < 3; ++cell)
      sensor.axes[0][cell] = static_cast<std::int16_t>(word_of(frame, cell));
    sensor.axes[1][0] = static_cast<std::int16_t>(word_of(frame, 3));
    return true;
  }
  if (ankles_ == AnkleKind::kContactSwitch && frame.size == 3) {
    sensor.axes[0][2] = static_cast<std::int16_t>(frame.data[0] & 1);
    return true;
  }
  return false;
}

bool CanSensors::on_frame(const CanFrame& frame, std::uint64_t now_us) {
  const int number = (frame.identifier & 0x7F) - kInertialNode;
  if (number < 0 || number >= static_cast<int>(sensors_.size()) || frame.remote) return false;
  Sensor& sensor = sensors_[static_cast<std::size_t>(number)];
  const std::uint16_t service = frame.identifier & 0x780;
  if (service != kFirstTpdo && service != kSecondTpdo) return false;
  if (number > 0 && ankles_ != AnkleKind::kSixAxis) {
    if (service != kFirstTpdo || !take_whole(frame, sensor)) return true;
    sensor.complete = sensor.fresh = true;
    sensor.time_us = now_us;
    return true;
  }
  if (frame.size != 8) return true;
  const std::size_t half = service == kFirstTpdo ? 0 : 1;
  for (std::size_t axis = 0; axis < 3; ++axis)
    sensor.axes[half][axis] = static_cast<std::int16_t>(word_of(frame, axis));
  sensor.numbers[half] = word_of(frame, 3);
  sensor.seen[half] = true;
  if (!sensor.seen[0] || !sensor.seen[1] || sensor.numbers[0] != sensor.numbers[1]) return true;
  sensor.complete = sensor.fresh = true;
  sensor.time_us = now_us;
  return true;
}

std::optional<ImuSample> CanSensors::inertial(std::uint64_t now_us) const {
  const Sensor& sensor = sensors_[0];
  if (!sensor.complete || now_us - sensor.time_us > kTimeout_us) return std::nullopt;
  return ImuSample{.time_us = static_cast<std::uint32_t>(now_us),
                   .gyro_raw = sensor.axes[0],
                   .accelerometer_raw = sensor.axes[1]};
}

std::optional<AnkleSample> CanSensors::take_ankle(Side side) {
  Sensor& sensor = sensors_[side == Side::kLeft ? 1 : 2];
  if (!sensor.fresh) return std::nullopt;
  sensor.fresh = false;
  return AnkleSample{.time_us = static_cast<std::uint32_t>(sensor.time_us),
                     .force_raw = sensor.axes[0],
                     .torque_raw = sensor.axes[1]};
}

}  // namespace koboshi::hal
