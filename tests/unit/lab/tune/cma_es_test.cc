#include "lab/tune/cma_es.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <limits>
#include <random>
#include <stdexcept>

#include "lab/tune/optimiser.h"

namespace koboshi::lab {
namespace {

using Loss = std::function<double(const std::vector<double>&)>;

// Standard functions of 8 dimensions, of which the unit box is -5 .. 5.
double at(double u) { return 10.0 * u - 5.0; }
double sphere(const std::vector<double>& x) {
  double sum = 0.0;
  for (const double u : x) sum += at(u) * at(u);
  return sum;
}
double ellipsoid(const std::vector<double>& x) {
  double sum = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i)
    sum += std::pow(1e6, static_cast<double>(i) / static_cast<double>(x.size() - 1)) * at(x[i]) * at(x[i]);
  return sum;
}
double rosenbrock(const std::vector<double>& x) {
  double sum = 0.0;
  for (std::size_t i = 0; i + 1 < x.size(); ++i) {
    const double bend = at(x[i + 1]) - at(x[i]) * at(x[i]);
    sum += 100.0 * bend * bend + (at(x[i]) - 1.0) * (at(x[i]) - 1.0);
  }
  return sum;
}

const std::vector<double> kCmaStart(8, 0.7);
constexpr double kTarget = 1e-8;
constexpr std::size_t kMaxEvaluations = 40'000;
constexpr std::size_t kCmaPopulation = 10;  // 4 + 3 log(8)

// The number of evaluations after which the target is reached; infinity if it is not.
double ours(const Loss& loss, std::uint32_t seed) {
  CmaEs strategy(kCmaStart, {.population = kCmaPopulation, .spread = 0.2, .seed = seed});
  double count = 0.0;
  while (count < static_cast<double>(kMaxEvaluations)) {
    const auto candidates = strategy.ask();
    for (std::size_t i = 0; i < candidates.size(); ++i) {
      const double value = loss(candidates[i]);
      ++count;
      if (value < kTarget) return count;
      strategy.tell(i, value);
    }
  }
  return std::numeric_limits<double>::infinity();
}

struct Reached : std::runtime_error {
  Reached() : std::runtime_error("the target") {}
};

double pagmos(const Loss& loss, std::uint32_t seed) {
  double count = 0.0;
  try {
    static_cast<void>(minimise(
        [&](const std::vector<double>& x) {
          ++count;
          const double value = loss(x);
          if (value < kTarget) throw Reached();
          return value;
        },
        kCmaStart,
        {.evaluations = kMaxEvaluations, .population = kCmaPopulation, .spread = 0.2, .seed = seed}));
  } catch (const Reached&) {
    return count;
  }
  return std::numeric_limits<double>::infinity();
}

using CmaSearch = double(const Loss&, std::uint32_t);

double median_of_seven(CmaSearch* search, const Loss& loss) {
  std::vector<double> counts;
  for (std::uint32_t seed = 1; seed <= 7; ++seed) counts.push_back(search(loss, seed));
  std::ranges::sort(counts);
  return counts[3];
}

// Both are the same strategy with the same weights and rates, but draw other numbers: seven seeds of
// either differed by 12 % at most (sphere 0.93, ellipsoid 0.97, Rosenbrock 1.12 times as many, 28 November
// 2026). More is another algorithm, less as well.
void expect_the_evaluations_of_pagmo(const Loss& loss) {
  const double expected = median_of_seven(pagmos, loss);
  ASSERT_LT(expected, static_cast<double>(kMaxEvaluations));
  const double found = median_of_seven(ours, loss);
  std::printf("evaluations to the target: ours %.0f, pagmo's %.0f\n", found, expected);
  EXPECT_LT(found, 1.25 * expected);
  EXPECT_GT(found, 0.75 * expected);
}

TEST(CmaEs, NeedsAsManyEvaluationsAsPagmoOnTheSphere) { expect_the_evaluations_of_pagmo(sphere); }
TEST(CmaEs, NeedsAsManyEvaluationsAsPagmoOnTheEllipsoid) { expect_the_evaluations_of_pagmo(ellipsoid); }
TEST(CmaEs, NeedsAsManyEvaluationsAsPagmoOnRosenbrocksValley) { expect_the_evaluations_of_pagmo(rosenbrock); }

TEST(CmaEs, LearnsTheSameFromLossesInAnyOrder) {
  CmaEs in_order({0.3, 0.6, 0.5}, {});
  CmaEs shuffled({0.3, 0.6, 0.5}, {});
  std::mt19937 random(1);
  for (std::size_t generation = 0; generation < 30; ++generation) {
    const auto candidates = in_order.ask();
    ASSERT_EQ(candidates, shuffled.ask());
    ASSERT_EQ(shuffled.generation(), generation);
    std::vector<std::size_t> order;
    for (std::size_t i = 0; i < candidates.size(); ++i) {
      in_order.tell(i, sphere(candidates[i]));
      order.push_back(i);
    }
    std::ranges::shuffle(order, random);
    // A loss that is told twice is the second one, if the generation is not complete.
    EXPECT_FALSE(shuffled.tell(order.front(), -1e9));
    for (std::size_t i = 0; i < order.size(); ++i)
      EXPECT_EQ(shuffled.tell(order[i], sphere(candidates[order[i]])), i + 1 == order.size());
  }
}

TEST(CmaEs, BeginsWithTheStartAndStaysInTheBox) {
  const std::vector<double> start{0.02, 0.98};
  CmaEs strategy(start, {.population = 12, .spread = 0.3});
  EXPECT_EQ(strategy.ask().front(), start);
  EXPECT_EQ(strategy.best(), start);
  for (int generation = 0; generation < 60; ++generation) {
    const auto candidates = strategy.ask();
    ASSERT_EQ(candidates.size(), 12u);
    for (std::size_t i = 0; i < candidates.size(); ++i) {
      for (const double value : candidates[i]) {
        EXPECT_GE(value, 0.0);
        EXPECT_LE(value, 1.0);
      }
      strategy.tell(i, candidates[i][0] - candidates[i][1]);
    }
  }
  // The least is in the corner.
  EXPECT_EQ(strategy.best(), (std::vector<double>{0.0, 1.0}));
}

TEST(CmaEs, GoesOnOnFlatGroundAndAfterLossesThatAreNoNumbers) {
  CmaEs strategy({0.5, 0.5, 0.5}, {});
  for (int generation = 0; generation < 200; ++generation) {
    for (std::size_t i = 0; i < 8; ++i) strategy.tell(i, i % 2 == 0 ? 1.0 : std::nan(""));
    for (const auto& candidate : strategy.ask()) {
      for (const double value : candidate) ASSERT_TRUE(std::isfinite(value));
    }
  }
  EXPECT_EQ(strategy.best_loss(), 1.0);
}

TEST(CmaEs, SearchesOnFromWhereItMigrates) {
  CmaEs strategy({0.1, 0.1}, {.spread = 0.01});
  for (std::size_t i = 0; i < 8; ++i) strategy.tell(i, sphere(strategy.ask()[i]));
  strategy.move_to({0.9, 0.9});
  for (const auto& candidate : strategy.ask()) {
    for (const double value : candidate) EXPECT_GT(value, 0.7);
  }
}

TEST(Migration, BringsTheBestOfTheIslandBeforeIfItIsBetter) {
  std::vector<CmaEs> islands;
  const std::vector<double> starts{0.2, 0.5, 0.9};  // the second is the best
  for (const double start : starts)
    islands.emplace_back(std::vector<double>{start, start}, CmaEsOptions{.spread = 0.01});
  for (CmaEs& island : islands) {
    const auto candidates = island.ask();
    for (std::size_t i = 0; i < candidates.size(); ++i) island.tell(i, sphere(candidates[i]));
  }
  const auto of_the_first = islands[0].ask();
  migrate(islands);
  EXPECT_EQ(islands[0].ask(), of_the_first) << "the last one, before it in the ring, is no better";
  for (std::size_t island : {1u, 2u}) {
    for (const double value : islands[island].ask().front()) EXPECT_NEAR(value, 0.5, 0.1);
  }
}

}  // namespace
}  // namespace koboshi::lab
