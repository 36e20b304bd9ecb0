#include "lab/policy_search/ppo.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "sim_board/random/random_stream.h"
#include "tools/policy/mlp.h"

namespace koboshi::lab {
namespace {

using ::testing::DoubleNear;
using ::testing::ElementsAre;

TEST(Advantages, AreSumsOfWhatTheCriticDidNotExpect) {
  const Path lost{.inputs = {}, .noise = {}, .rewards = {1.0, 0.0, -1.0}, .lost = true};
  const std::vector<double> values{0.5, 0.25, -0.5};
  // From the end: -1 - (-0.5); 0 + 0.5 (-0.5) - 0.25; 1 + 0.5 * 0.25 - 0.5, each with 0.5 * 0.8 of the next.
  const double last = -0.5;
  const double middle = -0.5 + 0.4 * last;
  const double first = 0.625 + 0.4 * middle;
  EXPECT_THAT(advantages(lost, values, 0.5, 0.8),
              ElementsAre(DoubleNear(first, 1e-15), DoubleNear(middle, 1e-15), DoubleNear(last, 1e-15)));
}

TEST(Advantages, OfAWalkThatWentOnEndWithTheCriticsValue) {
  const Path walked{.inputs = {}, .noise = {}, .rewards = {1.0, 100.0}, .lost = false};
  EXPECT_THAT(advantages(walked, std::vector{0.0, 4.0}, 0.5, 0.8), ElementsAre(3.0));
  EXPECT_THROW(static_cast<void>(advantages(walked, std::vector{0.0}, 0.5, 0.8)), std::logic_error);
}

TEST(LearnableSteps, AreThoseWithAnAdvantage) {
  EXPECT_EQ(Path().learnable_steps(), 0u);
  EXPECT_EQ((Path{.inputs = {}, .noise = {}, .rewards = {}, .lost = true}.learnable_steps()), 0u);
  EXPECT_EQ((Path{.inputs = {}, .noise = {}, .rewards = {1.0}, .lost = true}.learnable_steps()), 1u);
  EXPECT_EQ((Path{.inputs = {}, .noise = {}, .rewards = {1.0}, .lost = false}.learnable_steps()), 0u);
}

// A toy: the state is a random number, and the reward of a step falls with the distance of the action from
// half of it. Both halves of the network are mirror images.
class Toy : public testing::Test {
 protected:
  static PpoOptions options() {
    PpoOptions options;
    options.learning_rate = 0.003;
    options.discount = 0.0;
    options.critic = {8};
    options.minibatch = 64;
    return options;
  }
  Ppo ppo() const { return ppo(options()); }
  Ppo ppo(const PpoOptions& options) const {
    const MirrorImage pair{.place = {1, 0}, .sign = {1.0, 1.0}};
    return {options, MirroredNetwork(pair, {}, pair, true), 2, pair};
  }
  std::vector<double> outputs(const SearchState& state, double left, double right) const {
    const MirrorImage pair{.place = {1, 0}, .sign = {1.0, 1.0}};
    const MirroredNetwork network(pair, {}, pair, true);
    return network.network(std::span(state.mean).first(network.parameters())).run(std::vector{left, right});
  }
  std::vector<Path> play(const Ppo& ppo, const SearchState& state, std::uint64_t seed) const {
    sim_board::RandomStream random(seed, "toy");
    const std::vector<double> deviations = ppo.deviations(state);
    std::vector<Path> paths(8);
    for (Path& path : paths) {
      path.lost = true;
      for (int step = 0; step < 40; ++step) {
        const std::vector<double> seen{random.within(1.0), random.within(1.0)};
        const std::vector<double> means = outputs(state, seen[0], seen[1]);
        double reward = 0.0;
        for (std::size_t i = 0; i < 2; ++i) {
          path.inputs.push_back(seen[i]);
          path.noise.push_back(random.normal());
          const double action = means[i] + deviations[i] * path.noise.back();
          reward -= std::pow(action - 0.5 * seen[i], 2);
        }
        path.rewards.push_back(reward);
      }
    }
    return paths;
  }
};

TEST_F(Toy, LearnsTheActionThatPays) {
  const Ppo ppo = this->ppo();
  SearchState state = SearchState::at(ppo.start());
  EXPECT_THAT(outputs(state, 0.8, -0.4), ElementsAre(0.0, 0.0)) << "begins with no offset";
  for (std::uint64_t generation = 0; generation < 120; ++generation)
    static_cast<void>(ppo.improve(state, play(ppo, state, generation)));
  EXPECT_THAT(outputs(state, 0.8, -0.4), ElementsAre(DoubleNear(0.4, 0.05), DoubleNear(-0.2, 0.05)));
  EXPECT_EQ(state.generation, 120u);
  EXPECT_LT(ppo.deviations(state)[0], 0.15) << "it explores less and less";
  EXPECT_EQ(ppo.deviations(state)[0], ppo.deviations(state)[1]) << "mirror images";
}

TEST_F(Toy, GivesTheSameBitsAgain) {
  const Ppo ppo = this->ppo();
  SearchState one = SearchState::at(ppo.start());
  SearchState other = one;
  const PpoProgress progress = ppo.improve(one, play(ppo, one, 1));
  static_cast<void>(ppo.improve(other, play(ppo, other, 1)));
  EXPECT_EQ(one.mean, other.mean);
  EXPECT_GT(progress.divergence, 0.0);
  EXPECT_GT(progress.value_error, 0.0);
}

// With a huge step size the first epoch moves the policy too far for a second one.
TEST_F(Toy, EndsAGenerationThatHasMovedTooFar) {
  PpoOptions fast = options();
  fast.learning_rate = 0.3;
  const Ppo ppo = this->ppo(fast);
  SearchState state = SearchState::at(ppo.start());
  const PpoProgress progress = ppo.improve(state, play(ppo, state, 1));
  EXPECT_EQ(progress.epochs, 1u);
  EXPECT_GT(progress.clipped, 0.1);
  for (const double deviation : ppo.deviations(state)) {
    EXPECT_GE(deviation, 0.02);
    EXPECT_LE(deviation, 0.5);
  }
}

TEST_F(Toy, NeedsACycle) {
  const Ppo ppo = this->ppo();
  SearchState state = SearchState::at(ppo.start());
  EXPECT_THROW(static_cast<void>(ppo.improve(state, std::vector<Path>(2))), std::logic_error);
}

}  // namespace
}  // namespace koboshi::lab
