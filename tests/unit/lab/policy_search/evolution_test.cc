#include "lab/policy_search/evolution.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace koboshi::lab {
namespace {

using ::testing::ElementsAre;

const std::vector<double> kOptimum{0.5, -1.0, 2.0, 0.0, -0.3};

// The highest value, 0, is at the optimum.
double score_of(const std::vector<double>& x) {
  double sum = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) sum -= std::pow(x[i] - kOptimum[i], 2);
  return sum;
}

void evolve(Evolution& evolution, int generations) {
  for (int i = 0; i < generations; ++i) {
    std::vector<double> scores;
    for (const std::vector<double>& candidate : evolution.ask()) scores.push_back(score_of(candidate));
    evolution.tell(scores);
  }
}

const EvolutionOptions kToy{.population = 16, .noise = 0.1, .learning_rate = 0.05, .seed = 3};

TEST(Evolution, ApproachesTheOptimum) {
  Evolution evolution(kToy, SearchState::at(std::vector<double>(kOptimum.size(), 0.0)));
  const double before = score_of(evolution.state().mean);
  evolve(evolution, 150);
  EXPECT_GT(score_of(evolution.state().mean), 0.02 * before);
  EXPECT_EQ(evolution.state().generation, 150u);
}

TEST(Evolution, AsksForOppositePairsAboutTheMean) {
  const Evolution evolution(kToy, SearchState::at(kOptimum));
  const auto candidates = evolution.ask();
  ASSERT_EQ(candidates.size(), 16u);
  EXPECT_NE(candidates[0], candidates[2]);
  for (std::size_t pair = 0; pair < candidates.size(); pair += 2) {
    for (std::size_t i = 0; i < kOptimum.size(); ++i)
      EXPECT_NEAR(0.5 * (candidates[pair][i] + candidates[pair + 1][i]), kOptimum[i], 1e-12);
  }
  EXPECT_EQ(evolution.ask(), candidates) << "asking changes nothing";
}

TEST(Evolution, ContinuesFromAStateWithTheSameBits) {
  Evolution undisturbed(kToy, SearchState::at(kOptimum));
  evolve(undisturbed, 7);
  Evolution first(kToy, SearchState::at(kOptimum));
  evolve(first, 3);
  Evolution second(kToy, first.state());
  evolve(second, 4);
  EXPECT_EQ(second.state().mean, undisturbed.state().mean);
  EXPECT_EQ(second.state().second_moment, undisturbed.state().second_moment);
  EXPECT_EQ(second.ask(), undisturbed.ask());
}

TEST(Evolution, StaysWhereAllCandidatesAreEqual) {
  Evolution evolution(kToy, SearchState::at(kOptimum));
  evolution.tell(std::vector<double>(kToy.population, 0.7));
  EXPECT_EQ(evolution.state().mean, kOptimum);
}

TEST(Evolution, RemovesAShareOfTheWeights) {
  EvolutionOptions options = kToy;
  options.weight_decay = 0.25;
  Evolution evolution(options, SearchState::at({1.0, -2.0}));
  evolution.tell(std::vector<double>(kToy.population, 0.0));
  EXPECT_THAT(evolution.state().mean, ElementsAre(0.75, -1.5));
}

TEST(CentredRanks, ShareThePlacesOfEqualScores) {
  EXPECT_THAT(centred_ranks(std::vector{3.0, -1.0, 5.0}), ElementsAre(0.0, -0.5, 0.5));
  EXPECT_THAT(centred_ranks(std::vector{2.0, 2.0, 7.0, 1.0, 2.0}), ElementsAre(0.0, 0.0, 0.5, -0.5, 0.0));
  EXPECT_THAT(centred_ranks(std::vector{2.0}), ElementsAre(0.0));
}

}  // namespace
}  // namespace koboshi::lab
