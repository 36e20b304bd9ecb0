#include "simulation/motion_language/parse/condition.h"

#include <limits>
#include <utility>

namespace koboshi::simulation {
namespace {

using motion::Comparison;

// Returns the comparison that holds where this one does not.
Comparison opposite(Comparison comparison) {
  switch (comparison) {
    case Comparison::kEqual:
      return Comparison::kNotEqual;
    case Comparison::kNotEqual:
      return Comparison::kEqual;
    case Comparison::kLess:
      return Comparison::kGreaterOrEqual;
    case Comparison::kLessOrEqual:
      return Comparison::kGreater;
    case Comparison::kGreater:
      return Comparison::kLessOrEqual;
    case Comparison::kGreaterOrEqual:
      break;
  }
  return Comparison::kLess;
}

// Returns the comparison with its sides exchanged.
Comparison exchanged(Comparison comparison) {
  switch (comparison) {
    case Comparison::kLess:
      return Comparison::kGreater;
    case Comparison::kLessOrEqual:
      return Comparison::kGreaterOrEqual;
    case Comparison::kGreater:
      return Comparison::kLess;
    case Comparison::kGreaterOrEqual:
      return Comparison::kLessOrEqual;
    default:
      return comparison;
  }
}

// Whether the expression is -a, for a sensor or variable a.
bool is_negated_source(const Expression& expression) {
  return expression.kind == Expression::Kind::kArithmetic &&
         expression.operation == motion::Arithmetic::kSubtract && expression.items[0].is_integer() &&
         expression.items[0].value == 0 && expression.items[1].is_source();
}

// Brings a comparison nearer to the form of a test.
Expression arranged(Expression comparison) {
  Expression& left = comparison.items[0];
  Expression& right = comparison.items[1];
  const bool swaps = (left.is_integer() && !right.is_integer()) ||
                     (left.is_variable() && !right.is_variable() && !right.is_integer());
  if (swaps) {
    std::swap(left, right);
    comparison.comparison = exchanged(comparison.comparison);
  }
  if (is_negated_source(left) && right.is_integer() &&
      right.value != std::numeric_limits<std::int32_t>::min()) {
    const Expression source = left.items[1];
    left = source;
    right.value = -right.value;
    comparison.comparison = exchanged(comparison.comparison);
  }
  return comparison;
}

}  // namespace

Expression normal_form(const Expression& condition, bool negate) {
  using Kind = Expression::Kind;
  if (condition.kind == Kind::kNot) return normal_form(condition.items[0], !negate);
  if (condition.is_comparison()) {
    Expression comparison = arranged(condition);
    if (negate) comparison.comparison = opposite(comparison.comparison);
    return comparison;
  }
  const bool is_and = (condition.kind == Kind::kAnd) != negate;
  Expression result{.kind = is_and ? Kind::kAnd : Kind::kOr, .place = condition.place};
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

}  // namespace koboshi::simulation
