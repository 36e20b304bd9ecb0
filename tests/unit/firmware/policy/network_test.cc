// The network against references that are written anew: exact sums in 64 bits, and a network in double.

#include "firmware/policy/network.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <random>

#include "tests/unit/firmware/policy/policy_builder.h"

namespace koboshi::policy {
namespace {

using test::PolicyBuilder;

constexpr std::uint32_t kSeed = 20261127;

double function_of(Activation activation, double z) {
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

// The network of the builder in double, without rounding; saturates as the integers do. `in`: the activations
// of the inputs.
std::vector<double> in_double(const PolicyBuilder& policy, std::vector<double> in) {
  for (const PolicyBuilder::Layer& layer : policy.layers) {
    std::vector<double> out;
    in.resize(layer.columns);
    for (std::size_t row = 0; row < layer.rows; ++row) {
      double sum = layer.biases[row];
      for (std::size_t c = 0; c < layer.columns; ++c) sum += layer.weight(row, c) * in[c];
      const double rescaled = std::clamp(std::ldexp(sum * layer.multiplier, -32), -32768.0, 32767.0);
      const int result_bits = layer.activation == Activation::kTanh ? kTanhFractionBits : layer.fraction_bits;
      out.push_back(
          std::ldexp(function_of(layer.activation, std::ldexp(rescaled, -layer.fraction_bits)), result_bits));
    }
    in = out;
  }
  return in;
}

// Sums of one layer that every other implementation must give, too.
TEST(Layer, GivesTheExactSums) {
  std::mt19937 random(kSeed);
  const auto draw = [&](std::int32_t low, std::int32_t high) {
    return std::uniform_int_distribution<std::int32_t>(low, high)(random);
  };
  for (int trial = 0; trial < 300; ++trial) {
    PolicyBuilder::Layer layer{
        .rows = static_cast<std::uint8_t>(8 * draw(1, 16)),
        .columns = static_cast<std::size_t>(8 * draw(1, 16)),
        .multiplier = draw(0, std::numeric_limits<std::int32_t>::max()) >> draw(0, 16)};
    // Every third trial: extreme weights, activations and biases.
    const bool extreme = trial % 3 == 0;
    const int sign = draw(0, 1) == 0 ? 1 : -1;
    Activations in;
    for (std::size_t c = 0; c < layer.columns; ++c)
      in.values[c] =
          static_cast<std::int16_t>(extreme ? (sign > 0 ? 32'767 : -32'768) : draw(-32'768, 32'767));
    for (std::size_t i = 0; i < layer.rows * layer.columns; ++i)
      layer.weights.push_back(static_cast<std::int8_t>(extreme ? 127 : draw(-127, 127)));
    for (std::size_t row = 0; row < layer.rows; ++row)
      layer.biases.push_back(extreme ? sign * (kMaxBias - 1) : draw(1 - kMaxBias, kMaxBias - 1));
    PolicyBuilder builder;
    builder.layers = {layer};
    const std::vector<std::byte> image = builder.image();
    const std::byte* const biases =
        image.data() + image.size() - layer.rows * layer.columns - 4 * std::size_t{layer.rows};
    Activations out;
    Layer{.columns = layer.columns,
          .rows = layer.rows,
          .multiplier = layer.multiplier,
          .biases = biases,
          .weights = biases + 4 * std::size_t{layer.rows}}
        .run(in, out);
    for (std::size_t row = 0; row < layer.rows; ++row) {
      std::int64_t sum = layer.biases[row];
      for (std::size_t c = 0; c < layer.columns; ++c)
        sum += std::int64_t{layer.weight(row, c)} * in.values[c];
      ASSERT_EQ(static_cast<std::int32_t>(sum), sum) << "overflow in trial " << trial;
      ASSERT_EQ(out.values[row], rescale(static_cast<std::int32_t>(sum), layer.multiplier))
          << "trial " << trial << " row " << row;
    }
  }
}

struct Errors {
  double largest = 0.0;  // of an output, in LSB
  double rms = 0.0;
};

Errors errors_of(Activation activation, std::uint32_t seed) {
  std::mt19937 random(seed);
  const robot::RobotModel model = test::make_test_robot();
  Errors errors;
  double squares = 0.0;
  int count = 0;
  for (int network = 0; network < 40; ++network) {
    const auto inputs = static_cast<std::size_t>(4 + random() % 40);
    const auto width = [&] { return static_cast<std::uint8_t>(16 + 8 * (random() % 6)); };
    const PolicyBuilder builder =
        test::random_policy(random, model, inputs, {width(), width()}, 8, activation);
    const std::vector<std::byte> image = builder.image();
    Policy policy;
    const PolicyVerdict verdict = Policy::open(image, model, policy);
    EXPECT_TRUE(verdict.ok()) << static_cast<int>(verdict.status);
    if (!verdict.ok()) return errors;
    for (int sample = 0; sample < 20; ++sample) {
      Activations a;
      Activations b;
      std::vector<double> in;
      std::normal_distribution<double> normal(0.0, 4096.0);
      for (std::size_t i = 0; i < inputs; ++i) {
        a.values[i] = static_cast<std::int16_t>(std::clamp(normal(random), -32768.0, 32767.0));
        in.push_back(a.values[i]);
      }
      const Activations& out = policy.run(a, b);
      const std::vector<double> expected = in_double(builder, in);
      for (std::size_t i = 0; i < 8; ++i) {
        const double error = std::abs(out.values[i] - expected[i]);
        errors.largest = std::max(errors.largest, error);
        squares += error * error;
        ++count;
      }
    }
  }
  errors.rms = std::sqrt(squares / count);
  return errors;
}

// Errors of the arithmetic alone: the reference has the same quantised weights. The last layer is linear, and
// its activations have a standard deviation of some thousands of LSB.
TEST(Network, AgreesWithDoubleOverRandomNetworks) {
  struct Row {
    Activation activation;
    double largest_LSB;
    double rms_LSB;
  };
  for (const Row& row : {Row{Activation::kRelu, 2.5, 0.6}, Row{Activation::kElu, 2.5, 0.6},
                         Row{Activation::kTanh, 2.5, 0.6}, Row{Activation::kSilu, 2.5, 0.6}}) {
    const Errors errors = errors_of(row.activation, kSeed);
    std::printf("function %d: largest error %.2f LSB, rms %.3f LSB\n", static_cast<int>(row.activation),
                errors.largest, errors.rms);
    EXPECT_LE(errors.largest, row.largest_LSB) << static_cast<int>(row.activation);
    EXPECT_LE(errors.rms, row.rms_LSB);
    EXPECT_GE(errors.rms, 0.2) << "suspiciously good";
  }
}

}  // namespace
}  // namespace koboshi::policy
