#include "firmware/motion/mixer.h"

#include <algorithm>
#include <array>
#include <bit>

#include "firmware/fixed/rounding.h"

namespace koboshi::motion {
namespace {

constexpr int kGainBits = 12;

// The measured deviation of each MixSource, in 2^-32 turn or 2^-32 turn/s.
std::array<std::int64_t, static_cast<std::size_t>(kLastMixSource) + 1> deviations(
    const estimation::RobotState& robot, const Lean& lean) {
  constexpr std::int64_t kRateScale = 1 << (fixed::Angle::kFractionBits - fixed::AngularRate::kFractionBits);
  return {robot.rates_B.x.raw() * kRateScale, robot.rates_B.y.raw() * kRateScale,
          robot.rates_B.z.raw() * kRateScale, (robot.roll - lean.roll).raw(),
          (robot.pitch - lean.pitch).raw()};
}

}  // namespace

bool Mixer::set(const Mix& mix) {
  const auto end = mixes_.begin() + static_cast<std::ptrdiff_t>(count_);
  const auto place = std::find_if(mixes_.begin(), end, [&](const Mix& other) {
    return other.joint == mix.joint && other.source == mix.source;
  });
  if (mix.gain == 0) {
    if (place != end) remove(static_cast<std::size_t>(place - mixes_.begin()));
    return true;
  }
  if (place == end) {
    if (count_ == kMaxMixes) return false;
    last_raw_[count_++] = 0;
  }
  *place = mix;
  return true;
}

void Mixer::reset() {
  count_ = 0;
  fading_ = 0;
  fades_ = {};
}

void Mixer::remove(std::size_t place) {
  const std::size_t joint = mixes_[place].joint;
  Fade& fade = fades_[joint];
  fade = {fade.value_raw() + last_raw_[place], kFade_us};
  fading_ |= 1u << joint;
  --count_;
  mixes_[place] = mixes_[count_];
  last_raw_[place] = last_raw_[count_];
}

void Mixer::fade(std::uint32_t elapsed_us) {
  for (std::size_t joint = 0; joint < fades_.size(); ++joint) {
    Fade& fade = fades_[joint];
    fade.left_us -= std::min(fade.left_us, elapsed_us);
    if (fade.left_us == 0) fading_ &= ~(1u << joint);
  }
}

void Mixer::add_all(std::span<fixed::Angle> targets, const robot::RobotModel& model,
                    const estimation::RobotState& robot, const Lean& lean) {
  const auto turn = [&](std::size_t number, std::int64_t change_raw) {
    const robot::Joint& joint = model.joints[number];
    const std::int64_t target_raw = targets[number].raw() + change_raw;
    targets[number] = fixed::Angle::from_raw(static_cast<std::int32_t>(
        std::clamp<std::int64_t>(target_raw, joint.lower.raw(), joint.upper.raw())));
  };
  const auto measured = deviations(robot, lean);
  for (std::size_t i = 0; i < count_; ++i) {
    const Mix& mix = mixes_[i];
    const std::int64_t limit = std::int64_t{mix.limit} << (fixed::Angle::kFractionBits - 16);
    const std::int64_t change =
        fixed::shift_rounded(measured[static_cast<std::size_t>(mix.source)] * mix.gain, kGainBits);
    last_raw_[i] = static_cast<std::int32_t>(std::clamp(change, -limit, limit));
    turn(mix.joint, last_raw_[i]);
  }
  for (std::uint32_t joints = fading_; joints != 0; joints &= joints - 1) {
    const auto joint = static_cast<std::size_t>(std::countr_zero(joints));
    turn(joint, fades_[joint].value_raw());
  }
}

}  // namespace koboshi::motion
