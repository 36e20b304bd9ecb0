// Walks that must have the same bits everywhere (tests/unit/firmware/fixed/digest.h).

#include <gtest/gtest.h>

#include <cstdint>
#include <random>

#include "tests/support/tuned_gait.h"
#include "tests/unit/firmware/fixed/digest.h"
#include "tests/unit/firmware/walk/walking_robot.h"

namespace koboshi::walk {
namespace {

// Walks in all directions, with a trunk that the ground disturbs, and stops.
std::uint64_t walk_digest(const WalkParameters& parameters, std::uint32_t seed) {
  constexpr Velocity kCommands[] = {{},         {150, 0, 0}, {-80, 20, 0}, {0, -60, 400}, {100, 40, -700},
                                    {300, 0, 0}};
  constexpr int kCycles = 170;
  test::WalkingRobot robot(parameters);
  test::Digest digest;
  std::mt19937 random(seed);
  const auto about_zero = [&random](std::int32_t most) {
    return static_cast<std::int32_t>(random() % (2 * static_cast<std::uint32_t>(most) + 1)) - most;
  };
  const auto add_state = [&] {
    for (const fixed::Angle target : robot.walker.targets()) digest.add(target.raw());
    digest.add(robot.walker.pitch().raw());
    const auto zmp = robot.walker.planned_zmp();
    digest.add(zmp ? static_cast<int>(zmp->sole) : -1);
    if (!zmp) return;
    digest.add(zmp->p.x.raw());
    digest.add(zmp->p.y.raw());
  };
  for (const Velocity& command : kCommands) {
    for (int cycle = 0; cycle < kCycles; ++cycle) {
      Observation seen;
      seen.roll = fixed::Angle::from_raw(about_zero(1 << 25));
      seen.pitch = fixed::Angle::from_raw(about_zero(1 << 25));
      seen.rates = {fixed::AngularRate::from_raw(about_zero(1 << 20)),
                    fixed::AngularRate::from_raw(about_zero(1 << 20)),
                    fixed::AngularRate::from_raw(about_zero(1 << 18))};
      for (const std::size_t side : {0u, 1u}) seen.loads[side] = fixed::Force::from_raw(about_zero(1 << 20));
      robot.advance(command, seen);
      add_state();
    }
  }
  robot.walker.stop();
  for (int cycle = 0; cycle < 500 && robot.walker.running(); ++cycle) {
    robot.advance();
    add_state();
  }
  EXPECT_FALSE(robot.walker.running());
  EXPECT_GT(robot.landings.size(), 30u) << robot.tick;
  return digest.value();
}

TEST(SameBits, OfATunedWalk) { EXPECT_EQ(walk_digest(test::tuned_gait(), 1), 0xED15'631D'C87E'5CC8u); }

TEST(SameBits, OfAWalkThatReacts) {
  WalkParameters reacting = test::rigid();
  reacting.reaction = {.capture_forward = 100,
                       .capture_lateral = 60,
                       .dead_band = 20,
                       .smoothing = 500,
                       .touchdown_load_cN = 0,
                       .heading_hold = 0};
  EXPECT_EQ(walk_digest(reacting, 2), 0xA0F2'840D'21FB'E99Du);
}

}  // namespace
}  // namespace koboshi::walk
