#include "firmware/policy/activation.h"

namespace koboshi::policy {
namespace {

// e^x by its series at x / 2^10, squared ten times: relative error below 1e-12. Only while compiling.
consteval double exp_at(double x) {
  double term = 1.0;
  double sum = 1.0;
  for (int i = 1; i < 8; ++i) sum += term *= x / 1024.0 / i;
  for (int i = 0; i < 10; ++i) sum *= sum;
  return sum;
}

consteval double tanh_at(double x) { return 1.0 - 2.0 / (1.0 + exp_at(2.0 * x)); }
consteval double sigmoid_at(double x) { return 1.0 / (1.0 + exp_at(-x)); }
consteval double elu_at(double x) { return x >= 0.0 ? 0.0 : exp_at(x) - 1.0; }

consteval std::int32_t in_units(double value) {
  constexpr int kUnit = 1 << kTanhFractionBits;
  const double scaled = value * kUnit;
  const auto rounded = static_cast<std::int32_t>(scaled < 0.0 ? scaled - 0.5 : scaled + 0.5);
  return rounded >= kUnit ? kUnit - 1 : rounded;
}

consteval std::int32_t entry_at(double (*function)(double), int entry) {
  return in_units(function(static_cast<double>(entry - kTableZero) / (1 << kStepBits)));
}

consteval FunctionTable make_table(double (*function)(double)) {
  FunctionTable table{};
  for (int i = 0; i < 2 * kTableZero; ++i) {
    const std::int32_t value = entry_at(function, i);
    table[static_cast<std::size_t>(i)] = (entry_at(function, i + 1) - value) * (1 << 16) + (value & 0xFFFF);
  }
  return table;
}

}  // namespace

constinit const FunctionTable kTanhTable = make_table(tanh_at);
constinit const FunctionTable kSigmoidTable = make_table(sigmoid_at);
constinit const FunctionTable kExpTable = make_table(elu_at);

}  // namespace koboshi::policy
