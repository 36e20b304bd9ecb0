#include "firmware/policy/activation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "firmware/policy/rescale.h"

namespace koboshi::policy {
namespace {

std::vector<std::int16_t> all_arguments() {
  std::vector<std::int16_t> all;
  for (int z = -32768; z <= 32767; ++z) all.push_back(static_cast<std::int16_t>(z));
  return all;
}

double exact(Activation activation, double z) {
  switch (activation) {
    case Activation::kLinear:
      return z;
    case Activation::kRelu:
      return std::max(z, 0.0);
    case Activation::kElu:
      return z > 0.0 ? z : std::expm1(z);
    case Activation::kTanh:
      return std::tanh(z);
    case Activation::kSilu:
      return z / (1.0 + std::exp(-z));
  }
  return 0.0;
}

template <Activation kActivation, bool kWidens>
std::vector<std::int32_t> values_of(int fraction_bits) {
  const ActivationFunction<kActivation, kWidens> function(fraction_bits);
  std::vector<std::int32_t> values;
  for (const std::int16_t z : all_arguments()) values.push_back(function(z));
  return values;
}

template <Activation kActivation>
std::vector<std::int32_t> values_of(int fraction_bits) {
  return fraction_bits == kMaxFractionBits ? values_of<kActivation, false>(fraction_bits)
                                           : values_of<kActivation, true>(fraction_bits);
}

std::vector<std::int32_t> values_of(Activation activation, int fraction_bits) {
  switch (activation) {
    case Activation::kLinear:
      return values_of<Activation::kLinear>(fraction_bits);
    case Activation::kRelu:
      return values_of<Activation::kRelu>(fraction_bits);
    case Activation::kElu:
      return values_of<Activation::kElu>(fraction_bits);
    case Activation::kTanh:
      return values_of<Activation::kTanh>(fraction_bits);
    case Activation::kSilu:
      return values_of<Activation::kSilu>(fraction_bits);
  }
  return {};
}

// Largest error over all arguments, in units of the result.
double largest_error(Activation activation, int fraction_bits) {
  const std::vector<std::int16_t> arguments = all_arguments();
  const std::vector<std::int32_t> values = values_of(activation, fraction_bits);
  const int result_bits = activation == Activation::kTanh ? kTanhFractionBits : fraction_bits;
  double largest = 0.0;
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    const double expected =
        std::ldexp(exact(activation, std::ldexp(arguments[i], -fraction_bits)), result_bits);
    largest = std::max(largest, std::abs(values[i] - expected));
    EXPECT_EQ(values[i], static_cast<std::int16_t>(values[i])) << arguments[i];
  }
  return largest;
}

TEST(Activation, IsAccurateOverAllArguments) {
  struct Row {
    Activation activation;
    double bound;
  };
  for (const Row& row :
       {Row{Activation::kLinear, 0.0}, Row{Activation::kRelu, 0.0}, Row{Activation::kElu, 1.1},
        Row{Activation::kTanh, 4.2}, Row{Activation::kSilu, 1.2}}) {
    const double error = largest_error(row.activation, kMaxFractionBits);
    std::printf("function %d: error %.3f LSB\n", static_cast<int>(row.activation), error);
    EXPECT_LE(error, row.bound) << static_cast<int>(row.activation);
    EXPECT_GE(error, row.bound / 3) << "the bound is too wide";
  }
}

// The argument saturates at +-8, where the sigmoid is 3.4e-4 from its limit.
TEST(Activation, IsAccurateWithFewerFractionBits) {
  for (int bits = kMinFractionBits; bits < kMaxFractionBits; ++bits) {
    SCOPED_TRACE(bits);
    EXPECT_LE(largest_error(Activation::kElu, bits), 1.1);
    EXPECT_LE(largest_error(Activation::kTanh, bits), 4.2);
    EXPECT_LE(largest_error(Activation::kSilu, bits), 12.0);
  }
}

// But for the rounding of ties.
TEST(Activation, OfTanhIsOddToOneUnit) {
  const std::vector<std::int32_t> values = values_of(Activation::kTanh, kMaxFractionBits);
  for (std::size_t z = 1; z < 32768; ++z) ASSERT_NEAR(values[32768 + z], -values[32768 - z], 1) << z;
}

TEST(Activation, NeverDecreasesWhereTheFunctionDoesNot) {
  for (const Activation activation : {Activation::kRelu, Activation::kElu, Activation::kTanh}) {
    EXPECT_TRUE(std::ranges::is_sorted(values_of(activation, kMaxFractionBits)))
        << static_cast<int>(activation);
  }
}

TEST(Rescale, RoundsToNearestAndSaturates) {
  EXPECT_EQ(saturate16(32'768), 32'767);
  EXPECT_EQ(saturate16(-32'769), -32'768);
  EXPECT_EQ(saturate16(-5), -5);
  EXPECT_EQ(multiply_high(3, 1 << 30), 1);    // 0.75
  EXPECT_EQ(multiply_high(2, 1 << 30), 1);    // a tie goes up
  EXPECT_EQ(multiply_high(-2, 1 << 30), 0);   // likewise
  EXPECT_EQ(multiply_high(-3, 1 << 30), -1);  // -0.75
  EXPECT_EQ(multiply_high(std::numeric_limits<std::int32_t>::min(), std::numeric_limits<std::int32_t>::min()),
            1 << 30);
  EXPECT_EQ(rescale(2'147'483'647, 2'147'483'647), 32'767);
  EXPECT_EQ(rescale(std::numeric_limits<std::int32_t>::min(), 2'147'483'647), -32'768);
  EXPECT_EQ(rescale(123'456, 0), 0);
}

}  // namespace
}  // namespace koboshi::policy
