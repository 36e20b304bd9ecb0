#include "lab/learn/explorer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "firmware/fixed/host/convert.h"

namespace koboshi::lab {
namespace {

using ::testing::DoubleNear;
using ::testing::ElementsAre;

class ExplorerOfTwoOutputs : public testing::Test {
 protected:
  ExplorerOfTwoOutputs() {
    map_.inputs = {{.name = "pitch",
                    .signal = 1,
                    .unit = 0.5,
                    .scale = 10.0,
                    .range = {{-1.0, 1.0}},
                    .column = "pitch"}};
    map_.outputs = {{.joint = "a", .scale_rad = 0.1, .bound_rad = 0.1},
                    {.joint = "b", .scale_rad = 0.05, .bound_rad = 0.05}};
    reward_.lean = 2.0;
  }
  Explorer explorer(std::uint64_t seed = 1, std::size_t held_cycles = 1) const {
    return {map_, kDeviations, held_cycles, reward_, 8.0, seed};
  }

  static inline const std::vector<double> kDeviations{0.2, 0.4};
  tools::PolicyMap map_;
  RewardWeights reward_;
  policy::Signals::Values signals_{};
};

TEST_F(ExplorerOfTwoOutputs, RecordsTheNoiseThatItPlayed) {
  Explorer explorer = this->explorer();
  static_cast<void>(explorer.deviations());
  const auto played = explorer.deviations();
  explorer.cycle(signals_);
  explorer.earned({});
  const Path path = explorer.finish(false);
  ASSERT_EQ(path.noise.size(), 2u);
  EXPECT_NEAR(fixed::to_double(played[0]), 0.2 * 0.1 * path.noise[0], 1e-8);
  EXPECT_NEAR(fixed::to_double(played[1]), 0.4 * 0.05 * path.noise[1], 1e-8);
  EXPECT_EQ(played[2], fixed::Angle());
}

TEST_F(ExplorerOfTwoOutputs, DrawsStandardNormalNoiseByTheSeed) {
  Explorer explorer = this->explorer();
  Explorer same = this->explorer();
  Explorer other = this->explorer(2);
  double sum = 0.0;
  double squares = 0.0;
  constexpr int kDraws = 4'000;
  EXPECT_EQ(explorer.deviations(), same.deviations());
  EXPECT_NE(explorer.deviations(), other.deviations());
  for (int i = 0; i < kDraws; ++i) {
    const double drawn = fixed::to_double(explorer.deviations()[0]) / 0.02;
    sum += drawn;
    squares += drawn * drawn;
  }
  EXPECT_NEAR(sum / kDraws, 0.0, 0.05);
  EXPECT_NEAR(squares / kDraws, 1.0, 0.1);
}

TEST_F(ExplorerOfTwoOutputs, RecordsTheInputsOfTheNetworkWithinTheirRange) {
  Explorer explorer = this->explorer();
  for (const std::int32_t pitch : {1, -3}) {
    signals_[1] = pitch;
    static_cast<void>(explorer.deviations());
    explorer.cycle(signals_);
    explorer.earned({});
  }
  EXPECT_THAT(explorer.finish(false).inputs, ElementsAre(5.0, -10.0));
}

TEST_F(ExplorerOfTwoOutputs, HoldsTheNoiseAndSumsWhatItEarned) {
  Explorer explorer = this->explorer(1, 3);
  std::vector<fixed::Angle> played;
  for (int cycle = 0; cycle < 7; ++cycle) {
    played.push_back(explorer.deviations()[0]);
    signals_[1] = cycle == 3 ? 1 : 0;
    explorer.cycle(signals_);
    explorer.earned({.walk_s = 0.08});
  }
  EXPECT_EQ(played[0], played[2]);
  EXPECT_NE(played[2], played[3]);
  EXPECT_EQ(played[3], played[5]);
  const Path path = explorer.finish(false);
  EXPECT_THAT(path.rewards,
              ElementsAre(DoubleNear(0.03, 1e-12), DoubleNear(0.03, 1e-12), DoubleNear(0.01, 1e-12)));
  EXPECT_THAT(path.inputs, ElementsAre(0.0, 5.0, 0.0));
  EXPECT_EQ(path.noise.size(), 6u);
}

// A walk that begins while noise is held waits for the next one: the path says what was seen with each noise.
TEST_F(ExplorerOfTwoOutputs, BeginsWithNewNoise) {
  Explorer explorer = this->explorer(1, 3);
  static_cast<void>(explorer.deviations());
  for (int cycle = 0; cycle < 3; ++cycle) {
    static_cast<void>(explorer.deviations());
    explorer.cycle(signals_);
    explorer.earned({.walk_s = 0.08});
  }
  EXPECT_THAT(explorer.finish(false).rewards, ElementsAre(DoubleNear(0.01, 1e-12)));
}

TEST_F(ExplorerOfTwoOutputs, ChargesALossToTheLastCycle) {
  Explorer explorer = this->explorer();
  for (int cycle = 0; cycle < 2; ++cycle) {
    static_cast<void>(explorer.deviations());
    explorer.cycle(signals_);
    explorer.earned({.walk_s = 0.8, .lean_rad2_s = 0.04});
  }
  const Path path = explorer.finish(true);
  EXPECT_TRUE(path.lost);
  EXPECT_THAT(path.rewards, ElementsAre(DoubleNear(0.09, 1e-12), DoubleNear(0.09 - 1.0, 1e-12)));
}

}  // namespace
}  // namespace koboshi::lab
