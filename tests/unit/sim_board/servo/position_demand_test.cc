#include "sim_board/servo/position_demand.h"

#include <gtest/gtest.h>

#include <cmath>

namespace koboshi::sim {
namespace {

constexpr std::uint32_t kCycle_us = 10'000;

TEST(PositionDemand, ApproachesATargetLinearlyOverOneCycle) {
  PositionDemand demand;
  demand.hold(1'000);
  demand.approach(2'000, 50'000, kCycle_us);
  EXPECT_EQ(demand.at(50'000), 1'000);
  EXPECT_EQ(demand.at(51'000), 1'100);
  EXPECT_EQ(demand.at(55'000), 1'500);
  EXPECT_EQ(demand.at(60'000), 2'000);
  EXPECT_EQ(demand.at(90'000), 2'000);  // no further target: it stands
  EXPECT_EQ(demand.speed_units_per_s(55'000), 100'000);
  EXPECT_EQ(demand.speed_units_per_s(60'000), 0);
}

TEST(PositionDemand, GoesOnSmoothlyWhenTheNextTargetIsEarly) {
  PositionDemand demand;
  demand.hold(0);
  demand.approach(1'000, 0, kCycle_us);
  demand.approach(2'000, 9'000, kCycle_us);  // SYNC jitters by a tenth of a cycle
  EXPECT_EQ(demand.at(9'000), 900);
  EXPECT_EQ(demand.at(19'000), 2'000);
}

TEST(PositionDemand, NeverJumpsWhateverTheTargets) {
  PositionDemand demand;
  demand.hold(0);
  std::int32_t before = 0;
  for (std::uint64_t cycle = 0; cycle < 50; ++cycle) {
    demand.approach(cycle % 2 == 0 ? 10'000 : -10'000, cycle * kCycle_us, kCycle_us);
    for (std::uint64_t t_us = 0; t_us < kCycle_us; t_us += 1'000) {
      const std::int32_t now = demand.at(cycle * kCycle_us + t_us);
      EXPECT_LE(std::abs(now - before), 2'001);  // 20,000 units in ten loops
      before = now;
    }
  }
}

// From 200,000 units/s with 4,000,000 units/s^2: 50 ms and 5,000 units.
TEST(PositionDemand, StopsWithAConstantDeceleration) {
  for (const int direction : {1, -1}) {
    PositionDemand demand;
    demand.hold(0);
    demand.approach(direction * 2'000, 0, kCycle_us);
    demand.stop(5'000, 4e6);
    EXPECT_NEAR(demand.speed_units_per_s(5'000), direction * 200'000, 1e-6);
    EXPECT_NEAR(demand.speed_units_per_s(30'000), direction * 100'000, 1e-6);
    EXPECT_EQ(demand.at(30'000), direction * (1'000 + 3'750));
    EXPECT_FALSE(demand.stands(54'999));
    EXPECT_TRUE(demand.stands(55'000));
    EXPECT_EQ(demand.at(55'000), direction * 6'000);
    EXPECT_EQ(demand.at(90'000), direction * 6'000);
  }
}

TEST(PositionDemand, StandsAtOnceWhenStoppedAtRest) {
  PositionDemand demand;
  demand.hold(123);
  demand.stop(7'000, 4e6);
  EXPECT_TRUE(demand.stands(7'000));
  EXPECT_EQ(demand.at(7'000), 123);
}

}  // namespace
}  // namespace koboshi::sim
