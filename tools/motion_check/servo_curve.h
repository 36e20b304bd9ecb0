#pragma once

#include <algorithm>
#include <cmath>

#include "sim_board/description/description.h"

namespace koboshi::tools {

// The largest torque of a servo's motor in N m in the direction of a speed in rad/s, which is negative if the
// motor brakes: the torque-speed line of a DC motor at this supply, limited by the bridge's duty cycle and
// the current limit (docs/reference/servo.md).
inline double available_torque_Nm(const sim_board::ServoDescription& servo, double speed_rad_per_s,
                                  double supply_V) {
  const double current_A =
      (servo.max_duty * supply_V - servo.torque_constant_Nm_per_A * speed_rad_per_s) / servo.resistance_ohm;
  return servo.torque_constant_Nm_per_A * std::clamp(current_A, 0.0, servo.current_limit_A);
}

// The torque of the motor in N m whose output takes `torque_Nm` before friction; the motor adds that of a
// turning shaft. A joint at rest sticks, so that friction helps to hold the load; it is left out there.
inline double motor_torque_Nm(const sim_board::ServoDescription& servo, double torque_Nm,
                              double speed_rad_per_s) {
  constexpr double kTurns_rad_per_s = 0.02;  // half an encoder step per tick
  const double turning_Nm = torque_Nm + servo.viscous_friction_Nm_s * speed_rad_per_s;
  if (std::abs(speed_rad_per_s) <= kTurns_rad_per_s) return turning_Nm;
  return turning_Nm + std::copysign(servo.coulomb_friction_Nm, speed_rad_per_s);
}

// The torque that a motor gives, and what is available in this direction; at the output.
struct ServoLoad {
  float torque_Nm = 0.0F;     // positive towards positive angles
  float available_Nm = 0.0F;  // at the speed and the lowest supply; not negative
};

inline ServoLoad servo_load(const sim_board::ServoDescription& servo, double torque_Nm,
                            double speed_rad_per_s, double supply_V) {
  const double motor_Nm = motor_torque_Nm(servo, torque_Nm, speed_rad_per_s);
  const double along_rad_per_s = motor_Nm >= 0.0 ? speed_rad_per_s : -speed_rad_per_s;
  return {static_cast<float>(motor_Nm),
          static_cast<float>(available_torque_Nm(servo, along_rad_per_s, supply_V))};
}

// The share of the available torque that a joint takes: 1 and above, it cannot follow.
inline double torque_share(const sim_board::ServoDescription& servo, double torque_Nm, double speed_rad_per_s,
                           double supply_V) {
  const double motor_Nm = motor_torque_Nm(servo, torque_Nm, speed_rad_per_s);
  const double along_rad_per_s = motor_Nm >= 0.0 ? speed_rad_per_s : -speed_rad_per_s;
  return std::abs(motor_Nm) / std::max(available_torque_Nm(servo, along_rad_per_s, supply_V), 1e-6);
}

// Stiffness of the position loop at the output in N m/rad: torque per position error of a stalled motor.
inline double stiffness_Nm_per_rad(const sim_board::ServoDescription& servo, double supply_V) {
  return servo.torque_constant_Nm_per_A * supply_V / (servo.resistance_ohm * servo.full_voltage_error_rad);
}

}  // namespace koboshi::tools
