#include "simulation/motion_language/compile/program_writer.h"

#include <algorithm>
#include <string>

#include "simulation/motion_language/parse/codes.h"

namespace koboshi::simulation {

void ProgramWriter::add(const motion::Step& step, const Place& place) {
  if (steps_.size() == motion::kMaxSteps) {
    if (!is_full_) {
      diagnostics_.add({.code = code::kTooMany,
                        .place = place,
                        .found = "more than " + std::to_string(motion::kMaxSteps) + " steps",
                        .expected = "fewer"});
    }
    is_full_ = true;
    return;
  }
  steps_.push_back(step);
  places_.push_back(place);
}

void ProgramWriter::add_to(Label label, const motion::Step& step, const Place& place) {
  jumps_.emplace_back(steps_.size(), label);
  add(step, place);
}

void ProgramWriter::add_jump(Label label, const Place& place) {
  add_to(label, {motion::Opcode::kJump, 0, 0, 0}, place);
}

ProgramWriter::Label ProgramWriter::new_label() {
  positions_.emplace_back();
  return positions_.size() - 1;
}

bool ProgramWriter::has_label_here() const {
  return std::find(positions_.begin(), positions_.end(), std::optional(position())) != positions_.end();
}

void ProgramWriter::set_targets() {
  if (is_full_) return;
  for (const auto& [index, label] : jumps_) {
    if (positions_[label]) steps_[index].operand = *positions_[label];
  }
}

}  // namespace koboshi::simulation
