#pragma once

#include <array>
#include <span>

#include "firmware/robot/model.h"

namespace koboshi::robot {

// Poses of all links in the trunk's frame B. Link i is carried by joint i.
using LinkPoses = std::array<Pose, kMaxJoints>;

// Forward kinematics. `angles` has one angle a joint of the model, in its order.
void forward_kinematics(const RobotModel& model, std::span<const fixed::Angle> angles, LinkPoses& X_BLinks);

// The sole frame in B.
[[nodiscard]] Pose sole_pose(const RobotModel& model, hal::Side side, const LinkPoses& X_BLinks);

// Centre of mass of the whole robot, from B's origin in axes of B.
[[nodiscard]] Position centre_of_mass(const RobotModel& model, const LinkPoses& X_BLinks);

}  // namespace koboshi::robot
