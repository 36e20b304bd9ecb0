#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "firmware/motion/inputs.h"
#include "firmware/motion/instructions.h"
#include "firmware/motion/motion.h"

namespace koboshi::motion {

// The memory of a running motion program: its variables, its clock and whether it is to stop; and the
// evaluation of sources, conditions and assignments on it.
class ProgramState {
 public:
  // Returns to the state at the start of a motion: all variables zero.
  void reset() { *this = {}; }
  void pass(std::uint32_t time_us);
  void stop() { stopping_ = true; }

  [[nodiscard]] bool stopping() const { return stopping_; }
  [[nodiscard]] std::span<const std::int32_t, kMaxVariables> variables() const { return variables_; }

  // Returns the value of a source in its unit. `targets`: of the joints, for their errors.
  [[nodiscard]] std::int32_t read(SourceRef ref, const Inputs& inputs,
                                  std::span<const fixed::Angle> targets) const;
  // Returns whether the condition of the step at `index` holds.
  [[nodiscard]] bool holds(const Motion& motion, std::size_t index, const Step& step, const Inputs& inputs,
                           std::span<const fixed::Angle> targets) const;
  // Carries out an assignment. Returns false, with nothing changed, at a division by zero.
  [[nodiscard]] bool assign(const Assignment& assignment, const Inputs& inputs,
                            std::span<const fixed::Angle> targets);

 private:
  std::array<std::int32_t, kMaxVariables> variables_{};
  std::uint32_t time_ms_ = 0;       // since the start
  std::uint32_t time_rest_us_ = 0;  // below 1000
  bool stopping_ = false;
};

}  // namespace koboshi::motion
