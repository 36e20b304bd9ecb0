#include "firmware/motion/interpreter.h"

#include <algorithm>

#include "firmware/fixed/contract.h"
#include "firmware/fixed/interpolation.h"

namespace koboshi::motion {

using fixed::Angle;

namespace {

void put(std::uint32_t& mask, std::uint32_t joints, bool set) { mask = set ? mask | joints : mask & ~joints; }

template <typename Share>
void set_share(const Share& share, std::array<std::uint8_t, robot::kMaxJoints>& percent) {
  for (std::size_t i = 0; i < percent.size(); ++i) {
    if ((share.joints >> i & 1u) != 0) percent[i] = share.percent;
  }
}

}  // namespace

void Interpreter::start(const Motion& motion, std::span<const Angle> pose, const Inputs& inputs) {
  trajectory_.reset(pose);
  state_.reset();
  mixer_.reset();
  motion_ = motion;
  running_ = true;
  failed_ = false;
  exit_pending_ = false;
  exiting_ = false;
  cubic_through_ = kNoStep;
  owed_us_ = 0;
  depth_ = 0;
  lean_from_ = lean_to_ = lean_ = declared_ = {};
  stiffness_percent_.fill(Stiffness::kFull);
  gain_percent_.fill(Gain::kFull);
  softened_ = released_ = regained_ = 0;
  work_left_ = kMaxWork;
  enter(0, inputs);
}

void Interpreter::stop() {
  state_.stop();
  if (motion_.exit_step() == kNoStep || exiting_) return;
  exit_pending_ = true;
  if (awaiting_) step_time_us_ = step_elapsed_us_;
}

void Interpreter::advance(std::uint32_t elapsed_us, const Inputs& inputs) {
  std::uint32_t left_us = std::min(std::min(elapsed_us, kMaxAdvance_us) + owed_us_, kMaxAdvance_us);
  owed_us_ = 0;
  work_left_ = kMaxWork;
  mixer_.pass(elapsed_us);
  if (released_ != 0) trajectory_.release(released_, inputs.angles);
  if (running_ && awaiting_) {
    const Step step = motion_.step(step_index_);
    work_left_ -= work_of(step);
    if (state_.holds(motion_, step_index_, step, inputs, targets())) {
      awaiting_ = false;
      step_time_us_ = step_elapsed_us_;
      next_index_ = following(step);
    }
  }
  while (running_ && left_us > 0) {
    const std::uint32_t step_left_us = step_time_us_ - step_elapsed_us_;
    const std::uint32_t passing_us = std::min(left_us, step_left_us);
    state_.pass(passing_us);
    step_elapsed_us_ += passing_us;
    left_us -= passing_us;
    if (passing_us < step_left_us) break;
    if (!end_step(inputs)) {
      owed_us_ = left_us;
      break;
    }
  }
  if (released_ != 0) trajectory_.release(released_, inputs.angles);
  if (running_) interpolate();
}

// Ends the present step and enters the next one. Returns whether this call does more work.
bool Interpreter::end_step(const Inputs& inputs) {
  trajectory_.finish();
  lean_from_ = lean_ = lean_to_;
  if (exit_pending_) {
    exit_pending_ = false;
    exiting_ = true;
    depth_ = 0;
    return enter(motion_.exit_step(), inputs);
  }
  if (!awaiting_) return enter(next_index_, inputs);
  const Step await = motion_.step(step_index_);
  if (await.operand != kNoStep) return enter(jump(await.operand, following(await)), inputs);
  fail();
  return false;
}

// Carries out steps that take no time until one that does. Returns false if the motion has ended, or the work
// of this call is done.
bool Interpreter::enter(std::uint16_t index, const Inputs& inputs) {
  awaiting_ = false;
  step_time_us_ = 0;
  step_elapsed_us_ = 0;
  for (;;) {
    step_index_ = index;
    const Step step = motion_.step(index);
    if (!spend(work_of(step))) {
      suspend(index);
      return false;
    }
    if (begin_timed(step, inputs)) return true;
    index = execute(step, inputs);
    if (!running_) return false;
  }
}

int Interpreter::work_of(const Step& step) {
  if (step.opcode == Opcode::kMove) {
    const Move move = Move::of(step);
    const int work = move.interpolation == Interpolation::kCubic ? kCubicWork : kMoveWork;
    return work + (move.by_speed ? kBySpeedWork : 0) + (move.at_least ? kAtLeastWork : 0) +
           kStepWork * move.windows;
  }
  return has_condition(step.opcode) ? kStepWork * (1 + Condition::of(step).count) : kStepWork;
}

// Takes a step's work from what this call may do. Returns false if too little is left.
bool Interpreter::spend(int work) {
  work_left_ -= work;
  return work_left_ >= 0;
}

// Leaves the step to the next call: nothing moves until then.
void Interpreter::suspend(std::uint16_t index) {
  trajectory_.begin_wait();
  next_index_ = index;
}

// Begins the step if it takes time. Returns false if it does not.
bool Interpreter::begin_timed(const Step& step, const Inputs& inputs) {
  switch (step.opcode) {
    case Opcode::kMove:
      begin_move(Move::of(step));
      break;
    case Opcode::kWait:
      trajectory_.begin_wait();
      step_time_us_ = step.value;
      break;
    case Opcode::kAwait:
      if (state_.holds(motion_, step_index_, step, inputs, targets())) return false;
      trajectory_.begin_wait();
      awaiting_ = true;
      step_time_us_ = step.value;
      break;
    default:
      return false;
  }
  next_index_ = step.opcode == Opcode::kMove ? following(step) : static_cast<std::uint16_t>(step_index_ + 1);
  lean_to_ = declared_;
  return true;
}

// Reads the pose of a move. Returns its duration.
std::uint32_t Interpreter::look_ahead(const Move& move) {
  const std::uint32_t travel = trajectory_.look_ahead(motion_.pose_reader(move.pose));
  if (move.at_least) return std::max(move.value, trajectory_.fastest_us(move.interpolation));
  return move.by_speed ? Trajectory::duration_us(move.interpolation, travel, move.value) : move.value;
}

void Interpreter::begin_move(const Move& move) {
  const bool continues = cubic_through_ == step_index_;
  step_time_us_ = continues ? cubic_time_us_ : look_ahead(move);
  cubic_through_ = kNoStep;
  trajectory_.begin_move(move.interpolation, continues);
  for (std::size_t i = 1; i <= move.windows; ++i)
    trajectory_.add_window(Window::of(motion_.step(step_index_ + i)));
  if (move.interpolation != Interpolation::kCubic) return;
  const auto next_index = static_cast<std::uint16_t>(step_index_ + 1);
  const Step next_step = motion_.step(next_index);
  const Move next = Move::of(next_step);
  if (next_step.opcode != Opcode::kMove || next.interpolation != Interpolation::kCubic) return;
  cubic_time_us_ = look_ahead(next);
  trajectory_.plan_through(step_time_us_, cubic_time_us_);
  cubic_through_ = next_index;
}

// Carries out a step that takes no time, or an await whose condition holds. Returns the next one, unless the
// motion ends.
std::uint16_t Interpreter::execute(const Step& step, const Inputs& inputs) {
  const std::uint16_t next = following(step);
  switch (step.opcode) {
    case Opcode::kLoopBegin:
      KOBOSHI_ASSERT(depth_ < stack_.size());
      stack_[depth_++] = {.rounds_left = step.operand};
      return next;
    case Opcode::kLoopEnd:
      return after_loop_end(step);
    case Opcode::kJump: {
      const std::uint16_t target = jump(step.operand, next);
      if (target == motion_.main_step_count()) end();  // ran past the main program, after a stop
      return target;
    }
    case Opcode::kExpect:
      if (!ExpectedAttitude::of(step).is_met_by(inputs.robot.up_B)) fail();
      return next;
    case Opcode::kBranch:
      return state_.holds(motion_, step_index_, step, inputs, targets()) ? jump(step.operand, next) : next;
    case Opcode::kSet:
      if (!state_.assign(Assignment::of(step), inputs, targets())) fail();
      return next;
    case Opcode::kCall:
      KOBOSHI_ASSERT(depth_ < stack_.size());
      stack_[depth_++] = {.resume = next};
      return step.operand;
    case Opcode::kReturn:
      return after_return();
    case Opcode::kMix:
      if (!mixer_.set(Mix::of(step))) fail();
      return next;
    case Opcode::kMixClear:
      mixer_.clear();
      return next;
    case Opcode::kStiffness:
      set_stiffness(Stiffness::of(step));
      return next;
    case Opcode::kGain:
      set_gain(Gain::of(step));
      return next;
    case Opcode::kLean:
      declared_ = LeanDeclaration::of(step).lean();
      return next;
    case Opcode::kFail:
      fail();
      return next;
    case Opcode::kAwait:
    case Opcode::kTest:  // a condition continues after its tests, a move after its windows
    case Opcode::kWindow:
    case Opcode::kMove:  // begin_timed
    case Opcode::kWait:
      return next;
    case Opcode::kEnd:
      end();
      return next;
  }
  return next;
}

// The step after this one and those that belong to it.
std::uint16_t Interpreter::following(const Step& step) const {
  return static_cast<std::uint16_t>(step_index_ + 1u + attached_steps(step));
}

std::uint16_t Interpreter::after_loop_end(const Step& step) {
  KOBOSHI_ASSERT(depth_ > 0);
  std::uint16_t& rounds_left = stack_[depth_ - 1].rounds_left;
  // After a stop, the loops of an exit path still repeat as often as they count.
  const bool ends = rounds_left == 1 || (state_.stopping() && !(exiting_ && rounds_left > 1));
  if (ends) {
    --depth_;
    return following(step);
  }
  if (rounds_left > 1) --rounds_left;
  return static_cast<std::uint16_t>(step.operand + 1);
}

// Leaves the loops of the subroutine, too.
std::uint16_t Interpreter::after_return() {
  std::uint16_t resume = kNoStep;
  while (resume == kNoStep) {
    KOBOSHI_ASSERT(depth_ > 0);
    resume = stack_[--depth_].resume;
  }
  return resume;
}

// After a stop, the program only runs forward.
std::uint16_t Interpreter::jump(std::uint16_t target, std::uint16_t otherwise) const {
  return state_.stopping() && target <= step_index_ ? otherwise : target;
}

void Interpreter::set_stiffness(const Stiffness& stiffness) {
  set_share(stiffness, stiffness_percent_);
  put(softened_, stiffness.joints, stiffness.percent < Stiffness::kFull);
  put(released_, stiffness.joints, stiffness.percent == 0);
}

void Interpreter::set_gain(const Gain& gain) {
  set_share(gain, gain_percent_);
  put(regained_, gain.joints, gain.percent != Gain::kFull);
}

void Interpreter::end() {
  running_ = false;
  mixer_.clear();
}

void Interpreter::fail() {
  failed_ = true;
  end();
}

void Interpreter::add_corrections(std::span<Angle> targets, const estimation::RobotState& robot) {
  KOBOSHI_ASSERT(targets.size() == model_.joint_count);
  mixer_.add_to(targets, model_, robot, lean_);
}

void Interpreter::interpolate() {
  const fixed::Ratio fraction = fixed::elapsed_fraction(static_cast<std::int32_t>(step_elapsed_us_),
                                                        static_cast<std::int32_t>(step_time_us_));
  trajectory_.interpolate(fraction);
  if (lean_from_ == lean_to_) return;
  lean_.roll = fixed::interpolate(lean_from_.roll, lean_to_.roll, fraction);
  lean_.pitch = fixed::interpolate(lean_from_.pitch, lean_to_.pitch, fraction);
}

}  // namespace koboshi::motion
