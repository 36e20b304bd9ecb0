#include "firmware/estimation/inertial_link.h"

#include "firmware/fixed/contract.h"
#include "firmware/fixed/saturating.h"

namespace koboshi::estimation {

using fixed::AngularRate;

namespace {

// From an angle in a cycle of 10 ms to a rate: 100 cycles a second, and LSB of 2^-32 turn and 2^-24 turn/s.
constexpr std::int64_t kCyclesPerSecond = 100;
constexpr int kShift = fixed::Angle::kFractionBits - AngularRate::kFractionBits;

}  // namespace

AngularRate InertialLink::speed(robot::JointIndex joint, fixed::Angle angle) {
  const std::int64_t change_raw = (angle - last_[joint]).raw();
  last_[joint] = angle;
  if (!started_) return AngularRate();
  const AngularRate now = AngularRate::from_wide_raw(change_raw * kCyclesPerSecond / (1 << kShift));
  return speeds_[joint] = (speeds_[joint] + now) / 2;
}

// From the link up to the trunk: rotation and rate in the axes of each joint's parent.
void InertialLink::update(std::span<const fixed::Angle> angles) {
  KOBOSHI_ASSERT(angles.size() >= model_.joint_count);
  robot::Rotation R;
  Rates w{};
  robot::LinkIndex link = model_.imu_link;
  for (std::size_t steps = 0; !link.is_trunk() && steps < model_.hinge_count(); ++steps) {
    const robot::JointIndex i = link.joint();
    const robot::Joint& joint = model_.joints[i];
    const fixed::Angle angle = model_.hinge_angle(angles, i);
    const robot::Rotation R_ParentChild = robot::rotation_about(joint.axis, angle);
    const AngularRate rate = speed(i, angle);
    w = R_ParentChild * w + Rates{fixed::product<AngularRate>(joint.axis.x, rate),
                                  fixed::product<AngularRate>(joint.axis.y, rate),
                                  fixed::product<AngularRate>(joint.axis.z, rate)};
    R = R_ParentChild * R;
    link = joint.parent;
  }
  started_ = true;
  R_BL_ = R;
  w_BL_B_ = w;
}

}  // namespace koboshi::estimation
