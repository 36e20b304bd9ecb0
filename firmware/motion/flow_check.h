#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "firmware/motion/motion.h"

namespace koboshi::motion {

// Validates the control flow of a motion whose steps have valid fields: loops and calls are nested and at
// most kMaxStackDepth deep together, no subroutine calls itself, jumps stay in their loop body, the program
// cannot run past its end, and time passes in every cycle. Uses 0.4 KB of stack.
class FlowCheck {
 public:
  explicit FlowCheck(const Motion& motion) : motion_(motion) {}

  // Returns the first violation found.
  MotionVerdict check();
  // Returns the number of steps before the first subroutine, after a successful check.
  [[nodiscard]] std::size_t main_step_count() const { return end_of(0); }

 private:
  // Limit for the distances of all jumps in sum, which bounds the time of the check: 64 long ones, or as many
  // short ones as there are steps.
  static constexpr std::size_t kMaxJumpDistance = 64 * kMaxSteps;
  // Limit for the passes over all steps in check_time; each follows one more jump backwards of a chain
  // without time.
  static constexpr int kMaxPasses = 16;

  // A set of steps.
  class Steps {
   public:
    [[nodiscard]] bool contains(std::size_t step) const { return (words_[step / 32] >> step % 32 & 1u) != 0; }
    void insert(std::size_t step) { words_[step / 32] |= 1u << step % 32; }

   private:
    std::array<std::uint32_t, kMaxSteps / 32> words_{};
  };

  MotionVerdict find_routines();
  MotionVerdict check_ends() const;
  MotionVerdict check_tests() const;
  MotionVerdict check_targets() const;
  MotionVerdict check_target(std::size_t from, std::size_t target, std::size_t& distance) const;
  MotionVerdict check_nesting(std::size_t routine);
  MotionVerdict check_exit() const;
  MotionVerdict check_time() const;
  [[nodiscard]] std::size_t next_unsettled(const Steps& settled, std::size_t index) const;
  [[nodiscard]] std::size_t first_of_cycle(const Steps& settled, std::size_t index) const;
  [[nodiscard]] bool leads_to(const Steps& steps, const Steps& timed, std::size_t index) const;

  // Routine 0 is the main program; the subroutines follow in the order of their steps.
  [[nodiscard]] std::size_t begin_of(std::size_t routine) const {
    return routine == 0 ? 0 : entries_[routine - 1];
  }
  [[nodiscard]] std::size_t end_of(std::size_t routine) const {
    return routine == subroutines_ ? motion_.step_count() : entries_[routine];
  }
  [[nodiscard]] std::size_t routine_of(std::size_t step) const;
  [[nodiscard]] bool same_body(std::size_t first, std::size_t last) const;

  const Motion& motion_;
  std::size_t subroutines_ = 0;
  std::array<std::uint16_t, kMaxRoutines> entries_{};         // ascending
  std::array<std::uint8_t, kMaxRoutines + 1> stack_depth_{};  // that each routine needs
};

}  // namespace koboshi::motion
