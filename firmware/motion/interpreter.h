#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "firmware/motion/motion.h"

namespace koboshi::motion {

// Plays one motion at a time: poses with linear interpolation between them, as the paper's motion editor
// does. Time comes as an argument; what a step leaves of it goes to the next, so that a motion lasts what its
// steps add up to, whatever the ticks.
class Interpreter {
 public:
  // `up_B`: the direction against gravity in the trunk's axes, looked at where a motion expects an attitude.
  // It and the robot outlive the interpreter. Until a motion is started, the targets are zero clamped to the
  // limits.
  Interpreter(const robot::RobotModel& model, const robot::Direction& up_B);

  // Begins at `pose`, one angle a joint of the robot, clamped to the limits: the targets in force, so that
  // nothing jumps. `motion` was opened for this robot, and its bytes stay until it has ended or another is
  // started.
  void start(const Motion& motion, std::span<const fixed::Angle> pose);
  // Asks the motion to come to its end: from now on loops are left where they would begin again, and jumps
  // backwards are not taken. What is still to come takes at most the time of all steps once.
  void stop() { stopping_ = true; }
  // Ends the motion at once; the targets stay.
  void abort() { running_ = false; }

  // Lets time pass. More than kMaxAdvance_us counts as that: after a gap the motion goes on, it does not
  // leap.
  void advance(std::uint32_t elapsed_us);

  [[nodiscard]] bool running() const { return running_; }
  // The motion has ended because the robot did not lie or stand as it expected.
  [[nodiscard]] bool failed() const { return failed_; }
  // One target a joint, within its limits; after the end, the last.
  [[nodiscard]] std::span<const fixed::Angle> targets() const {
    return {targets_.data(), model_.joint_count};
  }
  // The step that is being played, for monitoring; of an ended motion, its kEnd.
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
