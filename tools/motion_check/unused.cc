#include "tools/motion_check/unused.h"

#include <set>
#include <string>
#include <utility>

#include "firmware/motion/instructions.h"

namespace koboshi::tools {
namespace {

using motion::Opcode;
using simulation::Expression;
using simulation::StepSource;
using Kind = StepSource::Kind;

struct UsedNames {
  std::set<std::size_t> poses;
  std::set<std::size_t> variables;  // that are read
  std::set<std::string> targets;
  std::vector<std::pair<std::string, simulation::Place>> labels;
};

void collect(const Expression& expression, UsedNames& names) {
  if (expression.kind == Expression::Kind::kSource && expression.source.source == motion::Source::kVariable)
    names.variables.insert(expression.source.index);
  for (const Expression& item : expression.items) collect(item, names);
}

void collect(const std::vector<StepSource>& steps, UsedNames& names) {
  for (const StepSource& step : steps) {
    if (step.kind == Kind::kMove) names.poses.insert(step.pose);
    if (step.kind == Kind::kJump || step.kind == Kind::kAwait) names.targets.insert(step.label);
    if (step.kind == Kind::kLabel) names.labels.emplace_back(step.label, step.place);
    if (step.condition) collect(*step.condition, names);
    if (step.tests)
      for (const Expression& test : step.tests->tests) collect(test, names);
    for (const simulation::Assignment& assignment : step.assignments) collect(assignment.value, names);
    collect(step.body, names);
    collect(step.otherwise, names);
  }
}

simulation::Diagnostic warning(const char* code, std::string found, std::string expected,
                               const simulation::Place& place) {
  return {.code = code,
          .severity = simulation::Severity::kWarning,
          .place = place,
          .found = std::move(found),
          .expected = std::move(expected)};
}

// Returns the steps to which some way leads, whatever the conditions are.
std::vector<bool> reached_steps(const motion::Motion& motion) {
  std::vector<bool> reached(motion.step_count());
  std::vector<std::size_t> open{0};
  if (motion.exit_step() != motion::kNoStep) open.push_back(motion.exit_step());
  while (!open.empty()) {
    const std::size_t index = open.back();
    open.pop_back();
    if (index >= reached.size() || reached[index]) continue;
    reached[index] = true;
    const motion::Step step = motion.step(index);
    const bool ends = step.opcode == Opcode::kEnd || step.opcode == Opcode::kFail ||
                      step.opcode == Opcode::kReturn || step.opcode == Opcode::kJump;
    if (!ends) open.push_back(index + 1);
    const bool leads_on = step.opcode == Opcode::kJump || step.opcode == Opcode::kBranch ||
                          step.opcode == Opcode::kAwait || step.opcode == Opcode::kCall;
    if (leads_on) open.push_back(step.operand);
  }
  return reached;
}

// Steps that the compiler adds have no place of their own: an end, a return, a jump past an `else`.
bool is_own_step(Opcode opcode) {
  return opcode != Opcode::kEnd && opcode != Opcode::kReturn && opcode != Opcode::kJump &&
         opcode != Opcode::kLoopEnd && !motion::is_attached(opcode);
}

}  // namespace

std::vector<simulation::Diagnostic> find_unused(const simulation::MotionSource& source,
                                                const simulation::CompiledMotion& compiled,
                                                const motion::Motion& motion) {
  UsedNames names;
  collect(source.steps, names);
  for (const simulation::RoutineSource& routine : source.routines) collect(routine.steps, names);
  names.targets.insert(source.exit);
  std::vector<simulation::Diagnostic> found;
  for (std::size_t pose = 0; pose < source.poses.size(); ++pose) {
    if (!names.poses.contains(pose) && !source.poses[pose].is_base)
      found.push_back(warning("C017", "the unused pose '" + source.poses[pose].name + "'",
                              "a step that uses it", source.poses[pose].place));
  }
  for (const auto& [label, place] : names.labels) {
    if (!names.targets.contains(label))
      found.push_back(warning("C017", "the unused label '" + label + "'", "a step that uses it", place));
  }
  for (std::size_t i = 0; i < source.variables.size(); ++i) {
    if (!names.variables.contains(i))
      found.push_back(warning("C015", "the variable '" + source.variables[i].name + "', which nothing reads",
                              "a condition or value that reads it", source.variables[i].place));
  }
  const std::vector<bool> reached = reached_steps(motion);
  bool named = false;  // the part that is not reached
  for (std::size_t i = 0; i < reached.size(); ++i) {
    if (reached[i]) named = false;
    if (reached[i] || named || !is_own_step(motion.opcode(i))) continue;
    named = true;
    found.push_back(
        warning("C014", "a step that is never reached", "a step that leads to it", compiled.step_places[i]));
  }
  return found;
}

}  // namespace koboshi::tools
