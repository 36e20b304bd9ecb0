#include "firmware/behaviour/joint_stream.h"

#include <algorithm>

#include "firmware/fixed/contract.h"
#include "hal/port/period.h"

namespace koboshi::behaviour {

namespace {

// The travel of a joint in one control cycle at this speed, 2^-32 turn. The rate has 24 fraction bits.
std::int64_t travel_per_cycle_raw(fixed::AngularRate speed) {
  constexpr int kToAngle = fixed::Angle::kFractionBits - fixed::AngularRate::kFractionBits;
  constexpr std::int64_t kCycles_per_s = 1'000'000 / hal::kControlPeriod_us;
  return (std::int64_t{speed.raw()} << kToAngle) / kCycles_per_s;
}

}  // namespace

void JointStream::start(std::span<const fixed::Angle> targets, std::span<const fixed::Angle> standing,
                        std::int16_t ramp_rate) {
  KOBOSHI_ASSERT(targets.size() == model_.joint_count && standing.size() == targets.size() && ramp_rate > 0);
  std::ranges::copy(targets, targets_.begin());
  std::ranges::copy(standing, standing_.begin());
  ramp_rate_ = ramp_rate;
  phase_ = Phase::kFollowing;
  goals_ = targets_;
  softened_ = 0;
}

void JointStream::resume() {
  KOBOSHI_ASSERT(running());
  if (phase_ == Phase::kFollowing) return;
  phase_ = Phase::kFollowing;
  goals_ = targets_;
  softened_ = 0;
}

bool JointStream::take(std::span<const fixed::Angle> targets, std::span<const std::uint8_t> torques_percent) {
  KOBOSHI_ASSERT(targets.size() >= model_.joint_count && torques_percent.size() >= model_.joint_count);
  if (phase_ != Phase::kFollowing) return false;
  softened_ = 0;
  for (std::size_t joint = 0; joint < model_.joint_count; ++joint) {
    goals_[joint] = robot::clamp_to_limits(model_.joints[joint], targets[joint]);
    torques_percent_[joint] = torques_percent[joint];
    if (torques_percent[joint] > 0 && torques_percent[joint] < kFullTorque_percent) softened_ |= 1u << joint;
  }
  return true;
}

void JointStream::stop() {
  if (phase_ != Phase::kFollowing) return;
  phase_ = Phase::kReturning;
  const std::size_t joints = model_.joint_count;
  return_.begin({targets_.data(), joints}, {standing_.data(), joints}, ramp_rate_);
}

void JointStream::advance(std::uint32_t elapsed_us, const motion::Inputs& inputs,
                          std::span<fixed::Angle> targets) {
  KOBOSHI_ASSERT(elapsed_us == hal::kControlPeriod_us && targets.size() == model_.joint_count);
  if (phase_ == Phase::kEnded) return;
  if (phase_ == Phase::kFollowing) {
    follow();
  } else {
    return_.advance(elapsed_us, inputs, {targets_.data(), targets.size()});
    if (!return_.running()) phase_ = Phase::kEnded;
  }
  std::ranges::copy(std::span(targets_).first(targets.size()), targets.begin());
}

// Differences of angles within a joint's limits may exceed half a turn: they are taken in 64 bits, so that no
// joint goes the other way round.
void JointStream::follow() {
  for (std::size_t joint = 0; joint < model_.joint_count; ++joint) {
    const std::int64_t most_raw = travel_per_cycle_raw(model_.joints[joint].max_speed);
    const std::int64_t way_raw = std::int64_t{goals_[joint].raw()} - targets_[joint].raw();
    const std::int64_t step_raw = std::clamp(way_raw, -most_raw, most_raw);
    targets_[joint] = fixed::Angle::from_raw(static_cast<std::int32_t>(targets_[joint].raw() + step_raw));
  }
}

}  // namespace koboshi::behaviour
