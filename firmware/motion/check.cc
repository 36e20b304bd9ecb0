#include "firmware/motion/check.h"

#include <algorithm>
#include <array>

namespace koboshi::motion {
namespace {

using robot::RobotModel;

MotionStatus check_pose(const Motion& motion, const RobotModel& model, std::size_t pose) {
  const std::uint32_t mask = motion.joint_mask(pose);
  if ((mask >> motion.joint_count()) != 0) return MotionStatus::kBadPose;
  for (std::size_t i = 0; i < motion.joint_count(); ++i) {
    const fixed::Angle angle = motion.angle(pose, i);
    if ((mask >> i & 1u) == 0) {
      if (angle != fixed::Angle()) return MotionStatus::kBadPose;
    } else if (angle < model.joints[i].lower || angle > model.joints[i].upper) {
      return MotionStatus::kBeyondLimits;
    }
  }
  return MotionStatus::kOk;
}

bool uses_operand(Opcode opcode) { return opcode != Opcode::kEnd && opcode != Opcode::kWait; }

MotionStatus check_attitude(const Step& step) {
  constexpr int kMinSquare = 100 * 100;
  constexpr int kMaxSquare = 154 * 154;
  int square = 0;
  for (const int part : ExpectedAttitude::of(step).up_B) square += part * part;
  const bool is_direction = square >= kMinSquare && square <= kMaxSquare && step.time_us >> 24 == 0;
  return is_direction ? MotionStatus::kOk : MotionStatus::kBadAttitude;
}

MotionStatus check_fields(const Motion& motion, const Step& step) {
  if (step.opcode > Opcode::kExpect) return MotionStatus::kBadOpcode;
  if (!uses_operand(step.opcode) && step.operand != 0) return MotionStatus::kBadOpcode;
  if (step.opcode == Opcode::kExpect) return check_attitude(step);
  if (!takes_time(step.opcode)) return step.time_us == 0 ? MotionStatus::kOk : MotionStatus::kBadOpcode;
  if (step.time_us < kMinStepTime_us || step.time_us > kMaxStepTime_us) return MotionStatus::kBadStepTime;
  if (step.opcode == Opcode::kMove && step.operand >= motion.pose_count()) return MotionStatus::kNoSuchPose;
  return MotionStatus::kOk;
}

constexpr MotionVerdict kGood{};

constexpr MotionVerdict refuse(MotionStatus status, std::size_t index) {
  return {status, static_cast<std::uint16_t>(index)};
}

MotionVerdict check_loops(const Motion& motion) {
  std::array<std::size_t, kMaxLoopDepth> open{};
  std::size_t depth = 0;
  for (std::size_t i = 0; i < motion.step_count(); ++i) {
    const Step step = motion.step(i);
    if (step.opcode == Opcode::kLoopBegin) {
      if (depth == kMaxLoopDepth) return refuse(MotionStatus::kBadLoop, i);
      open[depth++] = i;
    } else if (step.opcode == Opcode::kLoopEnd) {
      if (depth == 0 || open[--depth] != step.operand) return refuse(MotionStatus::kBadLoop, i);
    }
  }
  return depth == 0 ? kGood : refuse(MotionStatus::kBadLoop, open[depth - 1]);
}

// Whether two steps are in one loop body: every loop that begins between them ends between them, and the
// other way round.
bool same_body(const Motion& motion, std::size_t first, std::size_t last) {
  std::size_t depth = 0;
  for (std::size_t i = first; i < last; ++i) {
    const Opcode opcode = motion.step(i).opcode;
    if (opcode == Opcode::kLoopBegin) ++depth;
    if (opcode == Opcode::kLoopEnd) {
      if (depth == 0) return false;
      --depth;
    }
  }
  return depth == 0;
}

MotionVerdict check_jumps(const Motion& motion) {
  std::size_t jumps = 0;
  for (std::size_t i = 0; i < motion.step_count(); ++i) {
    const Step step = motion.step(i);
    if (step.opcode != Opcode::kJump) continue;
    const std::size_t target = step.operand;
    if (++jumps > kMaxJumps || target >= motion.step_count() ||
        !same_body(motion, std::min(i, target), std::max(i, target))) {
      return refuse(MotionStatus::kBadJump, i);
    }
  }
  return kGood;
}

// Walks from a step until one that takes time or ends the motion, leaving loops at their end. At most
// kMaxZeroTimeSteps. With `within_body`, a loop's end is no way out: what comes there without time could go
// round for ever.
bool time_passes_from(const Motion& motion, std::size_t index, bool within_body) {
  for (std::size_t count = 0; count <= kMaxZeroTimeSteps; ++count) {
    const Step step = motion.step(index);
    if (takes_time(step.opcode) || step.opcode == Opcode::kEnd) return true;
    if (within_body && step.opcode == Opcode::kLoopEnd) return false;
    index = step.opcode == Opcode::kJump ? step.operand : index + 1;
  }
  return false;
}

// A cycle without time would have to go back through the end of a loop or by jumps alone. The walk from the
// loop's first step rules out the one, the bounded walk from every step the other.
MotionVerdict check_time(const Motion& motion) {
  for (std::size_t i = 0; i < motion.step_count(); ++i) {
    const bool is_loop = motion.step(i).opcode == Opcode::kLoopBegin;
    if (!time_passes_from(motion, i, false) || (is_loop && !time_passes_from(motion, i + 1, true))) {
      return refuse(MotionStatus::kTakesNoTime, i);
    }
  }
  return kGood;
}

}  // namespace

MotionVerdict check_motion(const Motion& motion, const RobotModel& model) {
  for (std::size_t i = 0; i < motion.pose_count(); ++i) {
    const MotionStatus status = check_pose(motion, model, i);
    if (status != MotionStatus::kOk) return refuse(status, i);
  }
  for (std::size_t i = 0; i < motion.step_count(); ++i) {
    const MotionStatus status = check_fields(motion, motion.step(i));
    if (status != MotionStatus::kOk) return refuse(status, i);
  }
  const std::size_t last = motion.step_count() - 1;
  if (motion.step(last).opcode != Opcode::kEnd) return refuse(MotionStatus::kNoEnd, last);
  if (const MotionVerdict verdict = check_loops(motion); !verdict.ok()) return verdict;
  if (const MotionVerdict verdict = check_jumps(motion); !verdict.ok()) return verdict;
  return check_time(motion);
}

}  // namespace koboshi::motion
