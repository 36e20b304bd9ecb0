#include "simulation/motion_language/compile/expression_writer.h"

#include <optional>

#include "simulation/motion_language/parse/codes.h"

namespace koboshi::simulation {
namespace {

using motion::Arithmetic;

bool is_leaf(const Expression& expression) { return expression.is_integer() || expression.is_source(); }

bool reads(const Expression& expression, std::uint8_t variable) {
  if (expression.is_variable() && expression.source.index == variable) return true;
  return std::any_of(expression.items.begin(), expression.items.end(),
                     [&](const Expression& item) { return reads(item, variable); });
}

// Whether the variable is read after the first operand, which is the only one that is read before a write.
bool reads_late(const Expression& expression, std::uint8_t variable) {
  if (is_leaf(expression)) return false;
  return reads_late(expression.items[0], variable) || reads(expression.items[1], variable);
}

motion::Test test_of(const Expression& comparison) {
  const Expression& right = comparison.items[1];
  return {.left = comparison.items[0].source,
          .comparison = comparison.comparison,
          .with_variable = right.is_source(),
          .right = right.is_source() ? right.source.index : right.value};
}

}  // namespace

Expression integer_expression(std::int32_t value) { return {.value = value}; }

Expression variable_expression(std::uint8_t index) {
  return {.kind = Expression::Kind::kSource, .source = {motion::Source::kVariable, index}};
}

motion::Condition condition_of(const TestBlock& block) {
  return {.count = static_cast<std::uint8_t>(block.tests.size()), .any = block.any, .negated = block.negated};
}

ExpressionWriter::Temporary::Temporary(ExpressionWriter& owner, const Place& place) : owner_(owner) {
  const std::size_t index = owner.variables_ + owner.temporaries_++;
  owner.used_ = std::max(owner.used_, index + 1);
  if (index >= motion::kMaxVariables) {
    owner.diagnostics_.add({.code = code::kTooManyVariables,
                            .place = place,
                            .found = "an expression that needs a variable more than there are",
                            .expected = "at most 16 variables with those of expressions",
                            .hint = "compute it in several steps, or use fewer variables."});
  }
  index_ = static_cast<std::uint8_t>(std::min(index, motion::kMaxVariables - 1));
}

// --- Arithmetic

void ExpressionWriter::add_set(std::uint8_t variable, Arithmetic operation, const Expression& operand,
                               const Place& place) {
  program_.add(motion::Assignment{.variable = variable,
                                  .operation = operation,
                                  .from_source = operand.is_source(),
                                  .right = operand.is_source() ? operand.source.packed() : operand.value}
                   .step(),
               place);
}

void ExpressionWriter::assign(const Assignment& assignment, const Place& place) {
  const bool computes_in_place =
      assignment.operation == Arithmetic::kAssign && !reads_late(assignment.value, assignment.variable);
  if (computes_in_place) return compute_into(assignment.variable, assignment.value, place);
  apply(assignment.variable, assignment.operation, assignment.value, place);
}

// Computes an expression into a variable that it does not read late.
void ExpressionWriter::compute_into(std::uint8_t target, const Expression& expression, const Place& place) {
  if (is_leaf(expression)) return add_set(target, Arithmetic::kAssign, expression, place);
  const Expression& left = expression.items[0];
  if (!left.is_variable() || left.source.index != target) compute_into(target, left, place);
  apply(target, expression.operation, expression.items[1], place);
}

void ExpressionWriter::apply(std::uint8_t target, Arithmetic operation, const Expression& right,
                             const Place& place) {
  if (is_leaf(right)) return add_set(target, operation, right, place);
  const Temporary temporary(*this, place);
  compute_into(temporary.index(), right, place);
  add_set(target, operation, variable_expression(temporary.index()), place);
}

// --- Branches

void ExpressionWriter::add_tests(const TestBlock& block, const Place& place) {
  for (const Expression& test : block.tests) program_.add(test_of(test).step(), place);
}

void ExpressionWriter::add_branch(const TestBlock& block, Label target, const Place& place) {
  program_.add_to(target, condition_of(block).branch(0), place);
  add_tests(block, place);
}

// Branches on one comparison whose sides need arithmetic.
void ExpressionWriter::branch_on_computed(Expression comparison, bool wanted, Label target,
                                          const Place& place) {
  const Temporary left(*this, place);
  if (!comparison.items[0].is_source()) {
    compute_into(left.index(), comparison.items[0], place);
    comparison.items[0] = variable_expression(left.index());
  }
  std::optional<Temporary> right;
  if (!comparison.is_test()) {
    right.emplace(*this, place);
    compute_into(right->index(), comparison.items[1], place);
    comparison.items[1] = variable_expression(right->index());
  }
  add_branch({.any = false, .negated = !wanted, .tests = {std::move(comparison)}}, target, place);
}

void ExpressionWriter::branch(const Expression& condition, bool wanted, Label target, const Place& place) {
  if (condition.is_comparison()) {
    if (!condition.is_test()) return branch_on_computed(condition, wanted, target, place);
    return add_branch({.any = false, .negated = !wanted, .tests = {condition}}, target, place);
  }
  const bool any = condition.kind == Expression::Kind::kOr;
  // `or` that is wanted, and `and` that is not, are decided by one part: each part jumps to the target.
  // Otherwise each part but the last can only rule the jump out.
  const bool decides = any == wanted;
  const Label skip = decides ? target : program_.new_label();
  for (std::size_t i = 0; i < condition.items.size();) {
    std::size_t end = i;
    while (end < condition.items.size() && end - i < motion::kMaxTests && condition.items[end].is_test())
      ++end;
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
  if (!decides) program_.place_label(skip);
}

}  // namespace koboshi::simulation
