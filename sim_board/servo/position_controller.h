#pragma once

#include <cstdint>

#include "sim_board/description/description.h"
#include "sim_board/servo/encoder.h"

namespace koboshi::sim_board {

// The digital position loop of a servo drive, called once a period: duty cycle of its bridge proportional to
// the position error, less a damping on the speed that the encoder shows. At full_voltage_error_rad of error
// it asks for the whole supply, 1.
class PositionController {
 public:
  static constexpr double kPeriod_s = 0.001;

  explicit PositionController(const ServoDescription& servo)
      : gain_per_rad_(1.0 / servo.full_voltage_error_rad),
        velocity_gain_s_per_rad_(servo.velocity_gain_V_s_per_rad / servo.supply_V) {}

  // Multiplies the gain on the position error, in 0.001; the damping stays.
  void scale_gain(std::uint16_t gain_permille) { scale_ = gain_permille / 1000.0; }

  // Positions in units of 2^-20 turn, `previous` one period before `position`.
  double duty(std::int32_t target, std::int32_t position, std::int32_t previous) const {
    const double error_rad = (static_cast<double>(target) - position) * kRadPerPositionUnit;
    const double speed_rad_per_s =
        (static_cast<double>(position) - previous) * kRadPerPositionUnit / kPeriod_s;
    return scale_ * gain_per_rad_ * error_rad - velocity_gain_s_per_rad_ * speed_rad_per_s;
  }

 private:
  double gain_per_rad_;
  double scale_ = 1.0;
  double velocity_gain_s_per_rad_;
};

}  // namespace koboshi::sim_board
