#include "simulation/motion_language/parse/parse_values.h"

#include <algorithm>
#include <array>
#include <string>

#include "simulation/motion_language/parse/codes.h"
#include "simulation/motion_language/parse/condition.h"
#include "simulation/motion_language/parse/expression.h"

namespace koboshi::simulation {
namespace {

const std::array<std::string, 4> kTestForms{"all", "any", "not_all", "not_any"};
// Beginnings of a value of `set`, by motion::Arithmetic. The first is implied.
constexpr std::array<std::string_view, 8> kSetOperators{"=", "+=", "-=", "*=", "/=", "%=", "min=", "max="};

}  // namespace

std::optional<Expression> ValueParser::expression(const YamlNode& node, std::size_t skip) {
  if (node.kind != YamlNode::Kind::kScalar || node.scalar.empty()) {
    reader_.bad_value(node, "an expression");
    return std::nullopt;
  }
  Place place = Reader::value_place(node);
  if (place.column > 0) place.column += static_cast<int>(skip) + (node.quoted ? 1 : 0);
  return parse_expression(std::string_view(node.scalar).substr(skip), place, variables_, joints_,
                          reader_.diagnostics());
}

std::optional<Expression> ValueParser::condition(const YamlNode& node) {
  auto parsed = expression(node);
  if (!parsed) return std::nullopt;
  return as_condition(std::move(*parsed));
}

bool ValueParser::assignments(const YamlNode& value, std::vector<Assignment>& assignments) {
  if (!reader_.is_map(value)) return false;
  const std::size_t errors = reader_.diagnostics().error_count();
  for (const YamlNode& item : value.items) {
    Assignment assignment;
    const auto variable = std::find_if(variables_.begin(), variables_.end(),
                                       [&](const VariableSource& other) { return other.name == item.key; });
    if (variable == variables_.end()) {
      std::vector<std::string> names;
      for (const VariableSource& known : variables_) names.push_back(known.name);
      reader_.error(code::kUnknownVariable, Reader::key_place(item),
                    "the variable '" + one_line(item.key) + "'", "one of the list `variables` of this file",
                    did_you_mean(item.key, names));
      continue;
    }
    assignment.variable = static_cast<std::uint8_t>(variable - variables_.begin());
    std::size_t skip = 0;
    for (std::size_t i = 1; i < kSetOperators.size(); ++i) {
      if (item.kind != YamlNode::Kind::kScalar || !item.scalar.starts_with(kSetOperators[i])) continue;
      assignment.operation = static_cast<motion::Arithmetic>(i);
      skip = kSetOperators[i].size();
    }
    auto parsed = expression(item, skip);
    if (!parsed) continue;
    if (parsed->is_condition()) {
      reader_.error(code::kNotACondition, Reader::value_place(item), "a condition", "a number",
                    "use `if` to choose between two values.");
      continue;
    }
    const bool divides = assignment.operation == motion::Arithmetic::kDivide ||
                         assignment.operation == motion::Arithmetic::kRemainder;
    if (divides && parsed->is_integer() && parsed->value == 0) {
      reader_.error(code::kDivisionByZero, Reader::value_place(item), "a division by zero",
                    "another divisor");
      continue;
    }
    assignment.value = std::move(*parsed);
    assignments.push_back(std::move(assignment));
  }
  return reader_.diagnostics().error_count() == errors;
}

bool ValueParser::is_test(const YamlNode& node, const Expression& expression) {
  if (expression.is_test()) return true;
  reader_.bad_value(node, "a sensor or variable, compared with an integer or a variable");
  return false;
}

bool ValueParser::tests(const YamlNode& value, TestBlock& block) {
  const std::size_t errors = reader_.diagnostics().error_count();
  const YamlNode* list = nullptr;
  for (const std::string& form : kTestForms) {
    const YamlNode* node = value.find(form);
    if (node == nullptr) continue;
    if (list != nullptr) {
      reader_.error(code::kContradiction, Reader::key_place(*node), "two lists of tests", "one of them");
      return false;
    }
    list = node;
    block.any = form.ends_with("any");
    block.negated = form.starts_with("not_");
  }
  if (list == nullptr) {
    reader_.error(code::kMissingKey, Reader::key_place(value), "no tests", "all, any, not_all or not_any");
    return false;
  }
  if (list->kind != YamlNode::Kind::kList || list->items.empty() || list->items.size() > motion::kMaxTests) {
    reader_.bad_value(*list, "a list of 1 to 8 comparisons");
    return false;
  }
  for (const YamlNode& item : list->items) {
    const auto parsed = expression(item);
    if (!parsed) continue;
    // A sensor may have a minus, as in mirrored motions: -a < 5 is the test a > -5.
    Expression test = parsed->is_comparison() ? normal_form(*parsed) : *parsed;
    if (is_test(item, test)) block.tests.push_back(std::move(test));
  }
  return reader_.diagnostics().error_count() == errors;
}

}  // namespace koboshi::simulation
