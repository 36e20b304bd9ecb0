#include "sim_board/drive/position_demand.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace koboshi::sim_board {
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

TEST(PositionDemand, ContinuesSmoothlyWhenTheNextTargetIsEarly) {
  PositionDemand demand;
  demand.hold(0);
  demand.approach(1'000, 0, kCycle_us);
  demand.approach(2'000, 9'000, kCycle_us);  // SYNC jitters by a tenth of a cycle
  EXPECT_EQ(demand.at(9'000), 900);
  EXPECT_EQ(demand.at(19'000), 2'000);
}

TEST(PositionDemand, NeverJumpsForAnyTargets) {
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

constexpr CyclicLimits kStreamLimits{.step_units = 5'000.0,
                                     .motion = {.velocity_units_per_s = 400e3,
                                                .acceleration_units_per_s2 = 10e6,
                                                .deceleration_units_per_s2 = 10e6},
                                     .jump = {.velocity_units_per_s = 50e3,
                                              .acceleration_units_per_s2 = 200e3,
                                              .deceleration_units_per_s2 = 400e3}};

TEST(PositionDemand, FollowsAStreamWithinItsLimitsByInterpolationAlone) {
  PositionDemand limited;
  PositionDemand interpolated;
  for (std::uint64_t cycle = 0; cycle < 200; ++cycle) {
    const double angle = 0.1 * static_cast<double>(cycle);
    const auto target = static_cast<std::int32_t>(std::lround(20'000.0 * (1.0 - std::cos(angle))));
    const std::uint64_t now_us = cycle * kCycle_us + cycle * 37 % 50;  // SYNC jitters
    EXPECT_TRUE(limited.follow(target, now_us, kCycle_us, kStreamLimits));
    interpolated.approach(target, now_us, kCycle_us);
    for (std::uint64_t t_us = 0; t_us < kCycle_us; t_us += 1'000)
      ASSERT_EQ(limited.at(now_us + t_us), interpolated.at(now_us + t_us));
  }
}

// The same target, again and again: too fast, too far, and too far for the first of a stream.
TEST(PositionDemand, MovesToAnUnreachableTargetOnOneProfile) {
  struct Way {
    bool joined;
    std::int32_t target;
    ProfileLimits limits;
  };
  for (const Way& way : {Way{true, 4'500, kStreamLimits.motion}, Way{true, 40'000, kStreamLimits.jump},
                         Way{false, 600, kStreamLimits.jump}}) {
    SCOPED_TRACE(way.target);
    PositionDemand demand;
    demand.hold(0);
    EXPECT_EQ(way.joined && demand.follow(0, 0, kCycle_us, kStreamLimits), way.joined);
    PositionDemand planned;
    planned.hold(0);
    planned.move(way.target, 0, way.limits, {});
    std::uint64_t now_us = 0;
    for (; !planned.stands(now_us); now_us += kCycle_us) {
      EXPECT_FALSE(demand.follow(way.target, now_us, kCycle_us, kStreamLimits));
      ASSERT_EQ(demand.at(now_us + 3'000), planned.at(now_us + 3'000));
    }
    EXPECT_TRUE(demand.follow(way.target, now_us, kCycle_us, kStreamLimits));
    EXPECT_EQ(demand.at(now_us), way.target);
  }
}

// From rest to 130,000 units/s within one cycle, where 100,000 are allowed.
TEST(PositionDemand, CatchesUpWithAStreamThatStartsTooFast) {
  PositionDemand demand;
  demand.hold(0);
  std::int32_t target = 0;
  std::uint64_t now_us = 0;
  EXPECT_TRUE(demand.follow(target, now_us, kCycle_us, kStreamLimits));
  int limited = 0;
  for (int cycle = 0; cycle < 40; ++cycle) {
    now_us += kCycle_us;
    if (!demand.follow(target += 1'300, now_us, kCycle_us, kStreamLimits)) limited = cycle + 1;
  }
  EXPECT_GE(limited, 1);
  EXPECT_LE(limited, 12);
  EXPECT_EQ(demand.at(now_us), target - 1'300);  // on its way to the last one
}

TEST(PositionDemand, EndsAtTheLastTargetOfAStreamAtAnySpeed) {
  PositionDemand demand;
  demand.hold(0);
  std::int32_t target = 0;
  std::uint64_t now_us = 0;
  for (int cycle = 0; cycle < 10; ++cycle, now_us += kCycle_us)
    EXPECT_TRUE(demand.follow(target += std::min(900 * cycle, 3'600), now_us, kCycle_us, kStreamLimits));
  for (std::uint64_t end_us = now_us + 50'000; now_us < end_us; now_us += 1'000) {
    if (now_us % kCycle_us == 0) {
      EXPECT_TRUE(demand.follow(target, now_us, kCycle_us, kStreamLimits));
    }
    EXPECT_EQ(demand.at(now_us), target);
  }
}

// Whatever the targets: no faster than the limit, and no more speed gained from one cycle to the next.
TEST(PositionDemand, KeepsItsLimitsForAnyTargets) {
  constexpr unsigned kSeed = 607;
  SCOPED_TRACE(kSeed);
  std::mt19937 random(kSeed);
  std::uniform_int_distribution<std::int32_t> any(-60'000, 60'000);
  std::uniform_int_distribution<std::int32_t> near(-4'500, 4'500);
  PositionDemand demand;
  demand.hold(0);
  double before = 0.0;
  double speed_before = 0.0;
  for (std::uint64_t cycle = 0; cycle < 5'000; ++cycle) {
    const std::uint64_t now_us = cycle * kCycle_us;
    const std::int32_t present = demand.at(now_us);
    demand.follow(random() % 8 == 0 ? any(random) : present + near(random), now_us, kCycle_us, kStreamLimits);
    for (std::uint64_t t_us = 1'000; t_us <= kCycle_us; t_us += 1'000) {
      const double now = demand.at(now_us + t_us);
      ASSERT_LE(std::abs(now - before), 401.0);
      before = now;
    }
    const double speed = 100.0 * (demand.at(now_us + kCycle_us) - present);
    // 100,000 units/s a cycle; on a profile the mean is half of that behind the speed at the cycle's end.
    ASSERT_LE(std::abs(speed) - std::abs(speed_before), 150e3 + 200.0);
    speed_before = speed;
  }
}

TEST(PositionDemand, IsAtRestOnlyWhenTheNextTargetOfAStreamIsOverdue) {
  PositionDemand demand;
  demand.hold(0);
  demand.approach(1'000, 0, kCycle_us);
  EXPECT_TRUE(demand.stands(10'000));
  EXPECT_FALSE(demand.at_rest(10'000));
  EXPECT_FALSE(demand.at_rest(19'999));
  EXPECT_TRUE(demand.at_rest(20'000));
  demand.approach(1'000, 20'000, kCycle_us);
  EXPECT_TRUE(demand.at_rest(20'000));
}

// From 200,000 units/s with 4,000,000 units/s^2: 50 ms and 5,000 units.
TEST(PositionDemand, StopsWithAConstantDeceleration) {
  for (const int direction : {1, -1}) {
    PositionDemand demand;
    demand.hold(0);
    demand.approach(direction * 2'000, 0, kCycle_us);
    demand.stop(5'000, 4e6, {});
    EXPECT_NEAR(demand.speed_units_per_s(5'000), direction * 200'000, 1e-6);
    EXPECT_NEAR(demand.speed_units_per_s(30'000), direction * 100'000, 1e-6);
    EXPECT_EQ(demand.at(30'000), direction * (1'000 + 3'750));
    EXPECT_FALSE(demand.stands(54'999));
    EXPECT_TRUE(demand.stands(55'000));
    EXPECT_EQ(demand.at(55'000), direction * 6'000);
    EXPECT_EQ(demand.at(90'000), direction * 6'000);
  }
}

TEST(PositionDemand, StopsAtOnceAtRest) {
  PositionDemand demand;
  demand.hold(123);
  demand.stop(7'000, 4e6, {});
  EXPECT_TRUE(demand.stands(7'000));
  EXPECT_EQ(demand.at(7'000), 123);
}

// From 200,000 units/s: 1,000 units are left, or all of them.
TEST(PositionDemand, SteepensARampThatIsTooFlat) {
  for (const int direction : {1, -1}) {
    for (const bool limited : {true, false}) {
      PositionDemand demand;
      demand.hold(0);
      demand.approach(direction * 2'000, 0, kCycle_us);
      const PositionRange range = limited ? PositionRange{-2'000.0, 2'000.0} : PositionRange{};
      demand.stop(5'000, 1'000.0, range);
      EXPECT_TRUE(demand.steepened(6'000));
      const std::uint64_t end_us = 5'000 + (limited ? 10'000 : PositionDemand::kMaxStopDuration_us);
      EXPECT_FALSE(demand.stands(end_us - 10));
      EXPECT_TRUE(demand.stands(end_us + 10));
      EXPECT_FALSE(demand.steepened(end_us + 10));
      EXPECT_EQ(demand.at(end_us + 10), direction * (limited ? 2'000 : 81'000));
    }
  }
}

// From 200,000 units/s, of which the shaft can have 100,000: 100 ms and 5,000 units.
TEST(PositionDemand, StopsFromTheHighestSpeedOfItsShaft) {
  PositionDemand demand;
  demand.hold(0);
  demand.approach(-2'000, 0, kCycle_us);
  demand.stop(5'000, 1e6, {}, 100e3);
  EXPECT_TRUE(demand.stands(105'000));
  EXPECT_EQ(demand.at(105'000), -6'000);
}

TEST(PositionDemand, StandsWhereItIsBeyondItsRange) {
  PositionDemand demand;
  demand.hold(5'000);
  demand.approach(6'000, 0, kCycle_us);
  demand.stop(5'000, 1'000.0, {-2'000.0, 2'000.0});
  EXPECT_EQ(demand.at(6'000), 5'500);
}

TEST(PositionDemand, HasOneTimeForSeveralStopsInARow) {
  PositionDemand demand;
  demand.hold(0);
  demand.approach(2'000, 0, kCycle_us);
  for (const std::uint64_t now_us : {5'000u, 300'000u, 600'000u, 804'999u}) demand.stop(now_us, 1'000.0, {});
  EXPECT_TRUE(demand.stands(5'010 + PositionDemand::kMaxStopDuration_us));
}

// Back to where it came from, out of full motion and with a deceleration that is far too small.
TEST(PositionDemand, TurnsBackWithinItsRange) {
  PositionDemand demand;
  demand.hold(0);
  demand.approach(2'000, 0, kCycle_us);
  const ProfileLimits flat{
      .velocity_units_per_s = 50e3, .acceleration_units_per_s2 = 1e3, .deceleration_units_per_s2 = 1e3};
  demand.move(0, 5'000, flat, {-2'000.0, 2'500.0});
  EXPECT_TRUE(demand.steepened(6'000));
  std::int32_t furthest = 0;
  for (std::uint64_t now_us = 5'000; !demand.stands(now_us); now_us += 1'000)
    furthest = std::max(furthest, demand.at(now_us));
  EXPECT_LE(furthest, 2'500);
  EXPECT_GE(furthest, 2'490);
}

}  // namespace
}  // namespace koboshi::sim_board
