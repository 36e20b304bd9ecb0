#pragma once

#include <array>
#include <span>

#include "firmware/robot/model.h"

namespace koboshi::robot {

// The poses of all links in the trunk's frame B. Hinge i carries link i.
using LinkPoses = std::array<Pose, kMaxJoints>;

// Computes the poses of all links (forward kinematics). `angles` has one angle for each joint of the model,
// in its order.
void forward_kinematics(const RobotModel& model, std::span<const fixed::Angle> angles, LinkPoses& X_BLinks);

// Returns the pose of a sole's frame in B.
[[nodiscard]] Pose sole_pose(const RobotModel& model, hal::Side side, const LinkPoses& X_BLinks);

// Returns the mass of the whole robot.
[[nodiscard]] fixed::Mass total_mass(const RobotModel& model);

// Returns the centre of mass of the whole robot in B, in m.
[[nodiscard]] Position centre_of_mass(const RobotModel& model, const LinkPoses& X_BLinks);

}  // namespace koboshi::robot
