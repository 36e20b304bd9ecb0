#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "firmware/motion/inputs.h"
#include "firmware/motion/mixer.h"
#include "firmware/motion/motion.h"
#include "firmware/motion/program_state.h"
#include "firmware/motion/trajectory.h"

namespace koboshi::motion {

// Plays one motion at a time. Time is an argument. The rest of it after the end of a step goes to the next
// step: a motion takes the sum of its steps' times, however it is divided into calls. The work of a call is
// bounded: what exceeds kMaxWork is left to the next call, together with its time.
class Interpreter {  // Large: the whole state of a program that runs
 public:
  // The work of one call, about 70 instructions of the Cortex-M4 each. kMaxWork was found by measuring
  // (docs/experiment/motion-language.md): two motions on 20 joints with 16 corrections each stay below 8,000
  // instructions in 99 of 100 ticks, whatever their steps are.
  static constexpr int kMaxWork = 14;
  static constexpr int kStepWork = 1;     // a step without time, and each test of a condition
  static constexpr int kMoveWork = 6;     // reads its pose
  static constexpr int kCubicWork = 12;   // also reads the next pose, and plans its way through the first
  static constexpr int kBySpeedWork = 1;  // divides for the duration
  static constexpr int kAtLeastWork = 4;  // also looks for the slowest joint; no cubic
  static_assert(kMaxWork >= kCubicWork + kBySpeedWork && kMaxWork >= kMoveWork + kAtLeastWork &&
                    kMaxWork >= kStepWork * (1 + static_cast<int>(kMaxTests)),
                "each step fits one call");
  static constexpr std::uint32_t kMaxAdvance_us = 100'000;

  // The model must outlive the interpreter. Before the first motion the targets are zero, clamped to the
  // limits.
  explicit Interpreter(const robot::RobotModel& model) : trajectory_(model), model_(model) {}

  // Starts a motion from `pose`, the targets in force, one angle for each joint, so that the targets are
  // continuous; they are clamped to the limits. `motion` was opened for this model; its bytes must remain
  // until it has ended or another one is started.
  void start(const Motion& motion, std::span<const fixed::Angle> pose, const Inputs& inputs);
  // Ends the motion in an orderly way. With an exit path, the program goes on there at the end of the present
  // step; an await ends at once. Without one, loops end instead of repeating, and jumps backwards are not
  // taken.
  void stop();
  // Ends the motion at once, and the fading of corrections; the targets are kept.
  void abort() {
    running_ = false;
    mixer_.reset();
  }

  // Advances the motion. More than kMaxAdvance_us counts as kMaxAdvance_us: after a gap the motion resumes
  // where it was, it does not jump. A joint without torque (kStiffness 0) has its measured angle as target,
  // so that its next move begins there. After the end only the fading of corrections goes on.
  void advance(std::uint32_t elapsed_us, const Inputs& inputs);

  [[nodiscard]] bool running() const { return running_; }
  // Returns whether the motion ended at a kFail step, an attitude or time-out that was not met, a division by
  // zero or more than kMaxMixes corrections.
  [[nodiscard]] bool failed() const { return failed_; }
  // Returns the target of each joint, within its limits and without the corrections of kMix; after the end,
  // the last ones.
  [[nodiscard]] std::span<const fixed::Angle> targets() const { return trajectory_.targets(); }
  // Adds the corrections of kMix to these targets, one for each joint, within their limits. After the end
  // the last ones fade (Mixer::kFade_us).
  void add_corrections(std::span<fixed::Angle> targets, const estimation::RobotState& robot);
  // Returns the corrections in force, without those that fade.
  [[nodiscard]] std::span<const Mix> mixes() const { return mixer_.mixes(); }
  // Returns whether the motion has ended and its corrections still fade.
  [[nodiscard]] bool fading() const { return !running_ && mixer_.fading(); }
  // Returns the declared lean; after the end, none.
  [[nodiscard]] Lean lean() const { return running_ ? lean_ : Lean(); }
  // Returns the share of the drives' full torque, by joint, in percent; after the end, all of it.
  [[nodiscard]] std::uint8_t stiffness_percent(std::size_t joint) const {
    return running_ ? stiffness_percent_[joint] : Stiffness::kFull;
  }
  // Returns the joints with less than full torque; after the end, none. Bit i: joint i.
  [[nodiscard]] std::uint32_t softened() const { return running_ ? softened_ : 0; }
  // Likewise the gain of the drives' position loops, in percent of their own, and the joints with another
  // one.
  [[nodiscard]] std::uint8_t gain_percent(std::size_t joint) const {
    return running_ ? gain_percent_[joint] : Gain::kFull;
  }
  [[nodiscard]] std::uint32_t regained() const { return running_ ? regained_ : 0; }
  // Returns the joints of the motion, also after its end (Motion::claimed_joints).
  [[nodiscard]] std::uint32_t claimed_joints() const { return motion_.claimed_joints(); }
  // Returns the step being played, for monitoring; after the end, the one at which the motion ended.
  [[nodiscard]] std::uint16_t step_index() const { return step_index_; }
  // Returns the variables of the program, for monitoring.
  [[nodiscard]] std::span<const std::int32_t, kMaxVariables> variables() const { return state_.variables(); }

 private:
  // An open loop or call.
  struct Frame {
    std::uint16_t resume = kNoStep;  // call: the step after it; kNoStep: a loop
    std::uint16_t rounds_left = 0;   // loop; 0: until stopped
  };

  bool end_step(const Inputs& inputs);
  bool enter(std::uint16_t index, const Inputs& inputs);
  [[nodiscard]] static int work_of(const Step& step);
  [[nodiscard]] bool spend(int work);
  void suspend(std::uint16_t index);
  bool begin_timed(const Step& step, const Inputs& inputs);
  void begin_move(const Move& move);
  [[nodiscard]] std::uint32_t look_ahead(const Move& move);
  [[nodiscard]] std::uint16_t execute(const Step& step, const Inputs& inputs);
  [[nodiscard]] std::uint16_t after_loop_end(const Step& step);
  [[nodiscard]] std::uint16_t after_return();
  [[nodiscard]] std::uint16_t jump(std::uint16_t target, std::uint16_t otherwise) const;
  [[nodiscard]] std::uint16_t following(const Step& step) const;
  void set_stiffness(const Stiffness& stiffness);
  void set_gain(const Gain& gain);
  void end();
  void fail();
  void interpolate();

  ProgramState state_;
  Trajectory trajectory_;
  Mixer mixer_;
  const robot::RobotModel& model_;
  Motion motion_;
  bool running_ = false;
  bool failed_ = false;
  bool awaiting_ = false;      // the present step is a kAwait whose condition does not hold
  bool exit_pending_ = false;  // the exit path follows the present step
  bool exiting_ = false;       // the program is on its exit path
  std::uint16_t step_index_ = 0;
  std::uint16_t next_index_ = 0;           // after the present step, unless it is a kAwait
  std::uint16_t cubic_through_ = kNoStep;  // the cubic move that continues the present one; its pose is read
  std::uint32_t cubic_time_us_ = 0;        // its duration
  std::uint32_t step_time_us_ = 0;
  std::uint32_t step_elapsed_us_ = 0;
  std::uint32_t owed_us_ = 0;  // time that was left when the work of a call was done
  int work_left_ = 0;          // of kMaxWork
  std::array<Frame, kMaxStackDepth> stack_{};
  std::size_t depth_ = 0;
  Lean lean_from_;
  Lean lean_to_;
  Lean lean_;
  Lean declared_;  // by the last kLean; the next step that takes time goes there
  std::array<std::uint8_t, robot::kMaxJoints> stiffness_percent_{};
  std::uint32_t softened_ = 0;  // joints with less than full torque; bit i: joint i
  std::uint32_t released_ = 0;  // those without torque
  std::array<std::uint8_t, robot::kMaxJoints> gain_percent_{};
  std::uint32_t regained_ = 0;  // joints with another gain than their own
};

}  // namespace koboshi::motion
