#include "firmware/motion/check.h"

#include "firmware/motion/flow_check.h"
#include "firmware/motion/instructions.h"

namespace koboshi::motion {
namespace {

using robot::RobotModel;

MotionStatus check_pose(const Motion& motion, const RobotModel& model, std::size_t pose) {
  constexpr std::int64_t kTolerance = std::int64_t{1} << kPoseShift;  // of rounding
  PoseReader reader = motion.pose_reader(pose);
  while (reader.joints() != 0) {
    std::size_t joint = 0;
    const std::int64_t angle_raw = reader.read(joint).raw();
    if (angle_raw < model.joints[joint].lower.raw() - kTolerance ||
        angle_raw > model.joints[joint].upper.raw() + kTolerance) {
      return MotionStatus::kBeyondLimits;
    }
  }
  return reader.rest() == 0 ? MotionStatus::kOk : MotionStatus::kBadPose;
}

constexpr MotionStatus ok_if(bool condition, MotionStatus otherwise = MotionStatus::kBadOpcode) {
  return condition ? MotionStatus::kOk : otherwise;
}

constexpr bool only(std::uint8_t mode, std::uint8_t mask) { return (mode & ~mask) == 0; }

bool is_time(std::uint32_t time_us) { return time_us >= kMinStepTime_us && time_us <= kMaxStepTime_us; }

MotionStatus check_attitude(const Step& step) {
  constexpr int kMinSquare = 100 * 100;
  constexpr int kMaxSquare = 154 * 154;
  int square = 0;
  for (const int part : ExpectedAttitude::of(step).up_B) square += part * part;
  const bool is_direction = square >= kMinSquare && square <= kMaxSquare && step.value >> 24 == 0;
  return ok_if(is_direction && step.mode == 0, MotionStatus::kBadAttitude);
}

MotionStatus check_move(const Motion& motion, const Step& step) {
  const Move move = Move::of(step);
  const bool is_new = move.at_least || move.interpolation > Interpolation::kCubic;
  if (!only(step.mode, Move::kModeMask) || (is_new && motion.version() < kAtLeastVersion))
    return MotionStatus::kBadOpcode;
  const bool is_cubic = move.interpolation == Interpolation::kCubic;
  if (move.at_least && (move.by_speed || is_cubic)) return MotionStatus::kBadOpcode;
  if (move.windows > 0) {
    const bool has_time = !move.at_least && !move.by_speed && !is_cubic;
    if (motion.version() < kGainVersion || !has_time) return MotionStatus::kBadOpcode;
    if (move.windows > Move::kMaxWindows) return MotionStatus::kBadTest;
  }
  if (!(move.by_speed ? move.value > 0 : is_time(move.value))) return MotionStatus::kBadStepTime;
  return ok_if(move.pose < motion.pose_count(), MotionStatus::kNoSuchPose);
}

bool is_source(const Motion& motion, SourceRef ref) {
  switch (ref.source) {
    case Source::kVariable:
      return ref.index < motion.variable_count();
    case Source::kJointAngle:
    case Source::kJointError:
    case Source::kJointTorque:
      return ref.index < motion.joint_count();
    case Source::kInput:
      return ref.index < kInputCount;
    default:
      return ref.source <= kLastSource && ref.index == 0;
  }
}

MotionStatus check_test(const Motion& motion, const Step& step) {
  const Test test = Test::of(step);
  if (!only(step.mode, Test::kModeMask) || test.comparison > kLastComparison) return MotionStatus::kBadOpcode;
  const bool right_known = !test.with_variable || step.value < motion.variable_count();
  return ok_if(right_known && is_source(motion, test.left), MotionStatus::kBadSource);
}

MotionStatus check_condition(const Step& step) {
  if (!only(step.mode, Condition::kModeMask)) return MotionStatus::kBadOpcode;
  const std::size_t count = Condition::of(step).count;
  if (count == 0 || count > kMaxTests) return MotionStatus::kBadTest;
  if (step.opcode == Opcode::kAwait) return ok_if(is_time(step.value), MotionStatus::kBadStepTime);
  return ok_if(step.value == 0);
}

MotionStatus check_assignment(const Motion& motion, const Step& step) {
  const Assignment assignment = Assignment::of(step);
  if (!only(step.mode, Assignment::kModeMask)) return MotionStatus::kBadOpcode;
  if (assignment.variable >= motion.variable_count()) return MotionStatus::kBadSource;
  const bool known = step.value >> 16 == 0 && is_source(motion, SourceRef::of(step.value));
  return ok_if(!assignment.from_source || known, MotionStatus::kBadSource);
}

MotionStatus check_mix(const Motion& motion, const Step& step) {
  const Mix mix = Mix::of(step);
  if (mix.source > kLastMixSource) return MotionStatus::kBadOpcode;
  const bool limited = mix.limit >= Mix::kMinLimit && mix.limit <= Mix::kMaxLimit;
  const bool removes = mix.gain == 0 && mix.limit == 0;
  return ok_if(step.operand < motion.joint_count() && (limited || removes), MotionStatus::kBadJoint);
}

MotionStatus check_window(const Motion& motion, const Step& step) {
  const Window window = Window::of(step);
  if (motion.version() < kGainVersion) return MotionStatus::kBadOpcode;
  if (window.start >= window.end) return MotionStatus::kBadStepTime;
  return ok_if(window.joints != 0 && window.joints >> motion.joint_count() == 0, MotionStatus::kBadJoint);
}

template <typename Share>
MotionStatus check_share(const Motion& motion, const Step& step) {
  const Share share = Share::of(step);
  const bool joints_exist = share.joints != 0 && share.joints >> motion.joint_count() == 0;
  if (step.operand != 0) return MotionStatus::kBadOpcode;
  return ok_if(joints_exist && share.percent >= Share::kMin && share.percent <= Share::kMax,
               MotionStatus::kBadJoint);
}

MotionStatus check_fields(const Motion& motion, const Step& step) {
  switch (step.opcode) {
    case Opcode::kEnd:
    case Opcode::kReturn:
    case Opcode::kFail:
    case Opcode::kMixClear:
      return ok_if(step.mode == 0 && step.operand == 0 && step.value == 0);
    case Opcode::kMove:
      return check_move(motion, step);
    case Opcode::kWait:
      if (step.mode != 0 || step.operand != 0) return MotionStatus::kBadOpcode;
      return ok_if(is_time(step.value), MotionStatus::kBadStepTime);
    case Opcode::kLoopBegin:
    case Opcode::kLoopEnd:
    case Opcode::kJump:
    case Opcode::kCall:
      return ok_if(step.mode == 0 && step.value == 0);
    case Opcode::kExpect:
      return check_attitude(step);
    case Opcode::kTest:
      return check_test(motion, step);
    case Opcode::kBranch:
    case Opcode::kAwait:
      return check_condition(step);
    case Opcode::kSet:
      return check_assignment(motion, step);
    case Opcode::kMix:
      return check_mix(motion, step);
    case Opcode::kStiffness:
      return check_share<Stiffness>(motion, step);
    case Opcode::kGain:
      if (motion.version() < kGainVersion) return MotionStatus::kBadOpcode;
      return check_share<Gain>(motion, step);
    case Opcode::kWindow:
      return check_window(motion, step);
    case Opcode::kLean:
      return ok_if(step.mode == 0 && step.value >> 16 == 0);
  }
  return MotionStatus::kBadOpcode;
}

}  // namespace

MotionVerdict check_groups(const Motion& motion) {
  std::size_t poses = 0;
  for (std::size_t i = 0; i < motion.group_count(); ++i) {
    const PoseGroup group = motion.group(i);
    poses += group.count;
    bool good = group.joints != 0 && group.joints >> motion.joint_count() == 0 && group.count != 0;
    for (std::size_t earlier = 0; earlier < i; ++earlier)
      good = good && motion.group(earlier).joints != group.joints;
    if (!good) return refuse(MotionStatus::kBadGroup, i);
  }
  return poses == motion.pose_count() ? kAccepted : refuse(MotionStatus::kBadCount, 0);
}

MotionVerdict check_motion(const Motion& motion, const RobotModel& model, std::uint16_t& main_step_count) {
  for (std::size_t i = 0; i < motion.pose_count(); ++i) {
    const MotionStatus status = check_pose(motion, model, i);
    if (status != MotionStatus::kOk) return refuse(status, i);
  }
  for (std::size_t i = 0; i < motion.step_count(); ++i) {
    const MotionStatus status = check_fields(motion, motion.step(i));
    if (status != MotionStatus::kOk) return refuse(status, i);
  }
  FlowCheck flow(motion);
  const MotionVerdict verdict = flow.check();
  if (verdict.ok()) main_step_count = static_cast<std::uint16_t>(flow.main_step_count());
  return verdict;
}

}  // namespace koboshi::motion
