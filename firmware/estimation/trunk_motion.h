#pragma once

#include "firmware/estimation/robot_state.h"
#include "firmware/fixed/units.h"

namespace koboshi::estimation {

// What the trunk does beyond what is planned. A lean ahead has positive pitch, one to the right positive
// roll.
struct TrunkMotion {
  fixed::AngularRate roll_rate;  // in axes of B, free of bias
  fixed::AngularRate pitch_rate;
  fixed::Angle roll;
  fixed::Angle pitch;
};

// `planned_pitch`: by how much the trunk is to lean ahead.
constexpr TrunkMotion trunk_motion(const RobotState& robot, fixed::Angle planned_pitch) {
  return {.roll_rate = robot.rates_B.x,
          .pitch_rate = robot.rates_B.y,
          .roll = robot.roll,
          .pitch = robot.pitch - planned_pitch};
}

}  // namespace koboshi::estimation
