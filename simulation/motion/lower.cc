#include "simulation/motion/lower.h"

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <optional>
#include <string>

#include "firmware/motion/instructions.h"
#include "firmware/robot/model.h"
#include "sim_board/input/text.h"
#include "simulation/motion/codes.h"
#include "simulation/motion/expression.h"

namespace koboshi::simulation {
namespace {

using motion::Opcode;
using Steps = std::vector<StepSource>;
using StepKind = StepSource::Kind;
using ExpressionKind = Expression::Kind;

constexpr SourceId kTimeSource{20, 0};
constexpr std::uint32_t kPoll_us = 10'000;  // one control tick

// --- Conditions

ExpressionKind opposite(ExpressionKind kind) {
  switch (kind) {
    case ExpressionKind::kEqual:
      return ExpressionKind::kNotEqual;
    case ExpressionKind::kNotEqual:
      return ExpressionKind::kEqual;
    case ExpressionKind::kLess:
      return ExpressionKind::kGreaterEqual;
    case ExpressionKind::kLessEqual:
      return ExpressionKind::kGreater;
    case ExpressionKind::kGreater:
      return ExpressionKind::kLessEqual;
    default:
      return ExpressionKind::kLess;
  }
}

// The comparison with its sides exchanged.
ExpressionKind exchanged(ExpressionKind kind) {
  switch (kind) {
    case ExpressionKind::kLess:
      return ExpressionKind::kGreater;
    case ExpressionKind::kLessEqual:
      return ExpressionKind::kGreaterEqual;
    case ExpressionKind::kGreater:
      return ExpressionKind::kLess;
    case ExpressionKind::kGreaterEqual:
      return ExpressionKind::kLessEqual;
    default:
      return kind;
  }
}

bool is_variable(const Expression& expression) {
  return expression.kind == ExpressionKind::kSource && expression.source.number == 0;
}

// -a, for a sensor or variable a.
bool is_negated_source(const Expression& expression) {
  return expression.kind == ExpressionKind::kSubtract &&
         expression.items[0].kind == ExpressionKind::kInteger && expression.items[0].value == 0 &&
         expression.items[1].kind == ExpressionKind::kSource;
}

// Brings a comparison nearer to the form of a test: a source on the left, an integer or variable on the
// right.
Expression arranged(Expression comparison) {
  Expression& left = comparison.items[0];
  Expression& right = comparison.items[1];
  const bool swaps = (left.kind == ExpressionKind::kInteger && right.kind != ExpressionKind::kInteger) ||
                     (is_variable(left) && !is_variable(right) && right.kind != ExpressionKind::kInteger);
  if (swaps) {
    std::swap(left, right);
    comparison.kind = exchanged(comparison.kind);
  }
  if (is_negated_source(left) && right.kind == ExpressionKind::kInteger &&
      right.value != std::numeric_limits<std::int32_t>::min()) {
    const Expression source = left.items[1];
    left = source;
    right.value = -right.value;
    comparison.kind = exchanged(comparison.kind);
  }
  return comparison;
}

// Whether a comparison is a test as it stands.
bool is_test(const Expression& comparison) {
  return comparison.items[0].kind == ExpressionKind::kSource &&
         (comparison.items[1].kind == ExpressionKind::kInteger || is_variable(comparison.items[1]));
}

// Returns the condition, or its opposite, as and, or and comparisons alone (negation normal form), with
// nested operators of one kind joined.
Expression normal_form(const Expression& condition, bool negate) {
  if (condition.kind == ExpressionKind::kNot) return normal_form(condition.items[0], !negate);
  if (condition.is_comparison()) {
    Expression comparison = arranged(condition);
    if (negate) comparison.kind = opposite(comparison.kind);
    return comparison;
  }
  const bool is_and = (condition.kind == ExpressionKind::kAnd) != negate;
  Expression result{.kind = is_and ? ExpressionKind::kAnd : ExpressionKind::kOr, .place = condition.place};
  for (const Expression& item : condition.items) {
    Expression part = normal_form(item, negate);
    if (part.kind == result.kind) {
      for (Expression& inner : part.items) result.items.push_back(std::move(inner));
    } else {
      result.items.push_back(std::move(part));
    }
  }
  return result;
}

// --- Settings of a step

// What steps of their own have set, in the order of the file; a step with settings of its own takes them back
// to it.
struct Settings {
  std::array<std::uint8_t, robot::kMaxJoints> stiffness{};
  std::map<std::pair<std::uint8_t, std::uint8_t>, MixSetting> mix;  // by joint and source
  LeanSetting lean;

  Settings() { stiffness.fill(motion::Stiffness::kFull); }

  void set(const StiffnessSetting& setting) {
    for (std::size_t joint = 0; joint < stiffness.size(); ++joint) {
      if ((setting.joints >> joint & 1u) != 0) stiffness[joint] = setting.percent;
    }
  }
};

std::uint32_t joints_of(const std::vector<StiffnessSetting>& settings) {
  std::uint32_t joints = 0;
  for (const StiffnessSetting& setting : settings) joints |= setting.joints;
  return joints;
}

class Lowering {
 public:
  Lowering(const MotionSource& motion, const std::vector<std::optional<std::uint16_t>>& pose_numbers,
           Diagnostics& diagnostics)
      : motion_(motion), pose_numbers_(pose_numbers), diagnostics_(diagnostics) {
    result_.variables = motion.variables.size();
  }

  LoweredMotion lower() {
    for (std::size_t i = 0; i < motion_.routines.size(); ++i) routine_labels_.push_back(new_label());
    const std::vector<std::size_t> order = order_of_routines();
    if (diagnostics_.has_errors()) return std::move(result_);
    lower_main();
    for (const std::size_t routine : order) lower_routine(routine);
    set_targets();
    return std::move(result_);
  }

 private:
  using Label = std::size_t;

  // --- Emission

  void add(const motion::Step& step, const Place& place) {
    if (result_.steps.size() == motion::kMaxSteps) {
      if (!is_full_) {
        diagnostics_.add({.code = code::kTooMany,
                          .place = place,
                          .found = "more than " + std::to_string(motion::kMaxSteps) + " steps",
                          .expected = "fewer"});
      }
      is_full_ = true;
      return;
    }
    result_.steps.push_back(step);
    result_.places.push_back(place);
  }

  Label new_label() {
    positions_.emplace_back();
    return positions_.size() - 1;
  }
  void place_label(Label label) { positions_[label] = static_cast<std::uint16_t>(result_.steps.size()); }
  // Adds a step whose target is filled in at the end.
  void add_to(Label label, const motion::Step& step, const Place& place) {
    patches_.emplace_back(result_.steps.size(), label);
    add(step, place);
  }
  void jump(Label label, const Place& place) { add_to(label, {Opcode::kJump, 0, 0, 0}, place); }

  void set_targets() {
    if (is_full_) return;
    for (const auto& [index, label] : patches_) {
      if (positions_[label]) result_.steps[index].operand = *positions_[label];
    }
  }

  bool has_label_here() const {
    return std::any_of(positions_.begin(), positions_.end(),
                       [&](const std::optional<std::uint16_t>& position) {
                         return position && *position == result_.steps.size();
                       });
  }

  // --- Named labels, which are those of one routine

  struct NamedLabel {
    Label label = 0;
    bool is_placed = false;
    std::optional<Place> first_use = {};
  };

  Label find_label(const std::string& name, const Place& use) {
    auto [found, is_new] = labels_.try_emplace(name);
    if (is_new) found->second.label = new_label();
    if (!found->second.first_use) found->second.first_use = use;
    return found->second.label;
  }

  void place_named(const StepSource& step) {
    auto [found, is_new] = labels_.try_emplace(step.label);
    if (is_new) found->second.label = new_label();
    if (found->second.is_placed) {
      diagnostics_.add({.code = code::kSecondLabel,
                        .place = step.place,
                        .found = "a second label '" + sim::one_line(step.label) + "'",
                        .expected = "one of a name"});
      return;
    }
    found->second.is_placed = true;
    place_label(found->second.label);
  }

  void check_labels() {
    std::vector<std::string> names;
    for (const auto& [name, label] : labels_) {
      if (label.is_placed) names.push_back(name);
    }
    for (const auto& [name, label] : labels_) {
      if (label.is_placed) continue;
      diagnostics_.add(
          {.code = code::kUnknownLabel,
           .place = *label.first_use,
           .found = "a jump to '" + sim::one_line(name) + "'",
           .expected = motion_.routines.empty() ? "a label of this file" : "a label of this routine",
           .hint = did_you_mean(name, names)});
    }
  }

  // --- Routines

  void lower_main() {
    const Place start = motion_.steps.empty() ? Place{} : motion_.steps.front().place;
    for (std::size_t i = 0; i < motion_.variables.size(); ++i) {
      const VariableSource& variable = motion_.variables[i];
      if (variable.initial != 0) {
        add_set(static_cast<std::uint8_t>(i), SetOperator::kAssign, integer(variable.initial),
                variable.place);
      }
    }
    lower_all(motion_.steps);
    const Opcode last = result_.steps.empty() ? Opcode::kWait : result_.steps.back().opcode;
    const bool ends = last == Opcode::kEnd || (motion_.version >= 2 && last == Opcode::kJump);
    if (!ends || has_label_here()) {
      add({Opcode::kEnd, 0, 0, 0}, motion_.steps.empty() ? start : motion_.steps.back().place);
    }
    if (!motion_.exit.empty()) set_exit();
    check_labels();
  }

  void set_exit() {
    const auto found = labels_.find(motion_.exit);
    if (found != labels_.end() && found->second.is_placed) {
      result_.exit = *positions_[found->second.label];
      return;
    }
    std::vector<std::string> names;
    for (const auto& [name, label] : labels_) {
      if (label.is_placed) names.push_back(name);
    }
    diagnostics_.add({.code = code::kBadExit,
                      .place = motion_.exit_place,
                      .found = "the exit '" + sim::one_line(motion_.exit) + "'",
                      .expected = "a label of the steps, outside of routines",
                      .hint = did_you_mean(motion_.exit, names)});
  }

  void lower_routine(std::size_t index) {
    const RoutineSource& routine = motion_.routines[index];
    labels_.clear();
    settings_ = Settings();
    place_label(routine_labels_[index]);
    const std::size_t begin = result_.steps.size();
    lower_all(routine.steps);
    const bool ends = result_.steps.size() > begin && result_.steps.back().opcode == Opcode::kReturn;
    if (!ends || has_label_here()) add({Opcode::kReturn, 0, 0, 0}, routine.place);
    check_labels();
  }

  static void find_calls(const Steps& steps, std::vector<const StepSource*>& calls) {
    for (const StepSource& step : steps) {
      if (step.kind == StepKind::kCall) calls.push_back(&step);
      find_calls(step.body, calls);
      find_calls(step.otherwise, calls);
    }
  }

  std::size_t routine_index(const std::string& name) const {
    const auto found = std::find_if(motion_.routines.begin(), motion_.routines.end(),
                                    [&](const RoutineSource& routine) { return routine.name == name; });
    return static_cast<std::size_t>(found - motion_.routines.begin());
  }

  // Routines in an order in which each stands after those that call it, else as in the file. Routines that
  // nothing calls are left out with a warning.
  std::vector<std::size_t> order_of_routines() {
    const std::size_t count = motion_.routines.size();
    std::vector<std::vector<const StepSource*>> calls(count + 1);  // the last: of the main program
    for (std::size_t i = 0; i < count; ++i) find_calls(motion_.routines[i].steps, calls[i]);
    find_calls(motion_.steps, calls[count]);
    std::vector<bool> is_used(count, false);
    std::vector<std::size_t> open{count};
    while (!open.empty()) {
      const std::size_t caller = open.back();
      open.pop_back();
      for (const StepSource* call : calls[caller]) {
        const std::size_t callee = routine_index(call->label);
        if (is_used[callee]) continue;
        is_used[callee] = true;
        open.push_back(callee);
      }
    }
    std::vector<std::size_t> callers(count, 0);
    for (std::size_t i = 0; i < count; ++i) {
      if (!is_used[i]) continue;
      for (const StepSource* call : calls[i]) ++callers[routine_index(call->label)];
    }
    std::vector<std::size_t> order;
    std::vector<bool> is_done(count, false);
    for (bool progress = true; progress;) {
      progress = false;
      for (std::size_t i = 0; i < count && !progress; ++i) {
        if (!is_used[i] || is_done[i] || callers[i] > 0) continue;
        is_done[i] = progress = true;
        order.push_back(i);
        for (const StepSource* call : calls[i]) --callers[routine_index(call->label)];
      }
    }
    for (std::size_t i = 0; i < count; ++i) {
      const RoutineSource& routine = motion_.routines[i];
      if (!is_used[i]) {
        diagnostics_.add({.code = code::kUnused,
                          .severity = Severity::kWarning,
                          .place = routine.place,
                          .found = "the routine '" + routine.name + "', which nothing calls",
                          .expected = "a call of it"});
      } else if (!is_done[i]) {
        diagnostics_.add({.code = code::kRecursion,
                          .place = routine.place,
                          .found = "the routine '" + routine.name + "' on a cycle of calls",
                          .expected = "routines that do not call themselves, directly or through others"});
      }
    }
    return order;
  }

  // --- Expressions

  static Expression integer(std::int32_t value) { return {.value = value}; }
  static Expression variable(std::uint8_t index) {
    return {.kind = ExpressionKind::kSource, .source = {0, index}};
  }

  // Variables of the compiler above those of the file.
  class Temporary {
   public:
    Temporary(Lowering& owner, const Place& place) : owner_(owner) {
      const std::size_t index = owner.motion_.variables.size() + owner.temporaries_++;
      owner.result_.variables = std::max(owner.result_.variables, index + 1);
      if (index >= motion::kMaxVariables) {
        owner.diagnostics_.add({.code = code::kTooManyVariables,
                                .place = place,
                                .found = "an expression that needs a variable more than there are",
                                .expected = "at most 16 variables with those of expressions",
                                .hint = "compute it in several steps, or use fewer variables."});
      }
      index_ = static_cast<std::uint8_t>(std::min(index, motion::kMaxVariables - 1));
    }
    ~Temporary() { --owner_.temporaries_; }
    Temporary(const Temporary&) = delete;
    Temporary& operator=(const Temporary&) = delete;
    std::uint8_t index() const { return index_; }

   private:
    Lowering& owner_;
    std::uint8_t index_;
  };

  static bool is_leaf(const Expression& expression) {
    return expression.kind == ExpressionKind::kInteger || expression.kind == ExpressionKind::kSource;
  }

  static bool reads(const Expression& expression, std::uint8_t index) {
    if (is_variable(expression) && expression.source.index == index) return true;
    return std::any_of(expression.items.begin(), expression.items.end(),
                       [&](const Expression& item) { return reads(item, index); });
  }
  // Whether the variable is read after the first operand, which is the only one that is read before a write.
  static bool reads_late(const Expression& expression, std::uint8_t index) {
    if (is_leaf(expression)) return false;
    return reads_late(expression.items[0], index) || reads(expression.items[1], index);
  }

  void add_set(std::uint8_t variable, SetOperator op, const Expression& leaf, const Place& place) {
    motion::Assignment assignment{.variable = variable, .operation = static_cast<motion::Arithmetic>(op)};
    assignment.from_source = leaf.kind == ExpressionKind::kSource;
    assignment.right =
        assignment.from_source
            ? static_cast<std::int32_t>(leaf.source.number | std::uint32_t{leaf.source.index} << 8)
            : leaf.value;
    add(assignment.step(), place);
  }

  static SetOperator operator_of(ExpressionKind kind) {
    return static_cast<SetOperator>(1 + static_cast<int>(kind) - static_cast<int>(ExpressionKind::kAdd));
  }

  // Computes an expression into a variable that it does not read late.
  void compute_into(std::uint8_t target, const Expression& expression, const Place& place) {
    if (is_leaf(expression)) return add_set(target, SetOperator::kAssign, expression, place);
    const Expression& left = expression.items[0];
    if (!is_variable(left) || left.source.index != target) compute_into(target, left, place);
    apply(target, operator_of(expression.kind), expression.items[1], place);
  }

  void apply(std::uint8_t target, SetOperator op, const Expression& right, const Place& place) {
    if (is_leaf(right)) return add_set(target, op, right, place);
    const Temporary temporary(*this, place);
    compute_into(temporary.index(), right, place);
    add_set(target, op, variable(temporary.index()), place);
  }

  void assign(const Assignment& assignment, const Place& place) {
    const bool is_late =
        assignment.op == SetOperator::kAssign && reads_late(assignment.value, assignment.variable);
    if (assignment.op == SetOperator::kAssign && !is_late) {
      return compute_into(assignment.variable, assignment.value, place);
    }
    apply(assignment.variable, assignment.op, assignment.value, place);
  }

  // --- Branches

  static motion::Test test_of(const Expression& comparison) {
    const Expression& left = comparison.items[0];
    const Expression& right = comparison.items[1];
    motion::Test test;
    test.left = {static_cast<motion::Source>(left.source.number), left.source.index};
    test.comparison = static_cast<motion::Comparison>(static_cast<int>(comparison.kind) -
                                                      static_cast<int>(ExpressionKind::kEqual));
    test.with_variable = right.kind == ExpressionKind::kSource;
    test.right = test.with_variable ? right.source.index : right.value;
    return test;
  }

  void add_tests(const std::vector<Expression>& tests, const Place& place) {
    for (const Expression& test : tests) add(test_of(test).step(), place);
  }

  static motion::Condition condition_of(const TestBlock& block) {
    return {
        .count = static_cast<std::uint8_t>(block.tests.size()), .any = block.any, .negated = block.negated};
  }

  void add_branch(const TestBlock& block, Label target, const Place& place) {
    add_to(target, condition_of(block).branch(0), place);
    add_tests(block.tests, place);
  }

  // Branches on one comparison whose sides need arithmetic.
  void branch_on_computed(Expression comparison, bool wanted, Label target, const Place& place) {
    const Temporary left(*this, place);
    if (comparison.items[0].kind != ExpressionKind::kSource) {
      compute_into(left.index(), comparison.items[0], place);
      comparison.items[0] = variable(left.index());
    }
    std::optional<Temporary> right;
    if (comparison.items[1].kind != ExpressionKind::kInteger && !is_variable(comparison.items[1])) {
      right.emplace(*this, place);
      compute_into(right->index(), comparison.items[1], place);
      comparison.items[1] = variable(right->index());
    }
    add_branch({.any = false, .negated = !wanted, .tests = {std::move(comparison)}}, target, place);
  }

  // Jumps to `target` if the condition, in normal form, is `wanted`; else goes on.
  void branch(const Expression& condition, bool wanted, Label target, const Place& place) {
    if (condition.is_comparison()) {
      if (!is_test(condition)) return branch_on_computed(condition, wanted, target, place);
      return add_branch({.any = false, .negated = !wanted, .tests = {condition}}, target, place);
    }
    const bool any = condition.kind == ExpressionKind::kOr;
    // `or` that is wanted, and `and` that is not, are decided by one part: each part jumps to the target.
    // Otherwise each part but the last can only rule the jump out.
    const bool decides = any == wanted;
    const Label skip = decides ? target : new_label();
    for (std::size_t i = 0; i < condition.items.size();) {
      std::size_t end = i;
      while (end < condition.items.size() && end - i < motion::kMaxTests &&
             condition.items[end].is_comparison() && is_test(condition.items[end])) {
        ++end;
      }
      const bool is_run = end > i;
      if (!is_run) ++end;
      const bool is_last = end == condition.items.size();
      const bool part_wanted = is_last ? wanted : any;
      const Label part_target = is_last ? target : skip;
      if (is_run) {
        TestBlock block{.any = any, .negated = !part_wanted, .tests = {}};
        for (std::size_t item = i; item < end; ++item) block.tests.push_back(condition.items[item]);
        add_branch(block, part_target, place);
      } else {
        branch(condition.items[i], part_wanted, part_target, place);
      }
      i = end;
    }
    if (!decides) place_label(skip);
  }

  void branch_if(const Expression& condition, bool wanted, Label target, const Place& place) {
    branch(normal_form(condition, false), wanted, target, place);
  }

  // --- Waits

  static std::optional<TestBlock> single_block(const Expression& condition) {
    if (condition.is_comparison()) {
      if (!is_test(condition)) return std::nullopt;
      return TestBlock{.any = false, .negated = false, .tests = {condition}};
    }
    const bool fits = condition.items.size() <= motion::kMaxTests &&
                      std::all_of(condition.items.begin(), condition.items.end(), [](const Expression& item) {
                        return item.is_comparison() && is_test(item);
                      });
    if (!fits) return std::nullopt;
    return TestBlock{
        .any = condition.kind == ExpressionKind::kOr, .negated = false, .tests = condition.items};
  }

  void lower_await(const StepSource& step) {
    const std::optional<Expression> condition =
        step.condition ? std::optional(normal_form(*step.condition, false)) : std::nullopt;
    const std::optional<TestBlock> block = step.tests ? step.tests : single_block(*condition);
    if (!block) return poll(*condition, step);
    const motion::Step await = condition_of(*block).await(motion::kNoStep, step.time_us);
    const Label out = new_label();
    if (!step.label.empty()) {
      add_to(find_label(step.label, step.place), await, step.place);
    } else if (step.continues) {
      add_to(out, await, step.place);
    } else {
      add(await, step.place);
    }
    add_tests(block->tests, step.place);
    if (step.continues) place_label(out);
  }

  // Waits for a condition that no single step can test: evaluates it in every tick.
  void poll(const Expression& condition, const StepSource& step) {
    const Place& place = step.place;
    const Temporary deadline(*this, place);
    const Label again = new_label();
    const Label timeout = new_label();
    const Label out = new_label();
    add_set(deadline.index(), SetOperator::kAssign, {.kind = ExpressionKind::kSource, .source = kTimeSource},
            place);
    add_set(deadline.index(), SetOperator::kAdd,
            integer(static_cast<std::int32_t>((step.time_us + 999) / 1'000)), place);
    place_label(again);
    branch(condition, true, out, place);
    const Expression late{
        .kind = ExpressionKind::kGreaterEqual,
        .items = {{.kind = ExpressionKind::kSource, .source = kTimeSource}, variable(deadline.index())}};
    branch(late, true, timeout, place);
    add({Opcode::kWait, 0, kPoll_us, 0}, place);
    jump(again, place);
    place_label(timeout);
    if (!step.label.empty()) {
      jump(find_label(step.label, place), place);
    } else if (!step.continues) {
      add({Opcode::kFail, 0, 0, 0}, place);
    }
    place_label(out);
  }

  // --- Steps

  void lower_all(const Steps& steps) {
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
        return place_named(step);
      case StepKind::kJump:
        return lower_jump(step);
      case StepKind::kExpect:
        return add(step.attitude.step(), step.place);
      case StepKind::kSet:
        for (const Assignment& assignment : step.assignments) assign(assignment, step.place);
        return;
      case StepKind::kCall:
        return add_to(routine_labels_[routine_index(step.label)], {Opcode::kCall, 0, 0, 0}, step.place);
      case StepKind::kReturn:
        return add({Opcode::kReturn, 0, 0, 0}, step.place);
      case StepKind::kFail:
        return add({Opcode::kFail, 0, 0, 0}, step.place);
      case StepKind::kStiffness:
        for (const StiffnessSetting& setting : step.stiffness) {
          add_stiffness(setting, step.place);
          settings_.set(setting);
        }
        return;
      case StepKind::kMix:
        return lower_mix(step);
      case StepKind::kLean:
        add_lean(*step.lean, step.place);
        settings_.lean = *step.lean;
        return;
      case StepKind::kEnd:
        return add({Opcode::kEnd, 0, 0, 0}, step.place);
    }
  }

  void add_stiffness(const StiffnessSetting& setting, const Place& place) {
    add(motion::Stiffness{.percent = setting.percent, .joints = setting.joints}.step(), place);
  }
  void add_lean(const LeanSetting& lean, const Place& place) {
    add(motion::LeanDeclaration{.pitch = lean.pitch, .roll = lean.roll}.step(), place);
  }
  void add_mix(const MixSetting& mix, const Place& place) {
    add(motion::Mix{.source = static_cast<motion::MixSource>(mix.source),
                    .joint = mix.joint,
                    .gain = mix.gain,
                    .limit = mix.limit}
            .step(),
        place);
  }

  void lower_mix(const StepSource& step) {
    if (step.mix.empty()) {
      settings_.mix.clear();
      return add({Opcode::kMixClear, 0, 0, 0}, step.place);
    }
    for (const MixSetting& mix : step.mix) {
      add_mix(mix, step.place);
      settings_.mix[{mix.joint, mix.source}] = mix;
    }
  }

  void lower_move(const StepSource& step, const StepSource* next) {
    if (step.lean) add_lean(*step.lean, step.place);
    for (const StiffnessSetting& setting : step.stiffness) add_stiffness(setting, step.place);
    for (const MixSetting& mix : step.mix) add_mix(mix, step.place);
    motion::Move move{.interpolation = static_cast<motion::Interpolation>(step.interpolation),
                      .by_speed = step.speed_raw > 0,
                      .pose = pose_numbers_[step.pose].value_or(0)};
    move.value = move.by_speed ? step.speed_raw : step.time_us;
    const bool moves = pose_numbers_[step.pose].has_value();
    add(moves ? move.step() : motion::Step{Opcode::kWait, 0, step.time_us, 0}, step.place);
    if (step.pause_us > 0) add({Opcode::kWait, 0, step.pause_us, 0}, step.place);
    take_back(step, next);
  }

  void take_back(const StepSource& step, const StepSource* next) {
    for (const MixSetting& mix : step.mix) {
      const auto before = settings_.mix.find({mix.joint, mix.source});
      add_mix(before == settings_.mix.end() ? MixSetting{mix.joint, mix.source, 0, 0} : before->second,
              step.place);
    }
    std::uint32_t left = joints_of(step.stiffness);
    while (left != 0) {
      StiffnessSetting setting;
      setting.percent = settings_.stiffness[static_cast<std::size_t>(__builtin_ctz(left))];
      for (std::size_t joint = 0; joint < settings_.stiffness.size(); ++joint) {
        if ((left >> joint & 1u) != 0 && settings_.stiffness[joint] == setting.percent)
          setting.joints |= 1u << joint;
      }
      add_stiffness(setting, step.place);
      left &= ~setting.joints;
    }
    // The next step that declares a lean replaces this one.
    const bool replaced = next != nullptr && next->lean.has_value();
    if (step.lean && !replaced) add_lean(settings_.lean, step.place);
  }

  void lower_loop(const StepSource& step) {
    if (step.loop == StepSource::LoopKind::kTimes || step.loop == StepSource::LoopKind::kUntilStopped) {
      const auto begin = static_cast<std::uint16_t>(result_.steps.size());
      add({Opcode::kLoopBegin, step.times, 0, 0}, step.place);
      lower_all(step.body);
      return add({Opcode::kLoopEnd, begin, 0, 0}, step.place);
    }
    const Label again = new_label();
    const Label out = new_label();
    place_label(again);
    if (step.loop == StepSource::LoopKind::kWhile) {
      branch_if(*step.condition, false, out, step.place);
      lower_all(step.body);
      jump(again, step.place);
      place_label(out);
    } else {
      lower_all(step.body);
      branch_if(*step.condition, false, again, step.place);
    }
  }

  void lower_if(const StepSource& step) {
    const Label otherwise = new_label();
    branch_if(*step.condition, false, otherwise, step.place);
    lower_all(step.body);
    if (step.otherwise.empty()) return place_label(otherwise);
    const Label out = new_label();
    jump(out, step.place);
    place_label(otherwise);
    lower_all(step.otherwise);
    place_label(out);
  }

  void lower_jump(const StepSource& step) {
    const Label target = find_label(step.label, step.place);
    if (step.tests) return add_branch(*step.tests, target, step.place);
    if (step.condition) return branch_if(*step.condition, true, target, step.place);
    jump(target, step.place);
  }

  const MotionSource& motion_;
  const std::vector<std::optional<std::uint16_t>>& pose_numbers_;
  Diagnostics& diagnostics_;
  LoweredMotion result_;
  bool is_full_ = false;
  std::vector<std::optional<std::uint16_t>> positions_;  // of the labels
  std::vector<std::pair<std::size_t, Label>> patches_;   // steps whose target is a label
  std::map<std::string, NamedLabel> labels_;             // of the routine being lowered
  std::vector<Label> routine_labels_;
  Settings settings_;
  std::size_t temporaries_ = 0;
};

}  // namespace

LoweredMotion lower_motion(const MotionSource& motion,
                           const std::vector<std::optional<std::uint16_t>>& pose_numbers,
                           Diagnostics& diagnostics) {
  return Lowering(motion, pose_numbers, diagnostics).lower();
}

}  // namespace koboshi::simulation
