#include "firmware/motion/program_state.h"

#include <algorithm>

#include "firmware/fixed/rounding.h"
#include "firmware/fixed/saturating.h"

namespace koboshi::motion {
namespace {

constexpr std::int64_t kMdegPerTurn = 360'000;

// Returns value * per_unit in whole units, rounded, as the sources have them; saturates.
template <fixed::AnyQuantity Q>
std::int32_t scaled(Q value, std::int64_t per_unit) {
  return fixed::saturate<std::int32_t>(fixed::shift_rounded(value.raw() * per_unit, Q::kFractionBits));
}

fixed::Angle at(std::span<const fixed::Angle> angles, std::size_t joint) {
  return joint < angles.size() ? angles[joint] : fixed::Angle();
}

constexpr bool compare(std::int32_t left, Comparison comparison, std::int32_t right) {
  switch (comparison) {
    case Comparison::kEqual:
      return left == right;
    case Comparison::kNotEqual:
      return left != right;
    case Comparison::kLess:
      return left < right;
    case Comparison::kLessOrEqual:
      return left <= right;
    case Comparison::kGreater:
      return left > right;
    case Comparison::kGreaterOrEqual:
      return left >= right;
  }
  return false;
}

// Returns left (operation) right, unless it divides by zero.
constexpr std::int64_t compute(std::int64_t left, Arithmetic operation, std::int64_t right) {
  switch (operation) {
    case Arithmetic::kAssign:
      return right;
    case Arithmetic::kAdd:
      return left + right;
    case Arithmetic::kSubtract:
      return left - right;
    case Arithmetic::kMultiply:
      return left * right;
    case Arithmetic::kDivide:
      return left / right;
    case Arithmetic::kRemainder:
      return left % right;
    case Arithmetic::kMinimum:
      return std::min(left, right);
    case Arithmetic::kMaximum:
      return std::max(left, right);
  }
  return left;
}

}  // namespace

void ProgramState::pass(std::uint32_t time_us) {
  time_rest_us_ += time_us;
  time_ms_ = fixed::add_saturated(time_ms_, time_rest_us_ / 1'000);
  time_rest_us_ %= 1'000;
}

std::int32_t ProgramState::read(SourceRef ref, const Inputs& inputs,
                                std::span<const fixed::Angle> targets) const {
  const estimation::RobotState& robot = inputs.robot;
  switch (ref.source) {
    case Source::kVariable:
      return variables_[ref.index];
    case Source::kRoll:
      return scaled(robot.roll, kMdegPerTurn);
    case Source::kPitch:
      return scaled(robot.pitch, kMdegPerTurn);
    case Source::kRollRate:
      return scaled(robot.rates_B.x, kMdegPerTurn);
    case Source::kPitchRate:
      return scaled(robot.rates_B.y, kMdegPerTurn);
    case Source::kYawRate:
      return scaled(robot.rates_B.z, kMdegPerTurn);
    case Source::kLeftContact:
      return robot.feet[0].contact ? 1 : 0;
    case Source::kRightContact:
      return robot.feet[1].contact ? 1 : 0;
    case Source::kLeftLoad:
      return scaled(robot.feet[0].load, 1'000);
    case Source::kRightLoad:
      return scaled(robot.feet[1].load, 1'000);
    case Source::kZmpX:
      return robot.zmp.valid ? scaled(robot.zmp.x, 1'000'000) : 0;
    case Source::kZmpY:
      return robot.zmp.valid ? scaled(robot.zmp.y, 1'000'000) : 0;
    case Source::kZmpValid:
      return robot.zmp.valid ? 1 : 0;
    case Source::kJointAngle:
      return scaled(at(inputs.angles, ref.index), kMdegPerTurn);
    case Source::kJointError:
      return scaled(at(targets, ref.index) - at(inputs.angles, ref.index), kMdegPerTurn);
    case Source::kJointTorque:
      return ref.index < inputs.torques_permille.size() ? inputs.torques_permille[ref.index] : 0;
    case Source::kSupply:
      return fixed::saturate<std::int32_t>(inputs.supply_mV);
    case Source::kInput:
      return ref.index < inputs.values.size() ? inputs.values[ref.index] : 0;
    case Source::kStopping:
      return stopping_ ? 1 : 0;
    case Source::kWalking:
      return inputs.walking ? 1 : 0;
    case Source::kTime:
      return fixed::saturate<std::int32_t>(time_ms_);
  }
  return 0;
}

bool ProgramState::holds(const Motion& motion, std::size_t index, const Step& step, const Inputs& inputs,
                         std::span<const fixed::Angle> targets) const {
  const Condition condition = Condition::of(step);
  for (std::size_t i = 1; i <= condition.count; ++i) {
    const Test test = Test::of(motion.step(index + i));
    const std::int32_t right =
        test.with_variable ? variables_[static_cast<std::size_t>(test.right)] : test.right;
    // The first one that holds decides `any` of them, the first that does not, `all` of them.
    if (compare(read(test.left, inputs, targets), test.comparison, right) == condition.any)
      return condition.any != condition.negated;
  }
  return condition.any == condition.negated;
}

bool ProgramState::assign(const Assignment& assignment, const Inputs& inputs,
                          std::span<const fixed::Angle> targets) {
  const std::int32_t right =
      assignment.from_source
          ? read(SourceRef::of(static_cast<std::uint32_t>(assignment.right)), inputs, targets)
          : assignment.right;
  const bool divides =
      assignment.operation == Arithmetic::kDivide || assignment.operation == Arithmetic::kRemainder;
  if (divides && right == 0) return false;
  std::int32_t& variable = variables_[assignment.variable];
  variable = fixed::saturate<std::int32_t>(compute(variable, assignment.operation, right));
  return true;
}

}  // namespace koboshi::motion
