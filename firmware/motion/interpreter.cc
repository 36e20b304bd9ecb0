#include "firmware/motion/interpreter.h"

#include <algorithm>

#include "firmware/fixed/contract.h"
#include "firmware/fixed/interpolation.h"

namespace koboshi::motion {

using fixed::Angle;
using robot::clamp_to_limits;

Interpreter::Interpreter(const robot::RobotModel& model, const robot::Direction& up_B)
    : model_(model), up_B_(up_B) {
  for (std::size_t i = 0; i < model_.joint_count; ++i)
    targets_[i] = clamp_to_limits(model_.joints[i], Angle());
  from_ = targets_;
  to_ = targets_;
}

void Interpreter::start(const Motion& motion, std::span<const Angle> pose) {
  KOBOSHI_ASSERT(pose.size() == model_.joint_count);
  motion_ = motion;
  running_ = true;
  stopping_ = false;
  failed_ = false;
  loop_depth_ = 0;
  for (std::size_t i = 0; i < model_.joint_count; ++i)
    targets_[i] = clamp_to_limits(model_.joints[i], pose[i]);
  from_ = targets_;
  to_ = targets_;
  enter(0);
}

void Interpreter::advance(std::uint32_t elapsed_us) {
  std::uint32_t left_us = std::min(elapsed_us, kMaxAdvance_us);
  while (running_ && left_us > 0) {
    const std::uint32_t step_left_us = step_time_us_ - step_elapsed_us_;
    if (left_us < step_left_us) {
      step_elapsed_us_ += left_us;
      left_us = 0;
    } else {
      left_us -= step_left_us;
      from_ = to_;
      enter(static_cast<std::uint16_t>(step_index_ + 1));
    }
  }
  interpolate();
}

// Goes through steps that take no time until one that does. The validator has bounded their number; the bound
// here is for the reader.
void Interpreter::enter(std::uint16_t index) {
  step_elapsed_us_ = 0;
  for (std::size_t count = 0; count < kMaxSteps; ++count) {
    step_index_ = index;
    const Step step = motion_.step(index);
    step_time_us_ = takes_time(step.opcode) ? step.time_us : 0;
    switch (step.opcode) {
      case Opcode::kMove:
        return begin_move(step);
      case Opcode::kWait:
        return;
      case Opcode::kLoopBegin:
        index = next_of_loop_begin(index, step);
        break;
      case Opcode::kLoopEnd:
        index = next_of_loop_end(index, step);
        break;
      case Opcode::kJump:
        index = next_of_jump(index, step);
        break;
      case Opcode::kExpect:
        failed_ = !ExpectedAttitude::of(step).is_met_by(up_B_);
        if (failed_) {
          running_ = false;
          return;
        }
        ++index;
        break;
      case Opcode::kEnd:
        running_ = false;
        return;
    }
  }
  running_ = false;
}

void Interpreter::begin_move(const Step& step) {
  const std::uint32_t mask = motion_.joint_mask(step.operand);
  for (std::size_t i = 0; i < model_.joint_count; ++i) {
    if ((mask >> i & 1u) != 0) to_[i] = motion_.angle(step.operand, i);
  }
}

std::uint16_t Interpreter::next_of_loop_begin(std::uint16_t index, const Step& step) {
  rounds_left_[loop_depth_++] = step.operand;
  return static_cast<std::uint16_t>(index + 1);
}

std::uint16_t Interpreter::next_of_loop_end(std::uint16_t index, const Step& step) {
  std::uint16_t& rounds_left = rounds_left_[loop_depth_ - 1];
  if (stopping_ || rounds_left == 1) {
    --loop_depth_;
    return static_cast<std::uint16_t>(index + 1);
  }
  if (rounds_left > 1) --rounds_left;
  return static_cast<std::uint16_t>(step.operand + 1);
}

std::uint16_t Interpreter::next_of_jump(std::uint16_t index, const Step& step) const {
  const bool backwards = step.operand <= index;
  return stopping_ && backwards ? static_cast<std::uint16_t>(index + 1) : step.operand;
}

void Interpreter::interpolate() {
  const fixed::Ratio fraction = fixed::elapsed_fraction(static_cast<std::int32_t>(step_elapsed_us_),
                                                        static_cast<std::int32_t>(step_time_us_));
  for (std::size_t i = 0; i < model_.joint_count; ++i) {
    targets_[i] = fixed::interpolate(from_[i], to_[i], fraction);
  }
}

}  // namespace koboshi::motion
