#include "tools/policy/mlp_builder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace koboshi::tools {
namespace {

using policy::Activation;
using ::testing::HasSubstr;

std::vector<double> random_numbers(std::mt19937& random, std::size_t count) {
  std::normal_distribution<double> normal;
  std::vector<double> numbers(count);
  for (double& number : numbers) number = normal(random);
  return numbers;
}

// The operations one after the other, as a graph computes them.
struct Plain {
  std::vector<double> x;

  void scale(const std::vector<double>& factor, const std::vector<double>& offset) {
    for (std::size_t i = 0; i < x.size(); ++i)
      x[i] = x[i] * factor[factor.size() == 1 ? 0 : i] + offset[offset.size() == 1 ? 0 : i];
  }
  void multiply(std::size_t rows, const std::vector<double>& weights) {
    std::vector<double> y(rows);
    for (std::size_t row = 0; row < rows; ++row) {
      for (std::size_t c = 0; c < x.size(); ++c) y[row] += weights[row * x.size() + c] * x[c];
    }
    x = y;
  }
  void tanh() {
    for (double& each : x) each = std::tanh(each);
  }
  void clip(double bound) {
    for (double& each : x) each = std::clamp(each, -bound, bound);
  }
};

TEST(MlpBuilder, FoldsScalingsAndKeepsTheFunction) {
  std::mt19937 random(11);
  for (int trial = 0; trial < 20; ++trial) {
    MlpBuilder builder;
    Plain plain{random_numbers(random, 5)};
    const std::vector<double> in = plain.x;
    const auto scale = [&](std::size_t factors, std::size_t offsets) {
      const auto factor = random_numbers(random, factors);
      const auto offset = random_numbers(random, offsets);
      ASSERT_EQ(builder.scale(factor, offset), "");
      plain.scale(factor, offset);
    };
    const auto multiply = [&](std::size_t rows) {
      const auto weights = random_numbers(random, rows * plain.x.size());
      ASSERT_EQ(builder.multiply(rows, plain.x.size(), weights), "");
      plain.multiply(rows, weights);
    };
    scale(5, 1);
    scale(1, 5);
    if (trial % 2 == 0) {
      ASSERT_EQ(builder.clip(-1.0, 1.0), "");
      plain.clip(1.0);
      scale(1, 5);  // after a clip: a layer of its own
    }
    multiply(7);
    scale(1, 7);
    ASSERT_EQ(builder.activate(Activation::kTanh), "");
    plain.tanh();
    if (trial % 3 == 0) scale(7, 7);
    multiply(6);
    multiply(4);  // without a function between them: one layer
    scale(4, 4);
    ASSERT_EQ(builder.slice(1, 3), "");
    plain.x = {plain.x[1], plain.x[2]};
    const std::vector<double> out = builder.mlp().run(in);
    ASSERT_EQ(out.size(), 2u);
    EXPECT_NEAR(out[0], plain.x[0], 1e-9);
    EXPECT_NEAR(out[1], plain.x[1], 1e-9);
    EXPECT_LE(builder.mlp().layers.size(), 3u);
  }
}

TEST(MlpBuilder, RefusesWhatIsNoPerceptron) {
  const std::vector<double> one{1.0};
  EXPECT_THAT(MlpBuilder().activate(Activation::kRelu), HasSubstr("before the first layer"));
  EXPECT_THAT(MlpBuilder().scale(one, one), HasSubstr("before the number of inputs is known"));
  EXPECT_THAT(MlpBuilder().clip(-1.0, 2.0), HasSubstr("bounds of -1 and 2"));
  EXPECT_THAT(MlpBuilder().slice(0, 1), HasSubstr("slice of the inputs"));
  MlpBuilder builder;
  ASSERT_EQ(builder.multiply(2, 3, std::vector<double>(6, 1.0)), "");
  EXPECT_THAT(builder.scale(std::vector<double>(3, 1.0), one), HasSubstr("3 elements where there are 2"));
  EXPECT_THAT(builder.clip(-1.0, 1.0), HasSubstr("after the first layer"));
  EXPECT_THAT(builder.slice(1, 3), HasSubstr("elements 1 to 3 of 2"));
  EXPECT_EQ(builder.width(), 2u);
}

}  // namespace
}  // namespace koboshi::tools
