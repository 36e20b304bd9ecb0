#include "firmware/motion/flow_check.h"

#include <algorithm>

#include "firmware/motion/check.h"
#include "firmware/motion/instructions.h"

namespace koboshi::motion {
MotionVerdict FlowCheck::check() {
  if (const MotionVerdict verdict = find_routines(); !verdict.ok()) return verdict;
  if (const MotionVerdict verdict = check_ends(); !verdict.ok()) return verdict;
  if (const MotionVerdict verdict = check_tests(); !verdict.ok()) return verdict;
  // A subroutine before those that call it, so that the depth of every callee is known.
  for (std::size_t routine = subroutines_ + 1; routine-- > 0;) {
    if (const MotionVerdict verdict = check_nesting(routine); !verdict.ok()) return verdict;
  }
  if (const MotionVerdict verdict = check_targets(); !verdict.ok()) return verdict;
  if (const MotionVerdict verdict = check_exit(); !verdict.ok()) return verdict;
  return check_time();
}

// --- Subroutines

// A subroutine begins where a call points.
MotionVerdict FlowCheck::find_routines() {
  for (std::size_t i = 0; i < motion_.step_count(); ++i) {
    if (motion_.opcode(i) != Opcode::kCall) continue;
    const std::uint16_t target = motion_.step(i).operand;
    if (target <= i || target >= motion_.step_count()) return refuse(MotionStatus::kBadRoutine, i);
    const auto end = entries_.begin() + static_cast<std::ptrdiff_t>(subroutines_);
    const auto place = std::lower_bound(entries_.begin(), end, target);
    if (place != end && *place == target) continue;
    if (subroutines_ == kMaxRoutines) return refuse(MotionStatus::kBadRoutine, i);
    std::copy_backward(place, end, end + 1);
    *place = target;
    ++subroutines_;
  }
  return kAccepted;
}

std::size_t FlowCheck::routine_of(std::size_t step) const {
  const auto end = entries_.begin() + static_cast<std::ptrdiff_t>(subroutines_);
  return static_cast<std::size_t>(std::upper_bound(entries_.begin(), end, step) - entries_.begin());
}

// The last step of each routine must not let the program run on into the next one.
MotionVerdict FlowCheck::check_ends() const {
  const std::size_t main_last = end_of(0) - 1;
  const Opcode main_end = motion_.opcode(main_last);
  if (main_end != Opcode::kEnd && main_end != Opcode::kJump) return refuse(MotionStatus::kNoEnd, main_last);
  for (std::size_t routine = 1; routine <= subroutines_; ++routine) {
    const std::size_t last = end_of(routine) - 1;
    if (motion_.opcode(last) != Opcode::kReturn) return refuse(MotionStatus::kBadRoutine, last);
  }
  for (std::size_t i = 0; i < end_of(0); ++i) {
    if (motion_.opcode(i) == Opcode::kReturn) return refuse(MotionStatus::kBadRoutine, i);
  }
  return kAccepted;
}

// Each condition has its tests, and each test its condition; likewise the windows of moves. One at the end of
// a routine has lost them, because neither is an end.
MotionVerdict FlowCheck::check_tests() const {
  std::size_t expected = 0;
  Opcode attached = Opcode::kTest;  // if any are expected
  for (std::size_t i = 0; i < motion_.step_count(); ++i) {
    const Opcode opcode = motion_.opcode(i);
    if (is_attached(opcode) != (expected > 0)) return refuse(MotionStatus::kBadTest, i);
    if (expected > 0) {
      if (opcode != attached) return refuse(MotionStatus::kBadTest, i);
      --expected;
      continue;
    }
    expected = attached_steps(motion_.step(i));
    attached = has_condition(opcode) ? Opcode::kTest : Opcode::kWindow;
  }
  return kAccepted;
}

// --- Loops, calls and jumps

// Checks the loops of a routine and finds the depth of the stack that it needs.
MotionVerdict FlowCheck::check_nesting(std::size_t routine) {
  std::array<std::uint16_t, kMaxStackDepth> open{};
  std::size_t depth = 0;
  std::size_t deepest = 0;
  for (std::size_t i = begin_of(routine); i < end_of(routine); ++i) {
    const Opcode opcode = motion_.opcode(i);
    if (opcode == Opcode::kLoopBegin) {
      if (depth == kMaxStackDepth) return refuse(MotionStatus::kBadLoop, i);
      open[depth++] = static_cast<std::uint16_t>(i);
      deepest = std::max(deepest, depth);
    } else if (opcode == Opcode::kLoopEnd) {
      if (depth == 0 || open[--depth] != motion_.step(i).operand) return refuse(MotionStatus::kBadLoop, i);
    } else if (opcode == Opcode::kCall) {
      const std::size_t callee = routine_of(motion_.step(i).operand);
      if (callee <= routine) return refuse(MotionStatus::kBadRoutine, i);
      deepest = std::max(deepest, depth + 1 + stack_depth_[callee]);
      if (deepest > kMaxStackDepth) return refuse(MotionStatus::kTooDeep, i);
    }
  }
  stack_depth_[routine] = static_cast<std::uint8_t>(deepest);
  return depth == 0 ? kAccepted : refuse(MotionStatus::kBadLoop, open[depth - 1]);
}

// Whether two steps are in one loop body: every loop that begins between them ends between them, and the
// other way round.
bool FlowCheck::same_body(std::size_t first, std::size_t last) const {
  std::size_t depth = 0;
  for (std::size_t i = first; i < last; ++i) {
    const Opcode opcode = motion_.opcode(i);
    if (opcode == Opcode::kLoopBegin) ++depth;
    if (opcode == Opcode::kLoopEnd) {
      if (depth == 0) return false;
      --depth;
    }
  }
  return depth == 0;
}

MotionVerdict FlowCheck::check_target(std::size_t from, std::size_t target, std::size_t& distance) const {
  const MotionVerdict bad = refuse(MotionStatus::kBadJump, from);
  if (target >= motion_.step_count() || is_attached(motion_.opcode(target))) return bad;
  const std::size_t first = std::min(from, target);
  const std::size_t last = std::max(from, target);
  distance += last - first;
  if (distance > kMaxJumpDistance || routine_of(first) != routine_of(last)) return bad;
  return same_body(first, last) ? kAccepted : bad;
}

MotionVerdict FlowCheck::check_targets() const {
  std::size_t distance = 0;
  for (std::size_t i = 0; i < motion_.step_count(); ++i) {
    const Opcode opcode = motion_.opcode(i);
    if (opcode != Opcode::kJump && !has_condition(opcode)) continue;
    const std::uint16_t target = motion_.step(i).operand;
    if (opcode == Opcode::kAwait && target == kNoStep) continue;
    if (const MotionVerdict verdict = check_target(i, target, distance); !verdict.ok()) return verdict;
  }
  return kAccepted;
}

MotionVerdict FlowCheck::check_exit() const {
  const std::uint16_t exit = motion_.exit_step();
  if (exit == kNoStep) return kAccepted;
  const bool good = exit < main_step_count() && !is_attached(motion_.opcode(exit)) && same_body(0, exit);
  return good ? kAccepted : refuse(MotionStatus::kBadExit, exit < motion_.step_count() ? exit : 0);
}

// --- Time

// Whether each way on from the step, while no time passes, leads to a step of `steps`. `timed`: from where
// time passes before the routine returns.
bool FlowCheck::leads_to(const Steps& steps, const Steps& timed, std::size_t index) const {
  const Step step = motion_.step(index);
  switch (step.opcode) {
    case Opcode::kJump:
      // After a stop, jumps backwards are not taken; the last step of the main program then ends it.
      return steps.contains(step.operand) &&
             (step.operand > index || index + 1 == end_of(0) || steps.contains(index + 1));
    case Opcode::kLoopEnd:
      return steps.contains(step.operand + 1u) && steps.contains(index + 1);
    case Opcode::kBranch:
      return steps.contains(step.operand) && steps.contains(index + 1 + Condition::of(step).count);
    case Opcode::kAwait:
      // Time has passed where the time-out leads.
      return steps.contains(index + 1 + Condition::of(step).count);
    case Opcode::kCall:
      return timed.contains(step.operand) || steps.contains(index + 1);
    default:
      return steps.contains(index + 1);
  }
}

// A step settles if every way from it comes to a step that takes time, or to the end of its routine, in a
// finite number of steps; it is timed if time passes on every way to a return. Both sets grow until nothing
// changes; what stays outside `settled` is on a cycle without time, or leads to one.
MotionVerdict FlowCheck::check_time() const {
  Steps settled;
  Steps timed;
  bool changed = true;
  for (int pass = 0; changed && pass < kMaxPasses; ++pass) {
    changed = false;
    for (std::size_t i = motion_.step_count(); i-- > 0;) {
      const Opcode opcode = motion_.opcode(i);
      const bool passes = takes_time(opcode) || opcode == Opcode::kEnd || opcode == Opcode::kFail;
      const bool skipped = is_attached(opcode);  // no way leads to it
      const bool returns = opcode == Opcode::kReturn;
      if (!settled.contains(i) && (passes || skipped || returns || leads_to(settled, timed, i))) {
        settled.insert(i);
        changed = true;
      }
      if (!timed.contains(i) && !returns && (passes || skipped || leads_to(timed, timed, i))) {
        timed.insert(i);
        changed = true;
      }
    }
  }
  for (std::size_t i = 0; i < motion_.step_count(); ++i) {
    if (!settled.contains(i)) return refuse(MotionStatus::kTakesNoTime, first_of_cycle(settled, i));
  }
  return kAccepted;
}

// Returns a step after this one that does not settle either. Where the passes of check_time() were too few
// there may be none; then returns the step itself.
std::size_t FlowCheck::next_unsettled(const Steps& settled, std::size_t index) const {
  const Step step = motion_.step(index);
  std::size_t next = index + 1;
  switch (step.opcode) {
    case Opcode::kJump:
      if (!settled.contains(step.operand)) next = step.operand;
      break;
    case Opcode::kLoopEnd:
      if (!settled.contains(step.operand + 1u)) next = step.operand + 1u;
      break;
    case Opcode::kBranch:
      next += Condition::of(step).count;
      if (!settled.contains(step.operand)) next = step.operand;
      break;
    case Opcode::kAwait:
      next += Condition::of(step).count;
      break;
    default:
      break;
  }
  return next >= motion_.step_count() || settled.contains(next) ? index : next;
}

// Returns the first step of a cycle without time to which an unsettled step leads; a loop begins with its
// kLoopBegin.
std::size_t FlowCheck::first_of_cycle(const Steps& settled, std::size_t index) const {
  // After as many steps as there are it is on the cycle, and after as many again around it.
  for (std::size_t i = 0; i < motion_.step_count(); ++i) index = next_unsettled(settled, index);
  std::size_t first = index;
  for (std::size_t i = 0; i < motion_.step_count(); ++i) {
    const Step step = motion_.step(index);
    const std::size_t next = next_unsettled(settled, index);
    if (step.opcode == Opcode::kLoopEnd && next <= index) first = std::min<std::size_t>(first, step.operand);
    index = next;
    first = std::min(first, index);
  }
  return first;
}

}  // namespace koboshi::motion
