#include "tools/motion_check/forced_motion.h"

#include <algorithm>
#include <stdexcept>

#include "firmware/motion/instructions.h"
#include "firmware/storage/image.h"

namespace koboshi::tools {
namespace {

using motion::Condition;
using motion::Opcode;
using motion::Source;
using motion::Test;

motion::Motion opened(std::span<const std::byte> image, const simulation::NamedModel& robot) {
  motion::Motion result;
  if (!motion::Motion::open(image, robot.model, result).ok())
    throw std::invalid_argument("the motion was not compiled for this robot");
  return result;
}

}  // namespace

ForcedMotion::ForcedMotion(std::span<const std::byte> image, const simulation::NamedModel& robot)
    : original_bytes_(image.begin(), image.end()), original_(opened(original_bytes_, robot)) {
  bytes_ = original_bytes_;
  forced_ = opened(bytes_, robot);
  find_tainted_variables();
  armed_.resize(original_.step_count());
  for (std::size_t index = 0; index < original_.step_count(); ++index) {
    motion::Step step = original_.step(index);
    endless_ = endless_ || (step.opcode == Opcode::kJump && step.operand <= index);
    if (step.opcode == Opcode::kLoopBegin && step.operand == 0) {
      endless_ = true;
      step.operand = kRounds;
      write(index, step);
    }
    const bool decided = motion::has_condition(step.opcode) && reads_sensors(index);
    if (decided || step.opcode == Opcode::kExpect) breakpoints_.push_back(static_cast<std::uint16_t>(index));
  }
  arm(motion::kNoStep);
}

std::span<std::byte> ForcedMotion::bytes_of(std::size_t step, std::size_t count) {
  const std::size_t from_end = (original_.step_count() - step) * motion::kStepSize;
  return std::span(bytes_).subspan(original_.image_size_bytes() - from_end, count * motion::kStepSize);
}

void ForcedMotion::write(std::size_t step, const motion::Step& value) {
  storage::FieldWriter writer(bytes_of(step));
  writer.u8(static_cast<std::uint8_t>(value.opcode));
  writer.u8(value.mode);
  writer.u16(value.operand);
  writer.u32(value.value);
}

bool ForcedMotion::is_tainted(std::uint16_t source) const {
  const auto ref = motion::SourceRef::of(source);
  if (ref.source == Source::kVariable) return (tainted_ >> ref.index & 1U) != 0;
  return ref.source != Source::kTime && ref.source != Source::kStopping;
}

// Finds them without regard to the order of the steps.
void ForcedMotion::find_tainted_variables() {
  for (std::uint32_t before = ~0U; before != tainted_;) {
    before = tainted_;
    for (std::size_t index = 0; index < original_.step_count(); ++index) {
      const motion::Step step = original_.step(index);
      if (step.opcode != Opcode::kSet) continue;
      const auto assignment = motion::Assignment::of(step);
      if (assignment.from_source && is_tainted(static_cast<std::uint16_t>(assignment.right)))
        tainted_ |= 1U << assignment.variable;
    }
  }
}

bool ForcedMotion::reads_sensors(std::size_t condition) const {
  const unsigned tests = Condition::of(original_.step(condition)).count;
  for (std::size_t i = 1; i <= tests; ++i) {
    const Test test = Test::of(original_.step(condition + i));
    if (is_tainted(test.left.packed())) return true;
    if (test.with_variable && (tainted_ >> static_cast<unsigned>(test.right) & 1U) != 0) return true;
  }
  return false;
}

void ForcedMotion::arm(std::uint16_t except) {
  for (const std::uint16_t step : breakpoints_) {
    if (step == except || armed_[step]) continue;
    write(step, {Opcode::kFail});
    armed_[step] = true;
  }
}

void ForcedMotion::decide(std::uint16_t step, bool holds) {
  const motion::Step original = original_.step(step);
  const auto condition = Condition::of(original);
  const bool tests_hold = holds != condition.negated;
  // The time since the start is never negative.
  const Test test{.left = {.source = Source::kTime},
                  .comparison = tests_hold ? motion::Comparison::kGreaterOrEqual : motion::Comparison::kLess};
  for (std::size_t i = 1; i <= condition.count; ++i) write(step + i, test.step());
  write(step, original);
  armed_[step] = false;
}

void ForcedMotion::satisfy(std::uint16_t step) {
  write(step, motion::Stiffness{.joints = 0}.step());  // does nothing
  armed_[step] = false;
}

}  // namespace koboshi::tools
