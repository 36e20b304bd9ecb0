#pragma once

#include "firmware/estimation/robot_state.h"
#include "firmware/fixed/units.h"

namespace koboshi::estimation {

// The deviation of the trunk's attitude and rates from the plan. Positive pitch leans forward, positive roll
// to the right.
struct TrunkMotion {
  fixed::AngularRate roll_rate;  // in axes of B, free of bias
  fixed::AngularRate pitch_rate;
  fixed::Angle roll;
  fixed::Angle pitch;
};

// Returns the deviation. `planned_pitch`: the planned lean, forward positive; planned roll and rates are
// zero.
constexpr TrunkMotion trunk_motion(const RobotState& robot, fixed::Angle planned_pitch) {
  return {.roll_rate = robot.rates_B.x,
          .pitch_rate = robot.rates_B.y,
          .roll = robot.roll,
          .pitch = robot.pitch - planned_pitch};
}

}  // namespace koboshi::estimation
