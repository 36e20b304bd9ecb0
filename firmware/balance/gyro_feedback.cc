#include "firmware/balance/gyro_feedback.h"

#include <algorithm>

#include "firmware/fixed/rounding.h"
#include "firmware/fixed/saturating.h"
#include "firmware/robot/leg.h"

namespace koboshi::balance {
namespace {

constexpr int kGainFractionBits = 12;

fixed::Angle correction(std::int16_t gain, fixed::AngularRate rate) {
  constexpr int kShift = kGainFractionBits + fixed::AngularRate::kFractionBits - fixed::Angle::kFractionBits;
  constexpr std::int64_t kMax_raw = GyroFeedback::kMaxCorrection.raw();
  const std::int64_t angle_raw = fixed::shift_rounded(std::int64_t{gain} * rate.raw(), kShift);
  return fixed::Angle::from_raw(static_cast<std::int32_t>(std::clamp(angle_raw, -kMax_raw, kMax_raw)));
}

}  // namespace

GyroFeedback::GyroFeedback(const robot::RobotModel& model) {
  for (const hal::Side side : {hal::Side::kLeft, hal::Side::kRight}) {
    robot::LegGeometry geometry;
    if (!robot::make_leg_geometry(model, side, geometry)) continue;
    const auto joint = [&](std::size_t i) { return Joint{geometry.joints[i], geometry.signs[i]}; };
    legs_[static_cast<std::size_t>(side)] = {joint(robot::kHipRoll), joint(robot::kKnee),
                                             joint(robot::kAnklePitch), joint(robot::kAnkleRoll)};
  }
}

void GyroFeedback::correct(const FeedbackGains& gains, const robot::Vector<fixed::AngularRate>& rates,
                           std::span<fixed::Angle> targets) const {
  const fixed::Angle hip_roll = correction(gains.hip_roll, rates.x);
  const fixed::Angle knee = correction(gains.knee, rates.y);
  const fixed::Angle ankle_pitch = correction(gains.ankle_pitch, rates.y);
  const fixed::Angle ankle_roll = correction(gains.ankle_roll, rates.x);
  const auto turn = [&](Joint joint, fixed::Angle angle) {
    fixed::Angle& target = targets[joint.index];
    target = fixed::Angle::from_raw(fixed::add_saturated(target.raw(), joint.sign * angle.raw()));
  };
  for (const Leg& leg : legs_) {
    turn(leg.hip_roll, hip_roll);
    turn(leg.knee, knee);
    turn(leg.ankle_pitch, ankle_pitch);
    turn(leg.ankle_roll, ankle_roll);
  }
}

}  // namespace koboshi::balance
