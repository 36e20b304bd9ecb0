#include "tools/studio/view/link_marks.h"

#include <algorithm>
#include <array>
#include <cstddef>

namespace koboshi::studio {
namespace {

constexpr double kFrame_m = 0.025;
constexpr double kFrameRadius_m = 0.001;
constexpr double kAxis_m = 0.045;
constexpr double kAxisRadius_m = 0.0016;
constexpr std::array<view::Colour, 3> kAxes{{{0.85F, 0.12F, 0.1F}, {0.1F, 0.6F, 0.15F}, {0.1F, 0.3F, 0.9F}}};
constexpr view::Colour kJoint{0.95F, 0.6F, 0.05F};

Eigen::Vector3d point_W_m(const view::Pose& pose, const Eigen::Vector3d& p_L_m) {
  return pose.p_WL_m.cast<double>() + pose.q_WL.cast<double>() * p_L_m;
}

}  // namespace

std::vector<JointAxis> joint_axes(const sim::RobotDescription& robot) {
  std::vector<JointAxis> axes;
  for (const sim::JointDescription& joint : robot.joints) {
    const Eigen::Isometry3d X_LM = robot.links[static_cast<std::size_t>(joint.child)].X_ML.inverse();
    axes.push_back({joint.child, X_LM * joint.p_MJ, X_LM.linear() * joint.axis_M});
  }
  return axes;
}

void add_link_frames(view::Marks& marks, std::span<const view::Pose> links) {
  for (const view::Pose& link : links)
    for (int axis = 0; axis < 3; ++axis)
      view::add_rod(marks, point_W_m(link, Eigen::Vector3d::Zero()),
                    point_W_m(link, kFrame_m * Eigen::Vector3d::Unit(axis)), kFrameRadius_m,
                    kAxes[static_cast<std::size_t>(axis)]);
}

void add_joint_axes(view::Marks& marks, std::span<const view::Pose> links, std::span<const JointAxis> axes) {
  for (const JointAxis& axis : axes) {
    const view::Pose& link = links[static_cast<std::size_t>(axis.link)];
    view::add_arrow(marks, point_W_m(link, axis.p_L_m - 0.4 * kAxis_m * axis.axis_L),
                    point_W_m(link, axis.p_L_m + kAxis_m * axis.axis_L), kAxisRadius_m, kJoint);
  }
}

// The links of a scene may be in any order: each one's way to the trunk is followed.
std::vector<view::Pose> exploded(const view::Scene& scene, std::span<const view::Pose> links, double share) {
  std::vector<view::Pose> moved(links.begin(), links.end());
  for (std::size_t i = 0; i < links.size(); ++i) {
    std::size_t link = i;
    for (std::size_t joints = 0; joints < links.size() && scene.links[link].parent >= 0; ++joints) {
      const auto parent = static_cast<std::size_t>(scene.links[link].parent);
      moved[i].p_WL_m += static_cast<float>(share) * (links[link].p_WL_m - links[parent].p_WL_m);
      link = parent;
    }
  }
  const auto height = [](const view::Pose& link) { return link.p_WL_m.z(); };
  const float lift_m = links.empty() ? 0.0F
                                     : std::ranges::min(links, {}, height).p_WL_m.z() -
                                           std::ranges::min(moved, {}, height).p_WL_m.z();
  for (view::Pose& link : moved) link.p_WL_m.z() += lift_m;
  return moved;
}

}  // namespace koboshi::studio
