#include "studio/window/pose_ghost.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "sim_board/description/hinge_tree.h"
#include "sim_board/world/ground.h"
#include "studio/view/link_marks.h"
#include "tools/motion_view/placement.h"
#include "view/capture/scene.h"

namespace koboshi::studio {

view::Scene PoseGhost::scene() const { return view::make_scene(*robot_, sim_board::GroundDescription()); }

std::vector<view::Pose> PoseGhost::stand(std::span<const double> angles_rad, const view::Pose* trunk) const {
  tools::Placement placement(*robot_);
  placement.place(angles_rad);
  std::vector<view::Pose> links = placement.links();
  if (trunk == nullptr) return links;
  const Eigen::Vector3f x_W = trunk->q_WL * Eigen::Vector3f::UnitX();
  const Eigen::Quaternionf turn(Eigen::AngleAxisf(std::atan2(x_W.y(), x_W.x()), Eigen::Vector3f::UnitZ()));
  const Eigen::Vector3f shift_m(trunk->p_WL_m.x(), trunk->p_WL_m.y(), 0.0F);
  for (view::Pose& link : links) link = {turn * link.p_WL_m + shift_m, turn * link.q_WL};
  return links;
}

std::vector<view::Pose> PoseGhost::hold(std::span<const double> angles_rad, int link,
                                        const view::Pose& at) const {
  std::vector<view::Pose> links;
  for (const Eigen::Isometry3d& X :
       sim_board::hinge_tree(*robot_).poses(Eigen::Isometry3d::Identity(), angles_rad))
    links.push_back({X.translation().cast<float>(), Eigen::Quaternionf(X.linear().cast<float>())});
  const view::Pose now = links.at(static_cast<std::size_t>(link));
  const Eigen::Quaternionf turn = (at.q_WL * now.q_WL.conjugate()).normalized();
  const Eigen::Vector3f shift_m = at.p_WL_m - turn * now.p_WL_m;
  for (view::Pose& pose : links) pose = {turn * pose.p_WL_m + shift_m, turn * pose.q_WL};
  return links;
}

std::vector<double> PoseGhost::angles_of(std::span<const view::Pose> links) const {
  std::vector<double> angles_rad;
  for (const JointAxis& axis : joint_axes(*robot_))
    angles_rad.push_back(std::clamp(joint_angle_rad(axis, links), axis.lower_rad, axis.upper_rad));
  return angles_rad;
}

}  // namespace koboshi::studio
