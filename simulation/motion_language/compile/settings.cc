#include "simulation/motion_language/compile/settings.h"

#include <bit>

namespace koboshi::simulation {
namespace {

template <typename Shares, typename Percentages>
void keep(const Shares& settings, Percentages& percent) {
  for (const auto& setting : settings) {
    for (std::size_t joint = 0; joint < percent.size(); ++joint) {
      if ((setting.joints >> joint & 1u) != 0) percent[joint] = setting.percent;
    }
  }
}

// Restores all joints of one percentage by one step.
template <typename Share, typename Percentages>
void restore(const std::vector<Share>& settings, const Percentages& percent, const Place& place,
             ProgramWriter& program) {
  std::uint32_t left = 0;
  for (const Share& setting : settings) left |= setting.joints;
  while (left != 0) {
    Share setting{.percent = percent[static_cast<std::size_t>(std::countr_zero(left))]};
    for (std::size_t joint = 0; joint < percent.size(); ++joint) {
      if ((left >> joint & 1u) != 0 && percent[joint] == setting.percent) setting.joints |= 1u << joint;
    }
    program.add(setting.step(), place);
    left &= ~setting.joints;
  }
}

}  // namespace

void Settings::apply(const StepSource& step, ProgramWriter& program) {
  begin_move(step, program);
  keep(step.stiffness, stiffness_);
  keep(step.gain, gain_);
  for (const motion::Mix& mix : step.mix) mixes_[{mix.joint, mix.source}] = mix;
  if (step.lean) lean_ = *step.lean;
  if (step.kind == StepSource::Kind::kMix && step.mix.empty()) {
    mixes_.clear();
    program.add({motion::Opcode::kMixClear, 0, 0, 0}, step.place);
  }
}

void Settings::begin_move(const StepSource& move, ProgramWriter& program) {
  if (move.lean) program.add(move.lean->step(), move.place);
  for (const motion::Stiffness& setting : move.stiffness) program.add(setting.step(), move.place);
  for (const motion::Gain& setting : move.gain) program.add(setting.step(), move.place);
  for (const motion::Mix& mix : move.mix) program.add(mix.step(), move.place);
}

void Settings::end_move(const StepSource& move, const StepSource* next, ProgramWriter& program) const {
  for (const motion::Mix& mix : move.mix) {
    const auto before = mixes_.find({mix.joint, mix.source});
    const motion::Mix removed{.source = mix.source, .joint = mix.joint, .gain = 0, .limit = 0};
    program.add((before == mixes_.end() ? removed : before->second).step(), move.place);
  }
  restore(move.stiffness, stiffness_, move.place, program);
  restore(move.gain, gain_, move.place, program);
  const bool is_replaced = next != nullptr && next->lean.has_value();
  if (move.lean && !is_replaced) program.add(lean_.step(), move.place);
}

}  // namespace koboshi::simulation
