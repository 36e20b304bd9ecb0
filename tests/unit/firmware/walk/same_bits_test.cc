// Walks that must have the same bits everywhere (tests/unit/firmware/fixed/digest.h).

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <optional>
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
    digest.add(robot.walker.error_percent().value_or(1));
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
      seen.turn = fixed::Angle::from_raw(about_zero(1 << 20));
      seen.dcm = robot.walker.expected_dcm();
      if (seen.dcm) seen.dcm->p.x += fixed::Length::from_raw(about_zero(1 << 18));
      if (seen.dcm) seen.dcm->p.y += fixed::Length::from_raw(about_zero(1 << 18));
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

TEST(SameBits, OfATunedWalk) { EXPECT_EQ(walk_digest(test::tuned_gait(), 1), 0xE601'B1A6'B641'A1DEu); }

TEST(SameBits, OfAWalkThatReacts) {
  WalkParameters reacting = test::rigid();
  reacting.reaction = {.capture_forward = 100,
                       .capture_lateral = 60,
                       .dead_band = 20,
                       .smoothing = 500,
                       .touchdown_load_cN = 0,
                       .heading_hold = 0,
                       .plan_age_ms = 50,
                       .level_swing = 900,
                       .zmp_tracking_forward = 1000,
                       .zmp_tracking_lateral = 600,
                       .max_zmp_shift_forward = 150,
                       .max_zmp_shift_lateral = 120,
                       .arm_reaction = 4000};
  reacting.posture.pitch_compliance = 1285;
  reacting.posture.roll_compliance = 399;
  EXPECT_EQ(walk_digest(reacting, 2), 0xB58B'268F'90F8'9DF2u);
}

// Gaits within the ranges of the dictionary, most of which nobody would walk with: each parameter is in use.
WalkParameters random_gait(std::mt19937& random) {
  const auto draw = [&random](int low, int high) {
    return static_cast<std::int16_t>(low +
                                     static_cast<int>(random() % static_cast<unsigned>(high - low + 1)));
  };
  return {.step = {.time_ms = draw(150, 400),
                   .double_support = draw(0, 300),
                   .width = draw(600, 800),
                   .height = draw(100, 400),
                   .swing_profile = draw(0, 1000),
                   .acceleration = {draw(100, 900), draw(100, 500), draw(500, 5000)},
                   .max_forward = draw(400, 1300),
                   .max_lateral = draw(900, 1400),
                   .min_lateral = draw(400, 590),
                   .lengthening = draw(0, 300),
                   .forward_offset = draw(-100, 100)},
          .posture = {.com_height = draw(1550, 1750),
                      .zmp_forward = draw(-100, 150),
                      .zmp_inward = draw(-100, 100),
                      .trunk_pitch = draw(-500, 1500),
                      .trunk_pitch_by_speed = draw(-1000, 1000),
                      .pitch_compliance = draw(0, 2000),
                      .roll_compliance = draw(0, 1000),
                      .arm_swing = draw(-1000, 1000),
                      .fixed_upper_body = draw(0, 1)},
          .reaction = {.capture_forward = draw(0, 1000),
                       .capture_lateral = draw(0, 800),
                       .dead_band = draw(0, 200),
                       .smoothing = draw(0, 900),
                       .touchdown_load_cN = draw(0, 1) == 0 ? std::int16_t{0} : draw(1, 600),
                       .heading_hold = draw(0, 600),
                       .plan_age_ms = draw(0, 120),
                       .level_swing = draw(0, 1000),
                       .zmp_tracking_forward = draw(0, 1500),
                       .zmp_tracking_lateral = draw(0, 1500),
                       .max_zmp_shift_forward = draw(0, 400),
                       .max_zmp_shift_lateral = draw(0, 300),
                       .pushed_step_time_ms = draw(100, 300),
                       .arm_reaction = draw(0, 8000)}};
}

// One walk after the other, of one walker that is stopped, resumed and started again.
TEST(SameBits, OfRandomGaits) {
  test::Digest digest;
  std::mt19937 random(431);
  const auto about_zero = [&random](std::int32_t most) {
    return static_cast<std::int32_t>(random() % (2 * static_cast<std::uint32_t>(most) + 1)) - most;
  };
  test::WalkingRobot robot;
  for (int walk = 0; walk < 12; ++walk) {
    const WalkParameters parameters = random_gait(random);
    EXPECT_TRUE(is_gait(parameters)) << walk;
    std::vector<fixed::Angle> start = robot.standing;
    for (std::size_t joint = 12; joint < start.size(); ++joint)
      start[joint] = start[joint] + fixed::Angle::from_raw(about_zero(1 << 26));
    const std::array<std::optional<hal::Side>, 3> pushed_to{std::nullopt, hal::Side::kLeft,
                                                            hal::Side::kRight};
    robot.walker.start(parameters, start, pushed_to[static_cast<std::size_t>(walk) % 3]);
    Velocity command{};
    for (int cycle = 0; cycle < 300; ++cycle) {
      if (cycle % 60 == 0)
        command = {static_cast<std::int16_t>(about_zero(200)), static_cast<std::int16_t>(about_zero(80)),
                   static_cast<std::int16_t>(about_zero(800))};
      if (cycle == 170) robot.walker.stop();
      if (cycle == 190) robot.walker.resume();
      if (cycle == 240) robot.walker.stop();
      Observation seen;
      seen.roll = fixed::Angle::from_raw(about_zero(1 << 25));
      seen.pitch = robot.walker.pitch() + fixed::Angle::from_raw(about_zero(1 << 25));
      seen.turn = fixed::Angle::from_raw(about_zero(1 << 20));
      seen.dcm = robot.walker.expected_dcm();
      if (seen.dcm) seen.dcm->p.x += fixed::Length::from_raw(about_zero(1 << 18));
      if (seen.dcm) seen.dcm->p.y += fixed::Length::from_raw(about_zero(1 << 18));
      for (const std::size_t side : {0u, 1u}) seen.loads[side] = fixed::Force::from_raw(about_zero(1 << 21));
      robot.walker.advance(command, seen);
      for (const fixed::Angle target : robot.walker.targets()) digest.add(target.raw());
      digest.add(robot.walker.running());
      digest.add(robot.walker.stopping());
      digest.add(robot.walker.pitch().raw());
      digest.add(robot.walker.error_percent().value_or(1));
      digest.add(robot.walker.phase() ? robot.walker.phase()->raw() : 1);
      for (const auto side : {robot.walker.swing_foot(), robot.walker.support(), robot.walker.reference()})
        digest.add(side ? static_cast<int>(*side) : -1);
      const auto dcm_error = robot.walker.dcm_error();
      digest.add(dcm_error ? dcm_error->x.raw() : 1);
      digest.add(dcm_error ? dcm_error->y.raw() : 1);
      const auto zmp = robot.walker.planned_zmp();
      digest.add(zmp ? static_cast<int>(zmp->sole) : -1);
      digest.add(zmp ? zmp->p.x.raw() : 1);
      digest.add(zmp ? zmp->p.y.raw() : 1);
    }
  }
  EXPECT_EQ(digest.value(), 0x0D7D'78C2'DAC4'A8F8u);
}

}  // namespace
}  // namespace koboshi::walk
