#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "sim_board/robot/description.h"
#include "tools/view/recording/recording.h"
#include "tools/view/render/marks.h"

namespace koboshi::studio {

// The axis of a hinge in the frame of its child link.
struct JointAxis {
  int link = 0;  // the child
  Eigen::Vector3d p_L_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d axis_L = Eigen::Vector3d::UnitZ();  // unit vector, right-handed

  friend bool operator==(const JointAxis&, const JointAxis&) = default;
};

// The axes of a robot's joints, in their order.
[[nodiscard]] std::vector<JointAxis> joint_axes(const sim::RobotDescription& robot);

// The axes of each link's frame, x red, y green, z blue, as in RViz.
void add_link_frames(view::Marks& marks, std::span<const view::Pose> links);
// An arrow along each joint's axis: a positive angle turns counter-clockwise about it.
void add_joint_axes(view::Marks& marks, std::span<const view::Pose> links, std::span<const JointAxis> axes);

// Moves each link away from the link that carries it, by this share of their distance, and lifts all of
// them so that the origin of the lowest one keeps its height.
[[nodiscard]] std::vector<view::Pose> exploded(const view::Scene& scene, std::span<const view::Pose> links,
                                               double share);

}  // namespace koboshi::studio
