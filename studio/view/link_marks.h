#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "sim_board/description/description.h"
#include "view/recording/recording.h"
#include "view/render/camera.h"
#include "view/render/marks.h"

namespace koboshi::studio {

// The axis of a hinge in the frame of its child link.
struct JointAxis {
  std::string name;  // of the joint
  int link = 0;      // the child
  int parent = 0;
  Eigen::Vector3d p_L_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d axis_L = Eigen::Vector3d::UnitZ();              // unit vector, right-handed
  Eigen::Quaterniond q_PL_zero = Eigen::Quaterniond::Identity();  // of the child in its parent at angle zero
  double lower_rad = 0.0;
  double upper_rad = 0.0;
};

// The axes of a robot's joints, in their order.
[[nodiscard]] std::vector<JointAxis> joint_axes(const sim_board::RobotDescription& robot);

// The angle of a joint of a robot whose links have these poses, in -pi..pi rad.
[[nodiscard]] double joint_angle_rad(const JointAxis& axis, std::span<const view::Pose> links);

// The axes of each link's frame, x red, y green, z blue, as in RViz.
void add_link_frames(view::Marks& marks, std::span<const view::Pose> links);
// An arrow along each joint's axis: a positive angle turns counter-clockwise about it.
void add_joint_axes(view::Marks& marks, std::span<const view::Pose> links, std::span<const JointAxis> axes);

// The meaning of a mark: the frame of a link, or the axis of a joint.
struct MarkName {
  enum class Kind { kFrame, kAxis };
  Kind kind = Kind::kFrame;
  std::size_t index = 0;  // of the link, or of the joint's axis
  double distance_px = 0.0;
};
inline constexpr double kMarkReach_px = 7.0;  // of the mouse from a mark's image

// The frames of links and the axes of joints whose images pass this pixel, the nearest first. Something in
// front does not hide them, as in the picture.
[[nodiscard]] std::vector<MarkName> marks_near(std::span<const view::Pose> frames,
                                               std::span<const view::Pose> links,
                                               std::span<const JointAxis> axes, const view::Camera& camera,
                                               int width_px, int height_px, const Eigen::Vector2d& pixel);

// Moves each link away from the link that carries it, by this share of their distance, and lifts all of
// them so that the origin of the lowest one keeps its height.
[[nodiscard]] std::vector<view::Pose> exploded(const view::Scene& scene, std::span<const view::Pose> links,
                                               double share);

}  // namespace koboshi::studio
