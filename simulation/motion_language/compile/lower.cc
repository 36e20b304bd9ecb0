#include "simulation/motion_language/compile/lower.h"

#include <algorithm>
#include <optional>
#include <string>

#include "base/text/text.h"
#include "simulation/motion_language/compile/expression_writer.h"
#include "simulation/motion_language/compile/named_labels.h"
#include "simulation/motion_language/compile/program_writer.h"
#include "simulation/motion_language/compile/routines.h"
#include "simulation/motion_language/compile/settings.h"
#include "simulation/motion_language/parse/codes.h"
#include "simulation/motion_language/parse/condition.h"

namespace koboshi::simulation {
namespace {

using motion::Opcode;
using StepKind = StepSource::Kind;
using PoseNumbers = std::vector<std::optional<std::uint16_t>>;

constexpr std::uint32_t kAfterTimeout_us = 1'000;
constexpr std::uint32_t kPoll_us = 10'000;  // one control tick

// Returns the condition, in normal form, as the tests of one step; nothing if it needs more.
std::optional<TestBlock> single_block(const Expression& condition) {
  if (condition.is_test()) return TestBlock{.tests = {condition}};
  if (condition.is_comparison() || condition.items.size() > motion::kMaxTests) return std::nullopt;
  const bool are_tests = std::all_of(condition.items.begin(), condition.items.end(),
                                     [](const Expression& item) { return item.is_test(); });
  if (!are_tests) return std::nullopt;
  return TestBlock{.any = condition.kind == Expression::Kind::kOr, .tests = condition.items};
}

class Lowering {
 public:
  Lowering(const MotionSource& motion, const PoseNumbers& pose_numbers, Diagnostics& diagnostics)
      : motion_(motion),
        pose_numbers_(pose_numbers),
        diagnostics_(diagnostics),
        program_(diagnostics),
        expressions_(motion.variables.size(), program_, diagnostics),
        labels_(program_, diagnostics) {}

  LoweredMotion lower() {
    for (std::size_t i = 0; i < motion_.routines.size(); ++i) routine_labels_.push_back(program_.new_label());
    const std::vector<std::size_t> order = order_of_routines(motion_, diagnostics_);
    std::uint16_t exit = motion::kNoStep;
    if (!diagnostics_.has_errors()) {
      exit = lower_main();
      for (const std::size_t routine : order) lower_routine(routine);
      program_.set_targets();
    }
    return {.steps = program_.take_steps(),
            .places = program_.take_places(),
            .variables = expressions_.variables(),
            .exit = exit};
  }

 private:
  using Label = ProgramWriter::Label;

  // --- Main program and routines

  // Returns the step at which the exit path begins.
  std::uint16_t lower_main() {
    for (std::size_t i = 0; i < motion_.variables.size(); ++i) {
      const VariableSource& variable = motion_.variables[i];
      if (variable.initial == 0) continue;
      expressions_.add_set(static_cast<std::uint8_t>(i), motion::Arithmetic::kAssign,
                           integer_expression(variable.initial), variable.place);
    }
    lower_all(motion_.steps);
    const Opcode last = program_.steps().empty() ? Opcode::kWait : program_.steps().back().opcode;
    const bool ends = last == Opcode::kEnd || (motion_.version >= 2 && last == Opcode::kJump);
    if (!ends || program_.has_label_here())
      add({Opcode::kEnd, 0, 0, 0}, motion_.steps.empty() ? Place{} : motion_.steps.back().place);
    const std::uint16_t exit = motion_.exit.empty() ? motion::kNoStep : exit_position();
    check_labels();
    return exit;
  }

  std::uint16_t exit_position() {
    if (const auto label = labels_.find_placed(motion_.exit)) return program_.position_of(*label);
    diagnostics_.add({.code = code::kBadExit,
                      .place = motion_.exit_place,
                      .found = "the exit '" + one_line(motion_.exit) + "'",
                      .expected = "a label of the steps, outside of routines",
                      .hint = did_you_mean(motion_.exit, labels_.placed_names())});
    return motion::kNoStep;
  }

  void lower_routine(std::size_t index) {
    const RoutineSource& routine = motion_.routines[index];
    labels_.clear();
    settings_ = Settings();
    program_.place_label(routine_labels_[index]);
    const std::size_t begin = program_.position();
    lower_all(routine.steps);
    const bool ends = program_.position() > begin && program_.steps().back().opcode == Opcode::kReturn;
    if (!ends || program_.has_label_here()) add({Opcode::kReturn, 0, 0, 0}, routine.place);
    check_labels();
  }

  void check_labels() const {
    labels_.check(motion_.routines.empty() ? "a label of this file" : "a label of this routine");
  }

  // --- Steps

  void add(const motion::Step& step, const Place& place) { program_.add(step, place); }

  void lower_all(const std::vector<StepSource>& steps) {
    for (std::size_t i = 0; i < steps.size(); ++i)
      lower_step(steps[i], i + 1 < steps.size() ? &steps[i + 1] : nullptr);
  }

  void lower_step(const StepSource& step, const StepSource* next) {
    switch (step.kind) {
      case StepKind::kMove:
        return lower_move(step, next);
      case StepKind::kWait:
        return add({Opcode::kWait, 0, step.time_us, 0}, step.place);
      case StepKind::kAwait:
        return lower_await(step);
      case StepKind::kLoop:
        return lower_loop(step);
      case StepKind::kIf:
        return lower_if(step);
      case StepKind::kLabel:
        return labels_.place(step);
      case StepKind::kJump:
        return lower_jump(step);
      case StepKind::kExpect:
        return add(step.attitude.step(), step.place);
      case StepKind::kSet:
        for (const Assignment& assignment : step.assignments) expressions_.assign(assignment, step.place);
        return;
      case StepKind::kCall:
        return program_.add_to(routine_labels_[routine_index(motion_, step.label)], {Opcode::kCall, 0, 0, 0},
                               step.place);
      case StepKind::kReturn:
        return add({Opcode::kReturn, 0, 0, 0}, step.place);
      case StepKind::kFail:
        return add({Opcode::kFail, 0, 0, 0}, step.place);
      case StepKind::kStiffness:
      case StepKind::kGain:
      case StepKind::kMix:
      case StepKind::kLean:
        return settings_.apply(step, program_);
      case StepKind::kEnd:
        return add({Opcode::kEnd, 0, 0, 0}, step.place);
    }
  }

  void lower_move(const StepSource& step, const StepSource* next) {
    Settings::begin_move(step, program_);
    const std::optional<std::uint16_t> pose = pose_numbers_[step.pose];
    const bool by_speed = step.speed_raw > 0;
    const motion::Move move{.interpolation = step.interpolation,
                            .by_speed = by_speed,
                            .pose = pose.value_or(0),
                            .value = by_speed ? step.speed_raw : step.time_us,
                            .at_least = step.at_least,
                            .windows = static_cast<std::uint8_t>(step.windows.size())};
    add(pose ? move.step() : motion::Step{Opcode::kWait, 0, step.time_us, 0}, step.place);
    if (pose) {
      for (const motion::Window& window : step.windows) add_window(window, step);
    }
    if (step.pause_us > 0) add({Opcode::kWait, 0, step.pause_us, 0}, step.place);
    settings_.end_move(step, next, program_);
  }

  // A group may have joints that the pose does not move.
  void add_window(motion::Window window, const StepSource& step) {
    const auto& angles = motion_.poses[step.pose].angles;
    for (std::size_t joint = 0; joint < robot::kMaxJoints; ++joint) {
      if (joint >= angles.size() || !angles[joint]) window.joints &= ~(1u << joint);
    }
    if (window.joints != 0) return add(window.step(), step.place);
    diagnostics_.add({.code = code::kContradiction,
                      .place = step.place,
                      .found = "during for joints that the pose does not move",
                      .expected = "joints of the pose"});
  }

  void lower_loop(const StepSource& step) {
    if (step.loop == StepSource::LoopKind::kTimes || step.loop == StepSource::LoopKind::kUntilStopped) {
      const std::uint16_t begin = program_.position();
      add({Opcode::kLoopBegin, step.times, 0, 0}, step.place);
      lower_all(step.body);
      return add({Opcode::kLoopEnd, begin, 0, 0}, step.place);
    }
    const Label again = program_.new_label();
    const Label out = program_.new_label();
    program_.place_label(again);
    if (step.loop == StepSource::LoopKind::kWhile) {
      branch_if(*step.condition, false, out, step.place);
      lower_all(step.body);
      program_.add_jump(again, step.place);
      program_.place_label(out);
    } else {
      lower_all(step.body);
      branch_if(*step.condition, false, again, step.place);
    }
  }

  void lower_if(const StepSource& step) {
    const Label otherwise = program_.new_label();
    branch_if(*step.condition, false, otherwise, step.place);
    lower_all(step.body);
    if (step.otherwise.empty()) return program_.place_label(otherwise);
    const Label out = program_.new_label();
    program_.add_jump(out, step.place);
    program_.place_label(otherwise);
    lower_all(step.otherwise);
    program_.place_label(out);
  }

  void lower_jump(const StepSource& step) {
    const Label target = labels_.target(step.label, step.place);
    if (step.tests) return expressions_.add_branch(*step.tests, target, step.place);
    if (step.condition) return branch_if(*step.condition, true, target, step.place);
    program_.add_jump(target, step.place);
  }

  // --- Waits

  void lower_await(const StepSource& step) {
    const std::optional<Expression> condition =
        step.condition ? std::optional(normal_form(*step.condition)) : std::nullopt;
    const std::optional<TestBlock> block = step.tests ? step.tests : single_block(*condition);
    if (!block) return poll(*condition, step);
    const motion::Step await = condition_of(*block).await(motion::kNoStep, step.time_us);
    const Label out = program_.new_label();
    if (!step.label.empty()) {
      program_.add_to(labels_.target(step.label, step.place), await, step.place);
    } else if (step.continues) {
      program_.add_to(out, await, step.place);
    } else {
      add(await, step.place);
    }
    expressions_.add_tests(*block, step.place);
    if (step.continues) program_.place_label(out);
  }

  // Waits for a condition that no single step can test: evaluates it in every tick.
  void poll(const Expression& condition, const StepSource& step) {
    const Place& place = step.place;
    const ExpressionWriter::Temporary deadline(expressions_, place);
    const Expression time{.kind = Expression::Kind::kSource, .source = {motion::Source::kTime, 0}};
    const Label again = program_.new_label();
    const Label timeout = program_.new_label();
    const Label out = program_.new_label();
    expressions_.add_set(deadline.index(), motion::Arithmetic::kAssign, time, place);
    expressions_.add_set(deadline.index(), motion::Arithmetic::kAdd,
                         integer_expression(static_cast<std::int32_t>((step.time_us + 999) / 1'000)), place);
    program_.place_label(again);
    expressions_.branch(condition, true, out, place);
    const Expression late{.kind = Expression::Kind::kComparison,
                          .comparison = motion::Comparison::kGreaterOrEqual,
                          .items = {time, variable_expression(deadline.index())}};
    expressions_.branch(late, true, timeout, place);
    add({Opcode::kWait, 0, kPoll_us, 0}, place);
    program_.add_jump(again, place);
    program_.place_label(timeout);
    if (!step.label.empty()) {
      // The label may lead back to this step, and the validator does not know that time has passed.
      add({Opcode::kWait, 0, kAfterTimeout_us, 0}, place);
      program_.add_jump(labels_.target(step.label, place), place);
    } else if (!step.continues) {
      add({Opcode::kFail, 0, 0, 0}, place);
    }
    program_.place_label(out);
  }

  void branch_if(const Expression& condition, bool wanted, Label target, const Place& place) {
    expressions_.branch(normal_form(condition), wanted, target, place);
  }

  const MotionSource& motion_;
  const PoseNumbers& pose_numbers_;
  Diagnostics& diagnostics_;
  ProgramWriter program_;
  ExpressionWriter expressions_;
  NamedLabels labels_;                 // of the main program or routine being lowered
  std::vector<Label> routine_labels_;  // by routine
  Settings settings_;
};

}  // namespace

LoweredMotion lower_motion(const MotionSource& motion, const PoseNumbers& pose_numbers,
                           Diagnostics& diagnostics) {
  return Lowering(motion, pose_numbers, diagnostics).lower();
}

}  // namespace koboshi::simulation
