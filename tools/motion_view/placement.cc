#include "tools/motion_view/placement.h"

#include <cmath>

namespace koboshi::tools {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;

double heading_rad(const Isometry3d& X) { return std::atan2(X.linear()(1, 0), X.linear()(0, 0)); }

}  // namespace

Isometry3d Placement::place(std::span<const double> angles_rad) {
  body_.solve_at_rest(angles_rad, stance_);
  const GroundAxes axes(stance_.rest.up_B);
  Isometry3d X_GB = Isometry3d::Identity();  // G: on the ground below B's origin, heading with the trunk
  X_GB.linear().row(0) = axes.x_B.transpose();
  X_GB.linear().row(1) = axes.y_B.transpose();
  X_GB.linear().row(2) = stance_.rest.up_B.transpose();
  X_GB.translation().z() = -stance_.rest.height_m;
  if (has_anchor_) {
    const Isometry3d X_GF = foot(X_GB, side_);
    const double turn_rad = heading_rad(X_WF_) - heading_rad(X_GF);
    X_WG_.linear() = Eigen::AngleAxisd(turn_rad, Vector3d::UnitZ()).toRotationMatrix();
    X_WG_.translation() = X_WF_.translation() - X_WG_.linear() * X_GF.translation();
    X_WG_.translation().z() = 0.0;
  }
  side_ = Body::support_side(stance_);
  X_WF_ = X_WG_ * foot(X_GB, side_);
  has_anchor_ = true;
  X_WB_ = X_WG_ * X_GB;
  return X_WB_;
}

std::vector<view::Pose> Placement::links() const {
  std::vector<view::Pose> links;
  for (const Isometry3d& X_BL : body_.X_BLs()) {
    const Isometry3d X_WL = X_WB_ * X_BL;
    links.push_back({.p_WL_m = X_WL.translation().cast<float>(),
                     .q_WL = Eigen::Quaterniond(X_WL.linear()).cast<float>()});
  }
  return links;
}

Eigen::Vector2d Placement::on_ground(const Eigen::Vector2d& p_m) const {
  return (X_WG_ * Vector3d(p_m.x(), p_m.y(), 0.0)).head<2>();
}

Isometry3d Placement::foot(const Isometry3d& X_GB, std::size_t side) const {
  return X_GB * body_.X_BLs()[body_.foot_link(side)];
}

}  // namespace koboshi::tools
