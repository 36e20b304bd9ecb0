#pragma once

#include <span>

#include "firmware/robot/model.h"

namespace koboshi::estimation {

// The soles and the centre of mass of the robot at one set of joint angles.
struct Posture {
  hal::BySide<robot::Pose> X_BSole;
  robot::Position p_BCom;  // of the whole robot

  // Returns the centre of mass in the frame of a sole.
  [[nodiscard]] robot::Position centre_of_mass(hal::Side side) const;
};

// `angles` has one angle a joint of the model, in its order.
[[nodiscard]] Posture posture_at(const robot::RobotModel& model, std::span<const fixed::Angle> angles);

}  // namespace koboshi::estimation
