#include "studio/view/link_marks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

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

// A straight mark in the world.
struct Segment {
  Eigen::Vector3d from_W_m;
  Eigen::Vector3d to_W_m;
};

Segment frame_axis(const view::Pose& link, int axis) {
  return {point_W_m(link, Eigen::Vector3d::Zero()), point_W_m(link, kFrame_m * Eigen::Vector3d::Unit(axis))};
}

Segment arrow_of(const view::Pose& link, const JointAxis& axis) {
  return {point_W_m(link, axis.p_L_m - 0.4 * kAxis_m * axis.axis_L),
          point_W_m(link, axis.p_L_m + kAxis_m * axis.axis_L)};
}

double distance_to_segment_px(const Eigen::Vector2d& from_px, const Eigen::Vector2d& to_px,
                              const Eigen::Vector2d& pixel) {
  const Eigen::Vector2d along_px = to_px - from_px;
  const double length_px2 = along_px.squaredNorm();
  const double share =
      length_px2 > 0.0 ? std::clamp((pixel - from_px).dot(along_px) / length_px2, 0.0, 1.0) : 0.0;
  return (from_px + share * along_px - pixel).norm();
}

}  // namespace

std::vector<JointAxis> joint_axes(const sim_board::RobotDescription& robot) {
  std::vector<JointAxis> axes;
  for (std::size_t i = 0; i < robot.hinge_count(); ++i) {
    const sim_board::JointDescription& joint = robot.hinge(i);
    const Eigen::Isometry3d X_LM = robot.links[static_cast<std::size_t>(joint.child)].X_ML.inverse();
    const Eigen::Matrix3d R_MP = robot.links[static_cast<std::size_t>(joint.parent)].X_ML.linear();
    axes.push_back({.name = joint.name,
                    .link = joint.child,
                    .parent = joint.parent,
                    .p_L_m = X_LM * joint.p_MJ,
                    .axis_L = X_LM.linear() * joint.axis_M,
                    .q_PL_zero = Eigen::Quaterniond((X_LM.linear() * R_MP).transpose()),
                    .lower_rad = joint.lower_rad,
                    .upper_rad = joint.upper_rad});
  }
  return axes;
}

double joint_angle_rad(const JointAxis& axis, std::span<const view::Pose> links) {
  const auto q_W = [&](int link) {
    return Eigen::Quaterniond(links[static_cast<std::size_t>(link)].q_WL.cast<double>().normalized());
  };
  const Eigen::Quaterniond turned =
      axis.q_PL_zero.conjugate() * q_W(axis.parent).conjugate() * q_W(axis.link);
  return std::remainder(2.0 * std::atan2(turned.vec().dot(axis.axis_L), turned.w()), 2.0 * std::numbers::pi);
}

void add_link_frames(view::Marks& marks, std::span<const view::Pose> links) {
  for (const view::Pose& link : links)
    for (int axis = 0; axis < 3; ++axis) {
      const Segment rod = frame_axis(link, axis);
      view::add_rod(marks, rod.from_W_m, rod.to_W_m, kFrameRadius_m, kAxes[static_cast<std::size_t>(axis)]);
    }
}

void add_joint_axes(view::Marks& marks, std::span<const view::Pose> links, std::span<const JointAxis> axes) {
  for (const JointAxis& axis : axes) {
    const Segment arrow = arrow_of(links[static_cast<std::size_t>(axis.link)], axis);
    view::add_arrow(marks, arrow.from_W_m, arrow.to_W_m, kAxisRadius_m, kJoint);
  }
}

std::vector<MarkName> marks_near(std::span<const view::Pose> frames, std::span<const view::Pose> links,
                                 std::span<const JointAxis> axes, const view::Camera& camera, int width_px,
                                 int height_px, const Eigen::Vector2d& pixel) {
  const auto distance_px = [&](const Segment& mark) {
    return distance_to_segment_px(view::project(camera, width_px, height_px, mark.from_W_m),
                                  view::project(camera, width_px, height_px, mark.to_W_m), pixel);
  };
  std::vector<MarkName> found;
  const auto add = [&](MarkName::Kind kind, std::size_t index, double px) {
    if (px <= kMarkReach_px) found.push_back({kind, index, px});
  };
  for (std::size_t i = 0; i < frames.size(); ++i)
    add(MarkName::Kind::kFrame, i,
        std::min({distance_px(frame_axis(frames[i], 0)), distance_px(frame_axis(frames[i], 1)),
                  distance_px(frame_axis(frames[i], 2))}));
  for (std::size_t i = 0; i < axes.size(); ++i)
    add(MarkName::Kind::kAxis, i,
        distance_px(arrow_of(links[static_cast<std::size_t>(axes[i].link)], axes[i])));
  std::ranges::stable_sort(found, {}, &MarkName::distance_px);
  return found;
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
