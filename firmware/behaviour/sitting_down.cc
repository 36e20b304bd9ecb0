#include "firmware/behaviour/sitting_down.h"

namespace koboshi::behaviour {

void SittingDown::begin(MotionSource* last) {
  last_ = last;
  if (last_ != nullptr) last_->stop();
  phase_ = Phase::kEnding;
  done_ = false;
}

// Without a motion, which the caller has checked, or with one that failed, the robot keeps its pose.
void SittingDown::advance(std::uint32_t elapsed_us, const motion::Inputs& inputs,
                          std::span<fixed::Angle> targets) {
  if (phase_ == Phase::kIdle) return;
  if (phase_ == Phase::kEnding) {
    if (last_ != nullptr && last_->running()) {
      last_->advance(elapsed_us, inputs, targets);
      if (last_->running()) return;
    }
    last_ = nullptr;
    phase_ = player_.start(motion::Role::kSit, targets, inputs) ? Phase::kSitting : Phase::kIdle;
    return;
  }
  player_.advance(elapsed_us, inputs, targets);
  if (player_.running()) return;
  done_ = !player_.interpreter().failed();
  phase_ = Phase::kIdle;
}

void SittingDown::abort() {
  last_ = nullptr;
  phase_ = Phase::kIdle;
  done_ = false;
}

Plan SittingDown::plan() const {
  if (phase_ == Phase::kSitting) return player_.plan();
  return last_ != nullptr ? last_->plan() : Plan();
}

}  // namespace koboshi::behaviour
