#include "firmware/policy/signals.h"

#include <algorithm>

#include "firmware/fixed/contract.h"
#include "firmware/fixed/trigonometry.h"

namespace koboshi::policy {
namespace {

constexpr std::int32_t kOneSignal = 1 << 24;
constexpr int kVelocityBits = 14;

std::int32_t bounded(std::int32_t value) { return std::clamp(value, -kMaxSignal, kMaxSignal); }
std::int32_t signal_of(fixed::Angle angle) { return angle.raw() >> 8; }
std::int32_t signal_of(fixed::AngularRate rate) { return rate.raw() >> 4; }
std::int32_t signal_of(fixed::Acceleration acceleration) { return acceleration.raw() >> 4; }
std::int32_t signal_of(fixed::Ratio ratio) { return ratio.raw() >> 6; }
std::int32_t signal_of(fixed::Length length) { return bounded(length.raw()); }
std::int32_t signal_of(fixed::Force force) { return bounded(force.raw()); }

// Speed from two angles in 2^-24 turn, 10 ms apart: |difference| * 100 < 2^31, since a joint has at most a
// turn.
std::int32_t rate_of(std::int32_t difference) { return bounded(difference * 100 >> 4); }

}  // namespace

void Signals::update(const Observation& seen) {
  KOBOSHI_ASSERT(seen.angles.size() <= robot::kMaxJoints && seen.targets.size() == seen.angles.size());
  const estimation::RobotState& robot = seen.robot;
  using enum Signal;
  at(kRoll) = signal_of(robot.roll);
  at(kPitch) = signal_of(robot.pitch);
  at(kPlannedPitch) = signal_of(seen.planned_pitch);
  at(kUpX, 0) = signal_of(robot.up_B.x);
  at(kUpX, 1) = signal_of(robot.up_B.y);
  at(kUpX, 2) = signal_of(robot.up_B.z);
  at(kRollRate, 0) = signal_of(robot.rates_B.x);
  at(kRollRate, 1) = signal_of(robot.rates_B.y);
  at(kRollRate, 2) = signal_of(robot.rates_B.z);
  at(kAccelerationX, 0) = signal_of(robot.accelerations_B.x);
  at(kAccelerationX, 1) = signal_of(robot.accelerations_B.y);
  at(kAccelerationX, 2) = signal_of(robot.accelerations_B.z);
  at(kVelocity, 0) = seen.velocity.forward_mm_per_s * (1 << kVelocityBits);
  at(kVelocity, 1) = seen.velocity.left_mm_per_s * (1 << kVelocityBits);
  at(kVelocity, 2) = seen.velocity.turn_mrad_per_s * (1 << kVelocityBits);
  for (std::size_t foot = 0; foot < robot.feet.size(); ++foot) {
    at(kLoad, foot) = signal_of(robot.feet[foot].load);
    at(kZmp, 2 * foot) = signal_of(robot.feet[foot].x);
    at(kZmp, 2 * foot + 1) = signal_of(robot.feet[foot].y);
  }
  const fixed::SineCosine phase = seen.phase ? fixed::sin_cos(*seen.phase) : fixed::SineCosine{};
  at(kPhaseSine) = signal_of(phase.sine);
  at(kPhaseCosine) = signal_of(phase.cosine);
  at(kSwing) = !seen.swing ? 0 : *seen.swing == hal::Side::kLeft ? kOneSignal : -kOneSignal;
  for (std::size_t joint = 0; joint < seen.angles.size(); ++joint) {
    const std::int32_t angle = signal_of(seen.angles[joint]);
    at(kJointRate, joint) = has_angles_ ? rate_of(angle - at(kJointAngle, joint)) : 0;
    at(kJointAngle, joint) = angle;
    at(kJointTarget, joint) = signal_of(seen.targets[joint]);
  }
  has_angles_ = true;
}

void Signals::set_output(std::size_t output, fixed::Angle offset) {
  KOBOSHI_ASSERT(output < kMaxOutputs);
  at(Signal::kOutput, output) = signal_of(offset);
}

}  // namespace koboshi::policy
