#include "tools/import/normalise/one_sided_locks.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "base/text/text.h"
#include "tools/import/decide/limbs.h"

namespace koboshi::tools {
namespace {

using Eigen::Vector3d;

bool turns(const ImportedJoint& joint) {
  return joint.kind == JointKind::kHinge || joint.kind == JointKind::kContinuous;
}

class MirrorImages {
 public:
  MirrorImages(const ImportedRobot& robot, const Eigen::Matrix3d& R_MR) : robot_(robot) {
    const std::vector<Eigen::Isometry3d> X_RL = link_poses(robot);
    Eigen::AlignedBox3d all;
    for (const ImportedJoint& joint : robot.joints) {
      const Eigen::Isometry3d& X = X_RL[static_cast<std::size_t>(joint.child)];
      anchors_M_.emplace_back(R_MR * X.translation());
      axes_M_.emplace_back(R_MR * X.linear() * joint.axis_L);
      if (turns(joint)) all.extend(anchors_M_.back());
    }
    if (!all.isEmpty()) middle_m_ = all.center().y();
  }

  // Returns the joint on the other side; null if there is none.
  const ImportedJoint* find(const ImportedJoint& joint) const {
    for (const ImportedJoint& other : robot_.joints)
      if (turns(other) && side_in_names(joint.name, other.name) != 0) return &other;
    const auto at = static_cast<std::size_t>(&joint - robot_.joints.data());
    for (std::size_t i = 0; i < robot_.joints.size(); ++i)
      if (i != at && turns(robot_.joints[i]) && are_images(at, i)) return &robot_.joints[i];
    return nullptr;
  }

 private:
  bool are_images(std::size_t one, std::size_t other) const {
    constexpr double kSamePlace_m = 0.003;
    constexpr double kParallel = 0.98;  // 11 degrees
    constexpr double kBeside_m = 0.01;  // a joint in the mid-plane is its own image
    Vector3d image = anchors_M_[one];
    image.y() = 2.0 * middle_m_ - image.y();
    if (std::abs(anchors_M_[one].y() - middle_m_) < kBeside_m) return false;
    const Vector3d axis(axes_M_[one].x(), -axes_M_[one].y(), axes_M_[one].z());
    return (anchors_M_[other] - image).norm() < kSamePlace_m &&
           std::abs(axes_M_[other].dot(axis)) > kParallel;
  }

  const ImportedRobot& robot_;
  std::vector<Vector3d> anchors_M_{};
  std::vector<Vector3d> axes_M_{};
  double middle_m_ = 0.0;
};

}  // namespace

void warn_of_one_sided_locks(const ImportedRobot& source, const ImportedRobot& robot,
                             const Eigen::Matrix3d& R_MR, const Interview& interview, ImportReport& report) {
  const MirrorImages images(source, R_MR);
  for (const ImportedJoint& joint : source.joints) {
    // Joints without a role on either side are both locked by the import itself.
    if (!turns(joint) || robot.find_joint(joint.name) || !interview.taken.locked_deg.contains(joint.name))
      continue;
    const ImportedJoint* const image = images.find(joint);
    if (image == nullptr) continue;
    const std::string name = one_line(joint.name);
    if (robot.find_joint(image->name)) {
      report.warnings.push_back(fmt::format("line {}: {} is locked, while its mirror image {} has a drive",
                                            joint.line, name, one_line(image->name)));
    } else if (!interview.taken.locked_deg.contains(image->name)) {
      report.warnings.push_back(
          fmt::format("line {}: {} is locked, too, because its mirror image {} is: a role needs both sides",
                      image->line, one_line(image->name), name));
    }
  }
}

}  // namespace koboshi::tools
