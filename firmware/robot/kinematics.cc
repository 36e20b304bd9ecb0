#include "firmware/robot/kinematics.h"

#include "firmware/fixed/contract.h"
#include "firmware/fixed/rounding.h"

namespace koboshi::robot {

using fixed::Length;
using fixed::Mass;

void forward_kinematics(const RobotModel& model, std::span<const fixed::Angle> angles, LinkPoses& X_BLinks) {
  KOBOSHI_ASSERT(angles.size() >= model.joint_count);
  for (std::size_t step = 0; step < model.hinge_count(); ++step) {
    const JointIndex i = model.order[step];
    const Joint& joint = model.joints[i];
    const fixed::Angle angle = model.hinge_angle(angles, i);
    Pose& X_BLink = X_BLinks[i];
    if (joint.parent.is_trunk()) {
      X_BLink = {rotation_about(joint.axis, angle), joint.anchor};
      continue;
    }
    const Pose& X_BParent = X_BLinks[joint.parent.joint()];
    X_BLink = X_BParent;
    if (joint.anchor != Position()) X_BLink.p = X_BParent.p + X_BParent.R * joint.anchor;
    turn_about(X_BLink.R, joint.axis, angle);
  }
}

Pose sole_pose(const RobotModel& model, hal::Side side, const LinkPoses& X_BLinks) {
  const Pose& X_BFoot = X_BLinks[model.foot_joint(side)];
  const Length ankle_height = model.feet[side].ankle_height;
  return {X_BFoot.R, X_BFoot.p + X_BFoot.R * Position{.x = {}, .y = {}, .z = -ankle_height}};
}

namespace {

// Sums mass times coordinate, in LSB of Mass times LSB of Length. All masses together are at most
// kMaxRobotMass, 2^30, and no link is farther than kMaxJoints + 1 times kMaxOffset, 2^29: the sums stay
// within 2^59.
class MomentSum {
 public:
  void add(Mass mass, const Position& p) {
    mass_raw_ += mass.raw();
    x_raw_ += std::int64_t{mass.raw()} * p.x.raw();
    y_raw_ += std::int64_t{mass.raw()} * p.y.raw();
    z_raw_ += std::int64_t{mass.raw()} * p.z.raw();
  }

  [[nodiscard]] Position centre() const { return {divided(x_raw_), divided(y_raw_), divided(z_raw_)}; }

 private:
  [[nodiscard]] Length divided(std::int64_t moment_raw) const {
    return Length::from_wide_raw(fixed::divide_rounded(moment_raw, mass_raw_));
  }

  std::int64_t mass_raw_ = 0;
  std::int64_t x_raw_ = 0;
  std::int64_t y_raw_ = 0;
  std::int64_t z_raw_ = 0;
};

}  // namespace

fixed::Mass total_mass(const RobotModel& model) {
  fixed::Mass total = model.base_mass;
  for (std::size_t i = 0; i < model.hinge_count(); ++i) total += model.joints[i].mass;
  return total;
}

Position centre_of_mass(const RobotModel& model, const LinkPoses& X_BLinks) {
  MomentSum sum;
  sum.add(model.base_mass, model.base_centre_of_mass);
  for (std::size_t i = 0; i < model.hinge_count(); ++i) {
    const Joint& joint = model.joints[i];
    sum.add(joint.mass, X_BLinks[i].p + X_BLinks[i].R * joint.centre_of_mass);
  }
  return sum.centre();
}

}  // namespace koboshi::robot
