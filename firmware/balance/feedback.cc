#include "firmware/balance/feedback.h"

#include <algorithm>

#include "firmware/fixed/contract.h"
#include "firmware/fixed/dead_band.h"
#include "firmware/fixed/rounding.h"
#include "firmware/fixed/saturating.h"
#include "firmware/robot/leg.h"

namespace koboshi::balance {
namespace {

constexpr int kGainFractionBits = 12;

fixed::Angle correction(std::int16_t rate_gain, fixed::AngularRate rate, std::int16_t lean_gain,
                        fixed::Angle lean) {
  constexpr int kRateShift = fixed::Angle::kFractionBits - fixed::AngularRate::kFractionBits;
  constexpr std::int64_t kMax_raw = Feedback::kMaxCorrection.raw();
  const std::int64_t product =
      (std::int64_t{rate_gain} * rate.raw() << kRateShift) + std::int64_t{lean_gain} * lean.raw();
  const std::int64_t angle_raw = fixed::shift_rounded(product, kGainFractionBits);
  return fixed::Angle::from_raw(static_cast<std::int32_t>(std::clamp(angle_raw, -kMax_raw, kMax_raw)));
}

}  // namespace

Feedback::Feedback(const robot::RobotModel& model) : joints_(model.joint_count) {
  for (const hal::Side side : {hal::Side::kLeft, hal::Side::kRight}) {
    const auto joint = [&](robot::LegJoint place) {
      const auto index = model.find(robot::leg_role(side, place));
      return index ? Joint{*index, robot::leg_sign(model.joints[*index], place)} : Joint();
    };
    legs_[side] = {joint(robot::kHipRoll), joint(robot::kHipPitch), joint(robot::kKnee),
                   joint(robot::kAnklePitch), joint(robot::kAnkleRoll)};
    set_hip(model, side, legs_[side]);
  }
}

// Cramer's rule for the axes a, b, c of yaw, roll and pitch: the first row of the inverse of (a b c) is
// (b x c) / det, and so on. Hips whose roll and pitch have their own axes need none of that, and neither do
// those without a yaw of their own, whose two joints are taken for roll and pitch.
void Feedback::set_hip(const robot::RobotModel& model, hal::Side side, Leg& leg) {
  // Below it the hip cannot turn the leg about all axes. By hand, 2026-11-27: 1 where the axes are
  // orthogonal.
  constexpr fixed::Ratio kMinDeterminant = fixed::Ratio::from_raw(1 << 28);
  const auto yaw = model.find(robot::leg_role(side, robot::kHipYaw));
  if (!yaw || model.leads(*yaw) || leg.hip_roll.sign == 0 || leg.hip_pitch.sign == 0) return;
  leg.hips = {*yaw, leg.hip_roll.index, leg.hip_pitch.index};
  const robot::Direction& a = model.joints[leg.hips[0]].axis;
  const robot::Direction& b = model.joints[leg.hips[1]].axis;
  const robot::Direction& c = model.joints[leg.hips[2]].axis;
  const bool has_own_axes =
      (b == robot::kAxisX || b == -robot::kAxisX) && (c == robot::kAxisY || c == -robot::kAxisY);
  const fixed::Ratio determinant = dot(a, cross(b, c));
  if (has_own_axes || fixed::abs(determinant) < kMinDeterminant) return;
  const std::array rows{cross(b, c), cross(c, a), cross(a, b)};
  for (std::size_t i = 0; i < rows.size(); ++i) {
    leg.for_roll[i] = fixed::quotient<fixed::Ratio>(rows[i].x, determinant);
    leg.for_pitch[i] = fixed::quotient<fixed::Ratio>(rows[i].y, determinant);
  }
  leg.has_oblique_hip = true;
}

void Feedback::correct(const FeedbackGains& gains, const estimation::TrunkMotion& trunk,
                       std::span<fixed::Angle> targets, std::optional<hal::Side> support) const {
  KOBOSHI_ASSERT(targets.size() >= joints_);
  const auto& [rate, lean] = gains;
  const auto in_roll = [&](std::int16_t JointGains::*joint) {
    return correction(rate.*joint, trunk.roll_rate, lean.*joint, trunk.roll);
  };
  const auto in_pitch = [&](std::int16_t JointGains::*joint) {
    return correction(rate.*joint, trunk.pitch_rate, lean.*joint, trunk.pitch);
  };
  const fixed::Angle hip_roll = in_roll(&JointGains::hip_roll);
  const fixed::Angle hip_pitch = in_pitch(&JointGains::hip_pitch);
  const fixed::Angle knee = in_pitch(&JointGains::knee);
  const fixed::Angle ankle_pitch = in_pitch(&JointGains::ankle_pitch);
  const fixed::Angle ankle_roll = in_roll(&JointGains::ankle_roll);
  const auto turn = [&](Joint joint, fixed::Angle angle) {
    if (joint.sign == 0) return;
    fixed::Angle& target = targets[joint.index];
    target = fixed::Angle::from_raw(fixed::add_saturated(target.raw(), joint.sign * angle.raw()));
  };
  for (const hal::Side side : {hal::Side::kLeft, hal::Side::kRight}) {
    if (support && side != *support) continue;
    const Leg& leg = legs_[side];
    if (leg.has_oblique_hip) {
      for (std::size_t i = 0; i < leg.hips.size(); ++i)
        turn({leg.hips[i], 1}, fixed::product<fixed::Angle>(leg.for_roll[i], hip_roll) +
                                   fixed::product<fixed::Angle>(leg.for_pitch[i], hip_pitch));
    } else {
      turn(leg.hip_roll, hip_roll);
      turn(leg.hip_pitch, hip_pitch);
    }
    turn(leg.knee, knee);
    turn(leg.ankle_pitch, ankle_pitch);
    turn(leg.ankle_roll, ankle_roll);
  }
}

void Feedback::correct(FeedbackMode mode, const FeedbackParameters& parameters,
                       const estimation::TrunkMotion& trunk, std::optional<hal::Side> support,
                       std::span<fixed::Angle> targets) const {
  switch (mode) {
    case FeedbackMode::kNone:
      return;
    case FeedbackMode::kMotion:
      return correct({.rate = parameters.motion, .lean = {}}, trunk, targets);
    case FeedbackMode::kWalking:
      return correct(parameters.walking, trunk, targets, support);
    case FeedbackMode::kStanding: {
      const auto half_width = fixed::AngularRate::from_raw(parameters.standing_dead_band << 12);
      estimation::TrunkMotion beyond_it = trunk;
      beyond_it.roll_rate = fixed::dead_band(trunk.roll_rate, half_width);
      beyond_it.pitch_rate = fixed::dead_band(trunk.pitch_rate, half_width);
      return correct(parameters.standing, beyond_it, targets);
    }
  }
}

}  // namespace koboshi::balance
