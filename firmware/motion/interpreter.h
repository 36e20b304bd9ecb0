#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "firmware/motion/motion.h"

namespace koboshi::motion {

// Plays one motion at a time, with linear interpolation between its poses, as the paper's motion editor does.
// Time is an argument. The rest of it after the end of a step goes to the next step: a motion takes the sum
// of its steps' times, however it is divided into calls.
class Interpreter {
 public:
  // `up_B`: unit vector against gravity in axes of B, which `kExpect` steps read when they are reached. It
  // and the model must outlive the interpreter. Before the first motion the targets are zero, clamped to the
  // limits.
  Interpreter(const robot::RobotModel& model, const robot::Direction& up_B);

  // Starts a motion from `pose`, the targets in force, one angle for each joint, so that the targets are
  // continuous; they are clamped to the limits. `motion` was opened for this model; its bytes must remain
  // until it has ended or another one is started.
  void start(const Motion& motion, std::span<const fixed::Angle> pose);
  // Ends the motion in an orderly way: loops end instead of repeating, and jumps backwards are not taken. The
  // rest of the motion takes at most the time of all its steps.
  void stop() { stopping_ = true; }
  // Ends the motion at once; the targets are kept.
  void abort() { running_ = false; }

  // Advances the motion. More than kMaxAdvance_us counts as kMaxAdvance_us: after a gap the motion resumes
  // where it was, it does not jump.
  void advance(std::uint32_t elapsed_us);

  [[nodiscard]] bool running() const { return running_; }
  // Returns whether the motion ended because a kExpect step was not met.
  [[nodiscard]] bool failed() const { return failed_; }
  // Returns the target of each joint, within its limits; after the end, the last ones.
  [[nodiscard]] std::span<const fixed::Angle> targets() const {
    return {targets_.data(), model_.joint_count};
  }
  // Returns the step being played, for monitoring; after the end, that of kEnd.
  [[nodiscard]] std::uint16_t step_index() const { return step_index_; }

  static constexpr std::uint32_t kMaxAdvance_us = 100'000;

 private:
  using Targets = std::array<fixed::Angle, robot::kMaxJoints>;

  void enter(std::uint16_t index);
  void begin_move(const Step& step);
  [[nodiscard]] std::uint16_t next_of_loop_begin(std::uint16_t index, const Step& step);
  [[nodiscard]] std::uint16_t next_of_loop_end(std::uint16_t index, const Step& step);
  [[nodiscard]] std::uint16_t next_of_jump(std::uint16_t index, const Step& step) const;
  void interpolate();

  const robot::RobotModel& model_;
  const robot::Direction& up_B_;
  Motion motion_;
  bool running_ = false;
  bool stopping_ = false;
  bool failed_ = false;
  std::uint16_t step_index_ = 0;
  std::uint32_t step_time_us_ = 0;
  std::uint32_t step_elapsed_us_ = 0;
  std::array<std::uint16_t, kMaxLoopDepth> rounds_left_{};  // of the open loops; 0: until asked to stop
  std::size_t loop_depth_ = 0;
  Targets from_{};
  Targets to_{};
  Targets targets_{};
};

}  // namespace koboshi::motion
