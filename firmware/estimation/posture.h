#pragma once

#include <span>

#include "firmware/robot/model.h"

namespace koboshi::estimation {

// The poses of the soles and the centre of mass of the robot for one set of joint angles, in the trunk's
// frame B.
struct Posture {
  hal::BySide<robot::Pose> X_BSole;
  robot::Position p_BCom;  // of the whole robot

  // Returns the centre of mass in the frame of a sole, in m.
  [[nodiscard]] robot::Position centre_of_mass(hal::Side side) const;
};

// Computes the posture by forward kinematics. `angles` has one angle for each joint of the model, in its
// order. A model without joints gives zeros.
[[nodiscard]] Posture posture_at(const robot::RobotModel& model, std::span<const fixed::Angle> angles);

}  // namespace koboshi::estimation
