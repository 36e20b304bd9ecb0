#include "lab/tune/optimiser.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace koboshi::lab {
namespace {

const std::vector<double> kBest{0.9, 0.2, 0.5};

// A narrow valley, as gaits have them.
double valley(const std::vector<double>& x) {
  double sum = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i)
    sum += std::pow(10.0, static_cast<double>(i)) * std::pow(x[i] - kBest[i], 2.0);
  return sum;
}

TEST(Optimiser, FindsTheMinimum) {
  const std::vector<double> found = minimise(valley, {0.1, 0.9, 0.1}, {.evaluations = 1200});
  for (std::size_t i = 0; i < found.size(); ++i) EXPECT_NEAR(found[i], kBest[i], 1e-3);
}

TEST(Optimiser, EvaluatesTheStartFirstAndStaysWithinBoundsAndBudget) {
  std::vector<std::vector<double>> evaluated;
  const auto corner = [&](const std::vector<double>& x) {
    evaluated.push_back(x);
    return x[0] + x[1];
  };
  static_cast<void>(minimise(corner, {0.05, 0.95}, {.evaluations = 120, .population = 12}));
  EXPECT_EQ(evaluated.size(), 120u);
  EXPECT_EQ(evaluated.front(), (std::vector<double>{0.05, 0.95}));
  for (const std::vector<double>& x : evaluated) {
    for (const double value : x) {
      EXPECT_GE(value, 0.0);
      EXPECT_LE(value, 1.0);
    }
  }
}

TEST(Optimiser, IsReproducible) {
  std::vector<std::vector<double>> runs[2];
  for (auto& run : runs) {
    const auto objective = [&](const std::vector<double>& x) {
      run.push_back(x);
      return valley(x);
    };
    static_cast<void>(minimise(objective, {0.5, 0.5, 0.5}, {.evaluations = 60}));
  }
  EXPECT_EQ(runs[0], runs[1]);
}

TEST(Optimiser, DoesNotStopOnFlatGround) {
  int evaluations = 0;
  const auto flat = [&](const std::vector<double>&) { return static_cast<double>(++evaluations * 0); };
  static_cast<void>(minimise(flat, {0.5, 0.5}, {.evaluations = 240}));
  EXPECT_EQ(evaluations, 240);
}

// Near the one corner each wants something else: all on the line between is as good as any.
TEST(Optimiser, CoversTheFrontOfConflictingObjectives) {
  std::vector<std::vector<double>> values;
  const auto objectives = [&](const std::vector<double>& x) {
    const double beside = std::pow(x[1] - 0.3, 2.0);
    values.push_back({x[0] * x[0] + beside, std::pow(x[0] - 1.0, 2.0) + beside});
    return values.back();
  };
  minimise_each(objectives, 2, {0.5, 0.9}, {.evaluations = 1200, .population = 22});
  EXPECT_EQ(values.size(), 1200u / 24 * 24);
  EXPECT_DOUBLE_EQ(values.front()[0], 0.25 + 0.36);
  const auto front = non_dominated(values);
  double least = 1.0;
  double most = 0.0;
  for (const std::size_t i : front) {
    EXPECT_NEAR(std::sqrt(values[i][0]) + std::sqrt(values[i][1]), 1.0, 0.05);
    least = std::min(least, values[i][0]);
    most = std::max(most, values[i][0]);
  }
  EXPECT_LT(least, 0.02);
  EXPECT_GT(most, 0.9);
}

TEST(NonDominated, AreThoseThatNoOtherDominates) {
  EXPECT_EQ(non_dominated({{1, 5}, {2, 2}, {3, 3}, {5, 1}, {2, 6}}), (std::vector<std::size_t>{0, 1, 3}));
  EXPECT_EQ(non_dominated({{1, 5}}), std::vector<std::size_t>{0});
  EXPECT_TRUE(non_dominated({}).empty());
}

}  // namespace
}  // namespace koboshi::lab
