#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <utility>

#include "firmware/robot/model.h"
#include "simulation/motion_language/compile/program_writer.h"
#include "simulation/motion_language/parse/source.h"

namespace koboshi::simulation {

// The values that the steps `stiffness`, `gain`, `mix` and `lean` have set so far, in the order of
// the file. A move with settings of its own restores these after it.
class Settings {
 public:
  Settings() {
    stiffness_.fill(motion::Stiffness::kFull);
    gain_.fill(motion::Gain::kFull);
  }

  // Writes the settings of a step `stiffness`, `gain`, `mix` or `lean`, and keeps them.
  void apply(const StepSource& step, ProgramWriter& program);
  // Writes the settings of a move, before it.
  static void begin_move(const StepSource& move, ProgramWriter& program);
  // Restores the settings after a move. `next`: the step that follows in the same list, or nullptr; if it
  // declares a lean, that of the move is not restored.
  void end_move(const StepSource& move, const StepSource* next, ProgramWriter& program) const;

 private:
  using Percentages = std::array<std::uint8_t, robot::kMaxJoints>;  // by joint

  Percentages stiffness_{};
  Percentages gain_{};
  std::map<std::pair<std::uint8_t, motion::MixSource>, motion::Mix> mixes_{};  // by joint and source
  motion::LeanDeclaration lean_{};
};

}  // namespace koboshi::simulation
