#include "firmware/behaviour/motion_player.h"

#include <algorithm>

namespace koboshi::behaviour {

void MotionPlayer::start(const motion::Motion& motion, std::uint8_t number,
                         std::span<const fixed::Angle> targets, const motion::Inputs& inputs) {
  number_ = number;
  interpreter_.start(motion, targets, inputs);
}

bool MotionPlayer::start(motion::Role role, std::span<const fixed::Angle> targets,
                         const motion::Inputs& inputs) {
  const auto number = library_.number_of(role);
  motion::Motion motion;
  if (!number || !library_.open_to_play(storage::Holder::kPlayer, *number, motion)) return false;
  start(motion, static_cast<std::uint8_t>(*number), targets, inputs);
  return true;
}

void MotionPlayer::advance(std::uint32_t elapsed_us, const motion::Inputs& inputs,
                           std::span<fixed::Angle> targets) {
  interpreter_.advance(elapsed_us, inputs);
  std::ranges::copy(interpreter_.targets(), targets.begin());
  interpreter_.add_corrections(targets, inputs.robot);
}

Plan MotionPlayer::plan() const {
  const auto bounded = [this](fixed::Angle lean) {
    constexpr int kScale = 1 << (fixed::Angle::kFractionBits - 16);
    const std::int32_t bound_raw = parameters_.max_declared_lean * kScale;
    return fixed::Angle::from_raw(std::clamp(lean.raw(), -bound_raw, bound_raw));
  };
  const motion::Lean lean = interpreter_.lean();
  return {.lean = {.roll = bounded(lean.roll), .pitch = bounded(lean.pitch)},
          .pitch = {},
          .feedback = balance::FeedbackMode::kMotion};
}

}  // namespace koboshi::behaviour
