#include "tools/motion/check/sample.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "firmware/fixed/host/convert.h"
#include "firmware/motion/interpreter.h"
#include "firmware/motion/roles.h"
#include "firmware/storage/image.h"

namespace koboshi::tools {
namespace {

using motion::Opcode;

constexpr std::uint16_t kRounds = 2;  // of an endless loop
constexpr std::uint32_t kTick_us = 10'000;
// A motion that jumps back without end is stopped after this time, and after as much again it is cut.
constexpr std::size_t kMaxTicks = 60'000;
// An expected attitude says that the robot stands again if it is this close to upright.
constexpr double kUpright_rad = 25.0 * std::numbers::pi / 180.0;

std::span<std::byte> step_bytes(std::vector<std::byte>& image, std::size_t steps, std::size_t index) {
  return std::span<std::byte>(image).subspan(image.size() - (steps - index) * motion::kStepSize,
                                             motion::kStepSize);
}

void set_crc(std::vector<std::byte>& image) {
  const std::span<std::byte> field = std::span<std::byte>(image).subspan(storage::kImageCrcOffset, 4);
  storage::FieldWriter(field).u32(storage::image_crc32(image));
}

motion::Motion opened(const std::vector<std::byte>& image, const simulation::NamedModel& robot) {
  motion::Motion result;
  if (!motion::Motion::open(image, robot.model, result).ok())
    throw std::invalid_argument("the motion was not compiled for this robot");
  return result;
}

// The motions of the behaviour's own roles begin during or after a fall.
bool begins_on_feet(const motion::Motion& played) {
  return std::ranges::find(motion::kMotionNames, played.name()) == motion::kMotionNames.end();
}

bool is_upright(const motion::ExpectedAttitude& expected) {
  const double up = expected.up_B[2] / 127.0;
  return up >= std::cos(kUpright_rad) && expected.min_cosine >= 32768.0 * std::cos(kUpright_rad);
}

class Player {
 public:
  Player(const motion::Motion& played, const simulation::NamedModel& robot)
      : motion_(played), robot_(robot), interpreter_(robot.model) {}

  Trajectory play(std::span<const double> from_rad) {
    std::vector<fixed::Angle> from;
    for (const double angle_rad : from_rad) from.push_back(fixed::from_double<fixed::Angle>(angle_rad));
    on_feet_ = begins_on_feet(motion_);
    meet_expectation(0);
    interpreter_.start(motion_, from, inputs_);
    add(interpreter_.step_index());
    for (std::size_t tick = 0; interpreter_.running() && tick < 2 * kMaxTicks; ++tick) {
      if (tick == kMaxTicks) interpreter_.stop();
      const std::uint16_t before = interpreter_.step_index();
      meet_expectation(before);
      interpreter_.advance(kTick_us, inputs_);
      pass_expectations(before, interpreter_.step_index());
      add(before);  // in which the tick began
    }
    for (std::size_t tick = 0; tick < kHoldTicks; ++tick) add(interpreter_.step_index());
    return std::move(trajectory_);
  }

 private:
  // The next expectation after this step is met when it is reached.
  void meet_expectation(std::size_t index) {
    for (; index < motion_.step_count(); ++index) {
      const motion::Step step = motion_.step(index);
      if (step.opcode != Opcode::kExpect) continue;
      const auto expected = motion::ExpectedAttitude::of(step);
      const auto part = [&](std::size_t i) {
        return fixed::from_double<fixed::Ratio>(expected.up_B[i] / 127.0);
      };
      state_.up_B = {part(0), part(1), part(2)};
      return;
    }
  }

  void pass_expectations(std::size_t before, std::size_t after) {
    for (std::size_t index = before + 1; index < after; ++index) {
      const motion::Step step = motion_.step(index);
      if (step.opcode == Opcode::kExpect) on_feet_ = is_upright(motion::ExpectedAttitude::of(step));
    }
  }

  void add(std::uint16_t step) {
    std::vector<double> row;
    for (const fixed::Angle target : interpreter_.targets()) row.push_back(fixed::to_double(target));
    const motion::Lean lean = interpreter_.lean();
    trajectory_.add(row, step, on_feet_, fixed::to_double(lean.pitch), fixed::to_double(lean.roll));
  }

  const motion::Motion& motion_;
  const simulation::NamedModel& robot_;
  estimation::RobotState state_;
  const motion::Inputs inputs_{.robot = state_};
  motion::Interpreter interpreter_;
  bool on_feet_ = true;
  Trajectory trajectory_;
};

}  // namespace

SampledPaths sample_motion(std::span<const std::byte> image, const simulation::NamedModel& robot,
                           std::span<const double> from_rad) {
  std::vector<std::byte> bounded(image.begin(), image.end());
  const motion::Motion original = opened(bounded, robot);
  bounded.resize(original.image_size_bytes());
  SampledPaths sampled;
  for (std::size_t index = 0; index < original.step_count(); ++index) {
    const motion::Step step = original.step(index);
    if (step.opcode == Opcode::kJump && step.operand <= index) sampled.endless = true;
    if (step.opcode != Opcode::kLoopBegin || step.operand != 0) continue;
    sampled.endless = true;
    storage::FieldWriter(step_bytes(bounded, original.step_count(), index).subspan(2, 2)).u16(kRounds);
  }
  set_crc(bounded);
  const motion::Motion played = opened(bounded, robot);
  sampled.paths.push_back(Player(played, robot).play(from_rad));
  return sampled;
}

}  // namespace koboshi::tools
