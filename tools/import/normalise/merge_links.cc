#include "tools/import/normalise/merge_links.h"

#include <algorithm>
#include <ranges>

namespace koboshi::tools {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// Inertia of a point mass at `p`.
Matrix3d point_inertia(double mass_kg, const Vector3d& p) {
  return mass_kg * (p.squaredNorm() * Matrix3d::Identity() - p * p.transpose());
}

void move_content(ImportedLink& to, const ImportedLink& from, const Eigen::Isometry3d& X) {
  add_mass(to, from, X);
  to.lacks_mass = to.lacks_mass || from.lacks_mass;
  const auto move_shapes = [&X](std::vector<ImportedShape>& shapes,
                                const std::vector<ImportedShape>& others) {
    for (ImportedShape shape : others) {
      shape.X_LG = X * shape.X_LG;
      shapes.push_back(std::move(shape));
    }
  };
  move_shapes(to.visuals, from.visuals);
  move_shapes(to.collisions, from.collisions);
  to.frames.push_back({from.name, X});
  for (const ImportedFrame& frame : from.frames) to.frames.push_back({frame.name, X * frame.X_LF});
}

}  // namespace

void lock_joint(ImportedJoint& joint, double angle_rad) {
  joint.X_PL.rotate(Eigen::AngleAxisd(angle_rad, joint.axis_L));
  joint.kind = JointKind::kFixed;
}

void add_mass(ImportedLink& link, const ImportedLink& other, const Eigen::Isometry3d& X_LC) {
  if (other.mass_kg <= 0.0) return;
  const Vector3d p_other = X_LC * other.p_LCom_L;
  const Matrix3d I_other = X_LC.linear() * other.I_LCom_L * X_LC.linear().transpose();
  const double mass_kg = link.mass_kg + other.mass_kg;
  const Vector3d p = (link.mass_kg * link.p_LCom_L + other.mass_kg * p_other) / mass_kg;
  link.I_LCom_L += point_inertia(link.mass_kg, link.p_LCom_L - p);
  link.I_LCom_L += I_other + point_inertia(other.mass_kg, p_other - p);
  link.p_LCom_L = p;
  link.mass_kg = mass_kg;
}

ImportedRobot merge_fixed_links(const ImportedRobot& robot) {
  ImportedRobot merged{.name = robot.name, .file = robot.file};
  std::vector<ImportedLink> links = robot.links;
  std::vector<ImportedJoint> joints = robot.joints;
  const std::vector<std::size_t> order = joints_from_root(robot);
  // From the ends inwards, so that a link carries all that was merged into it.
  for (const std::size_t i : std::views::reverse(order)) {
    const ImportedJoint& fixed = joints[i];
    if (fixed.kind != JointKind::kFixed) continue;
    move_content(links[static_cast<std::size_t>(fixed.parent)], links[static_cast<std::size_t>(fixed.child)],
                 fixed.X_PL);
    for (ImportedJoint& joint : joints) {
      if (joint.parent != fixed.child) continue;
      joint.parent = fixed.parent;
      joint.X_PL = fixed.X_PL * joint.X_PL;
    }
  }
  std::vector<int> index(links.size(), -1);
  const int root = root_link(robot);
  for (std::size_t i = 0; i < links.size(); ++i) {
    const int joint = joint_of(robot, static_cast<int>(i));
    const bool stays = static_cast<int>(i) == root ||
                       robot.joints[static_cast<std::size_t>(joint)].kind != JointKind::kFixed;
    if (!stays) continue;
    index[i] = static_cast<int>(merged.links.size());
    merged.links.push_back(std::move(links[i]));
  }
  for (ImportedJoint& joint : joints) {
    if (joint.kind == JointKind::kFixed) continue;
    joint.parent = index[static_cast<std::size_t>(joint.parent)];
    joint.child = index[static_cast<std::size_t>(joint.child)];
    merged.joints.push_back(std::move(joint));
  }
  return merged;
}

}  // namespace koboshi::tools
