#include "firmware/walk/gait.h"

#include <algorithm>

#include "firmware/fixed/literals.h"
#include "firmware/fixed/radians.h"
#include "firmware/fixed/rounding.h"
#include "firmware/walk/pendulum.h"

namespace koboshi::walk {

using fixed::Angle;
using fixed::Force;
using fixed::Length;
using fixed::Ratio;
using namespace fixed::literals;

namespace {

constexpr std::int32_t kTick_ms = hal::kControlPeriod_us / 1'000;

Ratio permille(std::int16_t value) { return fixed::mul_div(fixed::kOne, value, 1000); }
// In two parts, because a Ratio ends at 2; an Angle ends at 3.14 rad.
Angle mrad(std::int16_t value) {
  constexpr std::int16_t kMaxPart = 1900;
  const std::int16_t part = std::min(value, kMaxPart);
  return fixed::from_rad(permille(part)) + fixed::from_rad(permille(static_cast<std::int16_t>(value - part)));
}
Angle angle(std::int16_t value) { return Angle::from_raw(std::int32_t{value} << 16); }
Force hundredths_of_N(std::int16_t value) { return fixed::mul_div(Force::from_raw(1 << 16), value, 100); }

// Raw value of 0.01 mm or 0.01 mrad in a format with `unit_raw` to the metre or rad, times 2^16.
constexpr std::int64_t hundredth(std::int64_t unit_raw) {
  return fixed::divide_rounded(unit_raw << 16, 100'000);
}
constexpr std::int64_t kLength = hundredth(1 << 24);
constexpr std::int64_t kAngle = hundredth(literal<Angle>(1.0L / kRadPerTurn).raw());
constexpr std::int64_t kRatio = hundredth(1 << 30);

std::int64_t in_raw(std::int32_t value, std::int64_t hundredth) {
  return fixed::shift_rounded(value * hundredth, 16);
}

// Distance or turn at a speed in this time.
std::int32_t distance_raw(std::int32_t value, std::int64_t hundredth, Ratio time_s) {
  return fixed::saturate<std::int32_t>(
      fixed::shift_rounded(in_raw(value, hundredth) * time_s.raw(), Ratio::kFractionBits));
}

}  // namespace

Length tenths_of_mm(std::int16_t value) { return fixed::mul_div(Length::from_raw(1 << 24), value, 10'000); }

bool is_gait(const WalkParameters& parameters) {
  const auto& step = parameters.step;
  const bool steps = step.time_ms > 0 && step.width > 0 && parameters.posture.com_height > 0;
  const bool accelerates = std::ranges::all_of(step.acceleration, [](std::int16_t each) { return each > 0; });
  const bool lands = step.max_forward > 0 && step.min_lateral > 0 && step.min_lateral <= step.max_lateral;
  return steps && accelerates && lands;
}

Gait::Gait(const WalkParameters& parameters) {
  const auto& [step, posture, reaction] = parameters;
  step_ticks = std::clamp<std::int32_t>(step.time_ms / kTick_ms, 1, Pendulum::kMaxTicks);
  step_s = fixed::mul_div(fixed::kOne, step_ticks, 100);
  double_ticks = std::clamp<std::int32_t>(step_ticks * step.double_support / 1000, 0, step_ticks - 1);
  step_width = tenths_of_mm(step.width);
  step_height = tenths_of_mm(step.height);
  swing_profile = permille(step.swing_profile);
  std::ranges::copy(step.acceleration, acceleration.begin());
  max_forward = tenths_of_mm(step.max_forward);
  max_lateral = tenths_of_mm(step.max_lateral);
  min_lateral = tenths_of_mm(step.min_lateral);
  lengthening = permille(step.lengthening);
  forward_offset = tenths_of_mm(step.forward_offset);
  zmp_forward = tenths_of_mm(posture.zmp_forward);
  zmp_inward = tenths_of_mm(posture.zmp_inward);
  carriage = {.com_height = tenths_of_mm(posture.com_height),
              .pitch = angle(posture.trunk_pitch),
              .pitch_at_1_m_per_s = angle(posture.trunk_pitch_by_speed),
              .compliance = {.pitch = mrad(posture.pitch_compliance), .roll = mrad(posture.roll_compliance)},
              .arm_swing = permille(posture.arm_swing)};
  follows_upper_body = posture.fixed_upper_body == 0;
  capture_forward = permille(reaction.capture_forward);
  capture_lateral = permille(reaction.capture_lateral);
  dead_band = tenths_of_mm(reaction.dead_band);
  smoothing = permille(reaction.smoothing);
  touchdown_load = hundredths_of_N(reaction.touchdown_load_cN);
  heading_hold = permille(reaction.heading_hold);
  plan_age_ticks = reaction.plan_age_ms / kTick_ms;
  level_swing = permille(reaction.level_swing);
  level_fade = level_swing / 5;
  zmp_tracking_forward = permille(reaction.zmp_tracking_forward);
  zmp_tracking_lateral = permille(reaction.zmp_tracking_lateral);
  max_zmp_shift_forward = tenths_of_mm(reaction.max_zmp_shift_forward);
  max_zmp_shift_lateral = tenths_of_mm(reaction.max_zmp_shift_lateral);
  arm_reaction = fixed::mul_div(1.0_gain, reaction.arm_reaction, 100);
}

// mm/s^2 over a cycle of 10 ms are hundredths of a mm/s.
void Speed::approach(const Velocity& command, const Gait& gait) {
  const std::array<std::int16_t, 3> wanted{command.forward_mm_per_s, command.left_mm_per_s,
                                           command.turn_mrad_per_s};
  for (std::size_t axis = 0; axis < values_.size(); ++axis) {
    const std::int32_t most = gait.acceleration[axis];
    values_[axis] += std::clamp(wanted[axis] * 100 - values_[axis], -most, most);
  }
}

Stride Speed::stride(const Gait& gait) const {
  const auto length = [&](std::int32_t value) {
    return Length::from_raw(distance_raw(value, kLength, gait.step_s));
  };
  return {.distance = {length(values_[0]), length(values_[1])},
          .turn = Angle::from_raw(distance_raw(values_[2], kAngle, gait.step_s))};
}

Angle Speed::lean(const Carriage& carriage) const {
  return carriage.pitch +
         fixed::product<Angle>(carriage.pitch_at_1_m_per_s, Ratio::from_wide_raw(in_raw(values_[0], kRatio)));
}

Angle Speed::turn() const { return Angle::from_raw(distance_raw(values_[2], kAngle, kTick_s)); }

}  // namespace koboshi::walk
