#pragma once

#include <cstdint>
#include <span>

#include "firmware/estimation/posture.h"
#include "firmware/fixed/literals.h"
#include "firmware/robot/model.h"

namespace koboshi::estimation {

// Where the ground carries a foot.
struct FootPressure {
  fixed::Force load;  // normal to the sole, foot included; may be negative by the sensor's errors
  bool valid = false;
  fixed::Length x;  // of the ZMP in the sole's frame; only when valid
  fixed::Length y;
};

// Where the ground carries the robot.
struct Pressure {
  hal::Side frame = hal::Side::kLeft;  // the sole in whose frame it is: of the foot that carries more
  bool valid = false;                  // some foot carries enough
  fixed::Length x;
  fixed::Length y;
};

// The zero moment point of a foot from its ankle sensor, the paper's equation 1 with f_z as denominator:
//   p_x = (-tau_y - f_x d) / f_z,  p_y = (tau_x - f_y d) / f_z,
// from the point of the sole below the sensor, d under it. What the sensor does not feel, the weight of the
// foot below it, is added as if the foot stood level and at rest: a foot that carries the robot nearly does,
// and more exactly than any attitude would tell. At 5 degrees of tilt that is wrong by m g sin(5 deg) d /
// f_z, 0.3 mm for the default robot on one foot.
class FootSensor {
 public:
  // Below this, a twelfth of the robot's weight, the noise of the torques is millimetres of ZMP.
  static constexpr auto kMinLoad = fixed::literals::operator""_N(1.0L);

  // The model must outlive the sensor.
  FootSensor(const robot::RobotModel& model, hal::Side side);

  // `counts` are what the sensor shows in its axes: force x, y, z, then torque x, y, z, which the ground side
  // exerts on the shank side. Rounded once, beside the sensor's scaling to LSB of Force and Torque: at most
  // 1 um from the formula, at the least load.
  FootPressure pressure(std::span<const std::int16_t, 6> counts) const;

 private:
  const robot::RobotModel& model_;
  robot::Position sensor_;  // in the sole's frame
  fixed::Force weight_;     // of the foot
  fixed::Torque weight_x_;  // moment of what carries it, about the sensor
  fixed::Torque weight_y_;
};

// Both feet, weighted with their loads.
Pressure combine(const hal::BySide<FootPressure>& feet, const Posture& posture);

}  // namespace koboshi::estimation
