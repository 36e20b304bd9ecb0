#include "simulation/motion_language/parse/expression.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <limits>

#include "base/text/text.h"
#include "simulation/motion_language/parse/codes.h"
#include "simulation/motion_language/parse/sensors.h"

namespace koboshi::simulation {
namespace {

using ExpressionKind = Expression::Kind;
using motion::Arithmetic;
using motion::Comparison;

constexpr std::size_t kMaxLength = 1'000;
constexpr int kMaxDepth = 40;

struct Token {
  std::string_view text;  // empty at the end
  std::size_t offset = 0;
};

template <typename Operator>
struct OperatorName {
  std::string_view text;
  Operator operation;
};
template <typename Operator, std::size_t N>
using OperatorNames = std::array<OperatorName<Operator>, N>;

constexpr OperatorNames<Comparison, 6> kComparisons{{{"==", Comparison::kEqual},
                                                     {"!=", Comparison::kNotEqual},
                                                     {"<=", Comparison::kLessOrEqual},
                                                     {">=", Comparison::kGreaterOrEqual},
                                                     {"<", Comparison::kLess},
                                                     {">", Comparison::kGreater}}};
constexpr OperatorNames<Arithmetic, 2> kSums{{{"+", Arithmetic::kAdd}, {"-", Arithmetic::kSubtract}}};
constexpr OperatorNames<Arithmetic, 3> kProducts{
    {{"*", Arithmetic::kMultiply}, {"/", Arithmetic::kDivide}, {"%", Arithmetic::kRemainder}}};
constexpr std::array<std::string_view, 5> kWords{"and", "or", "not", "min", "max"};

bool is_letter(char letter) { return std::isalpha(static_cast<unsigned char>(letter)) != 0 || letter == '_'; }
bool is_digit(char letter) { return letter >= '0' && letter <= '9'; }

template <typename Operator, std::size_t N>
std::optional<Operator> find_operator(const OperatorNames<Operator, N>& names, std::string_view text) {
  for (const OperatorName<Operator>& name : names) {
    if (name.text == text) return name.operation;
  }
  return std::nullopt;
}

// Thrown after the error is reported.
struct SyntaxStop {};

// A recursive descent parser with the usual precedence: or, and, not, comparison, sum, product, sign.
class ExpressionParser {
 public:
  ExpressionParser(std::string_view text, const Place& place, const std::vector<VariableSource>& variables,
                   const JointNames& joints, Diagnostics& diagnostics)
      : text_(text), place_(place), variables_(variables), joints_(joints), diagnostics_(diagnostics) {}

  std::optional<Expression> parse() {
    try {
      if (text_.size() > kMaxLength) {
        stop({}, code::kSyntax, "an expression of " + std::to_string(text_.size()) + " letters",
             "at most " + std::to_string(kMaxLength));
      }
      advance();
      Expression whole = disjunction();
      if (!token_.text.empty()) unexpected("an operator, or the end of the expression");
      return whole;
    } catch (const SyntaxStop&) {
      return std::nullopt;
    }
  }

 private:
  Place place_of(const Token& token) const {
    Place place = place_;
    if (place.column > 0) place.column += static_cast<int>(token.offset);
    place.length = static_cast<int>(std::max<std::size_t>(token.text.size(), 1));
    return place;
  }

  [[noreturn]] void stop(const Token& token, const char* code, std::string found, std::string expected,
                         std::string hint = {}) {
    diagnostics_.add({.code = code,
                      .place = place_of(token),
                      .found = std::move(found),
                      .expected = std::move(expected),
                      .hint = std::move(hint)});
    throw SyntaxStop();
  }
  [[noreturn]] void unexpected(const std::string& expected, const std::string& hint = {}) {
    const std::string found =
        token_.text.empty() ? "the end of '" + one_line(text_) + "'" : "'" + one_line(token_.text) + "'";
    stop(token_, code::kSyntax, found, expected, hint);
  }

  void advance() {
    std::size_t begin = token_.offset + token_.text.size();
    while (begin < text_.size() && std::isspace(static_cast<unsigned char>(text_[begin])) != 0) ++begin;
    std::size_t end = begin;
    if (begin < text_.size() && (is_letter(text_[begin]) || is_digit(text_[begin]))) {
      while (end < text_.size() && (is_letter(text_[end]) || is_digit(text_[end]))) ++end;
    } else if (begin < text_.size()) {
      const bool is_double = text_.size() > begin + 1 && text_[begin + 1] == '=' &&
                             std::string_view("=!<>").find(text_[begin]) != std::string_view::npos;
      end = begin + (is_double ? 2 : 1);
    }
    token_ = {text_.substr(begin, end - begin), begin};
  }

  bool accept(std::string_view text) {
    if (token_.text != text) return false;
    advance();
    return true;
  }
  void expect(std::string_view text) {
    if (!accept(text)) unexpected("'" + std::string(text) + "'");
  }

  void require_number(const Expression& expression) {
    if (!expression.is_condition()) return;
    diagnostics_.add({.code = code::kNotACondition,
                      .place = expression.place,
                      .found = "a condition",
                      .expected = "a number"});
    throw SyntaxStop();
  }

  Expression disjunction() { return joined("or", ExpressionKind::kOr, &ExpressionParser::conjunction); }
  Expression conjunction() { return joined("and", ExpressionKind::kAnd, &ExpressionParser::negation); }

  Expression joined(std::string_view word, ExpressionKind kind, Expression (ExpressionParser::*part)()) {
    Expression first = (this->*part)();
    if (token_.text != word) return first;
    Expression all{.kind = kind, .place = first.place};
    all.items.push_back(as_condition(std::move(first)));
    while (accept(word)) all.items.push_back(as_condition((this->*part)()));
    return all;
  }

  Expression negation() {
    const Token token = token_;
    if (!accept("not")) return comparison();
    const Depth depth(*this);
    return {.kind = ExpressionKind::kNot, .place = place_of(token), .items = {as_condition(negation())}};
  }

  Expression comparison() {
    Expression left = sum();
    if (token_.text == "=") unexpected("'=='", "`=` does not compare.");
    const auto comparison = find_operator(kComparisons, token_.text);
    if (!comparison) return left;
    require_number(left);
    advance();
    Expression right = sum();
    require_number(right);
    if (find_operator(kComparisons, token_.text)) {
      unexpected("the end of the comparison", "join two comparisons by `and`.");
    }
    const Place place = left.place;
    return {.kind = ExpressionKind::kComparison,
            .place = place,
            .comparison = *comparison,
            .items = {std::move(left), std::move(right)}};
  }

  Expression sum() { return chain(kSums, &ExpressionParser::product); }
  Expression product() { return chain(kProducts, &ExpressionParser::signed_value); }

  template <std::size_t N>
  Expression chain(const OperatorNames<Arithmetic, N>& operators, Expression (ExpressionParser::*part)()) {
    Expression left = (this->*part)();
    int length = 0;
    while (const auto operation = find_operator(operators, token_.text)) {
      if (++length > kMaxDepth) unexpected("at most " + std::to_string(kMaxDepth) + " operators in a row");
      require_number(left);
      const Token token = token_;
      advance();
      Expression right = (this->*part)();
      require_number(right);
      left = combined(*operation, std::move(left), std::move(right), token);
    }
    return left;
  }

  Expression combined(Arithmetic operation, Expression left, Expression right, const Token& token) {
    const bool divides = operation == Arithmetic::kDivide || operation == Arithmetic::kRemainder;
    if (divides && right.is_integer() && right.value == 0) {
      stop(token, code::kDivisionByZero, "a division by zero", "another divisor");
    }
    const Place place = left.place;
    if (left.is_integer() && right.is_integer()) {
      return {.place = place, .value = *compute(operation, left.value, right.value)};
    }
    return {.kind = ExpressionKind::kArithmetic,
            .place = place,
            .operation = operation,
            .items = {std::move(left), std::move(right)}};
  }

  Expression signed_value() {
    const Token token = token_;
    if (accept("+")) return signed_nested();
    if (!accept("-")) return value();
    if (!token_.text.empty() && is_digit(token_.text.front())) return integer(true);
    Expression inner = signed_nested();
    require_number(inner);
    return combined(Arithmetic::kSubtract, {.place = place_of(token)}, std::move(inner), token);
  }
  Expression signed_nested() {
    const Depth depth(*this);
    return signed_value();
  }

  Expression integer(bool negative) {
    const Token token = token_;
    std::int64_t magnitude = 0;
    const auto [end, error] =
        std::from_chars(token.text.data(), token.text.data() + token.text.size(), magnitude);
    if (end != token.text.data() + token.text.size() && error != std::errc::result_out_of_range) {
      unexpected("an integer");
    }
    const std::int64_t number = negative ? -magnitude : magnitude;
    if (error != std::errc() || number < std::numeric_limits<std::int32_t>::min() ||
        number > std::numeric_limits<std::int32_t>::max()) {
      stop(token, code::kIntegerRange,
           "the integer " + std::string(negative ? "-" : "") + one_line(token.text),
           "an integer of 32 bits, -2147483648 to 2147483647");
    }
    advance();
    return {.place = place_of(token), .value = static_cast<std::int32_t>(number)};
  }

  Expression value() {
    const Token token = token_;
    if (token.text.empty()) unexpected("a number, a variable or a sensor");
    if (is_digit(token.text.front())) return integer(false);
    if (accept("(")) {
      const Depth depth(*this);
      Expression inner = disjunction();
      expect(")");
      return inner;
    }
    if (!is_letter(token.text.front())) unexpected("a number, a variable or a sensor");
    advance();
    if (token.text == "min") return function(Arithmetic::kMinimum, token);
    if (token.text == "max") return function(Arithmetic::kMaximum, token);
    return source(token);
  }

  Expression function(Arithmetic operation, const Token& token) {
    const Depth depth(*this);
    expect("(");
    Expression result = sum();
    require_number(result);
    if (token_.text != ",") unexpected("','");
    int length = 0;
    while (accept(",")) {
      if (++length > kMaxDepth) unexpected("fewer operands");
      Expression next = sum();
      require_number(next);
      result = combined(operation, std::move(result), std::move(next), token);
    }
    expect(")");
    return result;
  }

  Expression source(const Token& token) {
    Expression result{.kind = ExpressionKind::kSource, .place = place_of(token)};
    for (std::size_t i = 0; i < variables_.size(); ++i) {
      if (variables_[i].name != token.text) continue;
      result.source = {motion::Source::kVariable, static_cast<std::uint8_t>(i)};
      return result;
    }
    const Sensor* sensor = find_sensor(token.text);
    if (sensor == nullptr) unknown(token);
    result.source.source = sensor->source;
    if (sensor->index == Sensor::Index::kNone) return result;
    expect("(");
    result.source.index = sensor->index == Sensor::Index::kJoint ? joint() : input();
    expect(")");
    return result;
  }

  std::uint8_t joint() {
    const Token token = token_;
    const auto found = joints_.find(token.text);
    if (!found) {
      stop(token, code::kUnknownJoint, "the joint '" + one_line(token.text) + "'",
           "a joint of " + joints_.robot().robot, did_you_mean(token.text, joints_.robot().joint_names));
    }
    advance();
    return static_cast<std::uint8_t>(*found);
  }

  std::uint8_t input() {
    if (token_.text.empty() || !is_digit(token_.text.front())) unexpected("the number of an input, 1 to 8");
    const Token token = token_;
    const std::int32_t number = integer(false).value;
    if (number < 1 || number > static_cast<std::int32_t>(kInputs)) {
      stop(token, code::kBadValue, "input " + std::to_string(number), "an input from 1 to 8");
    }
    return static_cast<std::uint8_t>(number - 1);
  }

  [[noreturn]] void unknown(const Token& token) {
    std::vector<std::string> names;
    for (const VariableSource& variable : variables_) names.push_back(variable.name);
    for (const Sensor& sensor : kSensors) names.emplace_back(sensor.name);
    stop(token, code::kUnknownOperand, "the name '" + one_line(token.text) + "'",
         "a variable of this file or a sensor", did_you_mean(token.text, names));
  }

  // Bounds the recursion.
  class Depth {
   public:
    explicit Depth(ExpressionParser& parser) : depth_(parser.depth_) {
      if (++depth_ > kMaxDepth) parser.unexpected("at most " + std::to_string(kMaxDepth) + " levels");
    }
    ~Depth() { --depth_; }
    Depth(const Depth&) = delete;
    Depth& operator=(const Depth&) = delete;

   private:
    int& depth_;
  };

  std::string_view text_;
  Place place_;
  const std::vector<VariableSource>& variables_;
  const JointNames& joints_;
  Diagnostics& diagnostics_;
  Token token_;
  int depth_ = 0;
};

}  // namespace

bool is_reserved(std::string_view name) {
  return find_sensor(name) != nullptr || std::find(kWords.begin(), kWords.end(), name) != kWords.end();
}

bool is_identifier(std::string_view text) {
  return !text.empty() && is_letter(text.front()) && std::all_of(text.begin(), text.end(), [](char letter) {
    return is_letter(letter) || is_digit(letter);
  });
}

std::optional<Expression> parse_expression(std::string_view text, const Place& place,
                                           const std::vector<VariableSource>& variables,
                                           const JointNames& joints, Diagnostics& diagnostics) {
  return ExpressionParser(text, place, variables, joints, diagnostics).parse();
}

Expression as_condition(Expression expression) {
  if (expression.is_condition()) return expression;
  const Place place = expression.place;
  return {.kind = ExpressionKind::kComparison,
          .place = place,
          .comparison = motion::Comparison::kNotEqual,
          .items = {std::move(expression), Expression{.place = place}}};
}

std::optional<std::int32_t> compute(Arithmetic operation, std::int32_t left, std::int32_t right) {
  const auto saturated = [](std::int64_t value) {
    return static_cast<std::int32_t>(std::clamp<std::int64_t>(value, std::numeric_limits<std::int32_t>::min(),
                                                              std::numeric_limits<std::int32_t>::max()));
  };
  const std::int64_t a = left;
  const std::int64_t b = right;
  switch (operation) {
    case Arithmetic::kAdd:
      return saturated(a + b);
    case Arithmetic::kSubtract:
      return saturated(a - b);
    case Arithmetic::kMultiply:
      return saturated(a * b);
    case Arithmetic::kDivide:
      return b == 0 ? std::nullopt : std::optional(saturated(a / b));
    case Arithmetic::kRemainder:
      return b == 0 ? std::nullopt : std::optional(saturated(a % b));
    case Arithmetic::kMinimum:
      return std::min(left, right);
    case Arithmetic::kMaximum:
      return std::max(left, right);
    case Arithmetic::kAssign:
      return right;
  }
  return std::nullopt;
}

}  // namespace koboshi::simulation
