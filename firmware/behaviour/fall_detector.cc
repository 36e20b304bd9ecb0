#include "firmware/behaviour/fall_detector.h"

#include <algorithm>

#include "firmware/fixed/rounding.h"
#include "firmware/fixed/saturating.h"

namespace koboshi::behaviour {

namespace {

constexpr std::int32_t kFull_percent = 100;
constexpr int kAngleShift = 16;  // from an Angle to units of the limits

constexpr std::int32_t short_angle(fixed::Angle angle) { return angle.raw() >> kAngleShift; }

// The lean after `lead_ms` at its present rate, in units of the limits; saturates at half a turn.
constexpr std::int32_t predicted(fixed::Angle lean, fixed::AngularRate rate, std::int16_t lead_ms) {
  constexpr int kRateShift = fixed::AngularRate::kFractionBits - 16;
  const std::int32_t change = (rate.raw() >> kRateShift) * lead_ms / 1'000;
  return fixed::saturate<std::int16_t>(short_angle(lean) + change);
}

constexpr std::int64_t square(std::int32_t value) { return std::int64_t{value} * value; }

constexpr bool is_within(std::int32_t value, std::int16_t limit) { return value < limit && -value < limit; }

}  // namespace

FallDirection FallDetector::update(const FallLimits& limits, const estimation::TrunkMotion& trunk,
                                   std::optional<std::uint16_t> error_percent) {
  const bool leans = !is_within(short_angle(trunk.pitch), limits.min_lean) ||
                     !is_within(short_angle(trunk.roll), limits.min_lean);
  if (!leans) armed_ = true;
  const std::int32_t forward = predicted(trunk.pitch, trunk.pitch_rate, limits.lead_ms);
  const std::int32_t right = predicted(trunk.roll, trunk.roll_rate, limits.lead_ms);
  const bool steps = error_percent.has_value() && limits.uncatchable_percent > 0;
  const std::int32_t percent = steps ? limits.walking_percent : kFull_percent;
  const std::int32_t length = (forward < 0 ? limits.back : limits.front) * percent / kFull_percent;
  const std::int32_t side = limits.side * percent / kFull_percent;
  // The ellipse without its divisions: times (length * side)^2.
  const std::int64_t sagittal = square(forward) * square(side);
  const std::int64_t lateral = square(right) * square(length);
  const bool beyond = sagittal + lateral > square(length) * square(side) ||
                      (steps && *error_percent > limits.uncatchable_percent);
  const auto cycles = static_cast<std::uint16_t>(std::max<std::int16_t>(limits.cycles, 1));
  if (!beyond_.update(armed_ && leans && beyond && limits.are_set(), cycles)) return FallDirection::kNone;
  disarm();
  if (sagittal >= lateral) return forward < 0 ? FallDirection::kBack : FallDirection::kFront;
  return right < 0 ? FallDirection::kLeft : FallDirection::kRight;
}

void FallDetector::disarm() {
  armed_ = false;
  beyond_.reset();
}

}  // namespace koboshi::behaviour
