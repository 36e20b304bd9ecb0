#pragma once

#include <array>
#include <span>

#include "firmware/robot/model.h"

namespace koboshi::estimation {

// The soles and the centre of mass of the robot at one set of joint angles.
struct Posture {
  std::array<robot::Pose, 2> X_BSole;  // by Side
  robot::Position p_BCom;              // of the whole robot

  [[nodiscard]] const robot::Pose& sole(hal::Side side) const {
    return X_BSole[static_cast<std::size_t>(side)];
  }
  // Returns the centre of mass in the frame of a sole.
  [[nodiscard]] robot::Position centre_of_mass(hal::Side side) const;
};

// `angles` has one angle a joint of the model, in its order.
[[nodiscard]] Posture posture_at(const robot::RobotModel& model, std::span<const fixed::Angle> angles);

}  // namespace koboshi::estimation
