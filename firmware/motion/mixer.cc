#include "firmware/motion/mixer.h"

#include <algorithm>

#include "firmware/fixed/rounding.h"

namespace koboshi::motion {
namespace {

constexpr int kGainBits = 12;

// The deviation that a source measures, in 2^-32 turn or turn/s.
std::int64_t deviation(MixSource source, const estimation::RobotState& robot, const Lean& lean) {
  constexpr std::int64_t kRateScale = 1 << (fixed::Angle::kFractionBits - fixed::AngularRate::kFractionBits);
  switch (source) {
    case MixSource::kRollRate:
      return robot.rates_B.x.raw() * kRateScale;
    case MixSource::kPitchRate:
      return robot.rates_B.y.raw() * kRateScale;
    case MixSource::kYawRate:
      return robot.rates_B.z.raw() * kRateScale;
    case MixSource::kRoll:
      return (robot.roll - lean.roll).raw();
    case MixSource::kPitch:
      return (robot.pitch - lean.pitch).raw();
  }
  return 0;
}

}  // namespace

bool Mixer::set(const Mix& mix) {
  const auto end = mixes_.begin() + static_cast<std::ptrdiff_t>(count_);
  const auto place = std::find_if(mixes_.begin(), end, [&](const Mix& other) {
    return other.joint == mix.joint && other.source == mix.source;
  });
  if (mix.gain == 0) {
    if (place != end) *place = mixes_[--count_];
    return true;
  }
  if (place == end) {
    if (count_ == kMaxMixes) return false;
    ++count_;
  }
  *place = mix;
  return true;
}

void Mixer::add_to(std::span<fixed::Angle> targets, const robot::RobotModel& model,
                   const estimation::RobotState& robot, const Lean& lean) const {
  for (const Mix& mix : std::span(mixes_).first(count_)) {
    const std::int64_t limit = std::int64_t{mix.limit} << (fixed::Angle::kFractionBits - 16);
    const std::int64_t change =
        fixed::shift_rounded(deviation(mix.source, robot, lean) * mix.gain, kGainBits);
    const std::int64_t target = targets[mix.joint].raw() + std::clamp(change, -limit, limit);
    const robot::Joint& joint = model.joints[mix.joint];
    targets[mix.joint] = fixed::Angle::from_raw(
        static_cast<std::int32_t>(std::clamp<std::int64_t>(target, joint.lower.raw(), joint.upper.raw())));
  }
}

}  // namespace koboshi::motion
