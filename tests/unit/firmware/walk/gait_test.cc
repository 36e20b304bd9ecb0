#include "firmware/walk/gait.h"

#include <gtest/gtest.h>

#include <cmath>

#include "firmware/fixed/host/convert.h"
#include "firmware/walk/pendulum.h"
#include "tests/support/tuned_gait.h"
#include "tests/unit/firmware/robot/test_robot.h"

namespace koboshi::walk {
namespace {

using fixed::to_double;
using test::kTickLength_s;

constexpr double kLengthLsb_m = 1.0 / (1 << 24);

Gait with_steps(const decltype(WalkParameters::step)& step) {
  WalkParameters parameters;
  parameters.step = step;
  return Gait(parameters);
}

TEST(Gait, ConvertsTheParametersToQuantities) {
  const Gait gait({.step = {.time_ms = 240,
                            .double_support = 250,
                            .width = 771,
                            .height = 283,
                            .swing_profile = 450,
                            .acceleration = {1, 2, 3},
                            .max_forward = 1300,
                            .max_lateral = 1250,
                            .min_lateral = 580},
                   .posture = {.com_height = 1675,
                               .zmp_forward = -94,
                               .zmp_inward = -6,
                               .trunk_pitch = 0x1000,
                               .trunk_pitch_by_speed = -0x2000,
                               .pitch_compliance = 1285,
                               .roll_compliance = 399,
                               .arm_swing = -150},
                   .reaction = {.capture_forward = 270,
                                .capture_lateral = 1500,
                                .dead_band = 59,
                                .smoothing = 360,
                                .touchdown_load_cN = 250,
                                .heading_hold = 125,
                                .arm_reaction = 1234}});
  EXPECT_EQ(gait.step_ticks, 24);
  EXPECT_EQ(gait.double_ticks, 6);
  EXPECT_NEAR(to_double(gait.step_width), 0.0771, kLengthLsb_m);
  EXPECT_NEAR(to_double(gait.step_height), 0.0283, kLengthLsb_m);
  EXPECT_NEAR(to_double(gait.swing_profile), 0.45, 1e-9);
  EXPECT_EQ(gait.acceleration, (std::array{1, 2, 3}));
  EXPECT_NEAR(to_double(gait.max_forward), 0.13, kLengthLsb_m);
  EXPECT_NEAR(to_double(gait.max_lateral), 0.125, kLengthLsb_m);
  EXPECT_NEAR(to_double(gait.min_lateral), 0.058, kLengthLsb_m);
  EXPECT_NEAR(to_double(gait.carriage.com_height), 0.1675, kLengthLsb_m);
  EXPECT_NEAR(to_double(gait.zmp_forward), -0.0094, kLengthLsb_m);
  EXPECT_NEAR(to_double(gait.zmp_inward), -0.0006, kLengthLsb_m);
  EXPECT_NEAR(to_double(gait.carriage.pitch), 2.0 * M_PI / 16, 1e-9);
  EXPECT_NEAR(to_double(gait.carriage.pitch_at_1_m_per_s), -2.0 * M_PI / 8, 1e-9);
  EXPECT_NEAR(to_double(gait.carriage.compliance.pitch), 1.285, 2e-9);
  EXPECT_NEAR(to_double(gait.carriage.compliance.roll), 0.399, 2e-9);
  EXPECT_NEAR(to_double(gait.carriage.arm_swing), -0.15, 1e-9);
  EXPECT_NEAR(to_double(gait.capture_forward), 0.27, 1e-9);
  EXPECT_NEAR(to_double(gait.capture_lateral), 1.5, 1e-9);
  EXPECT_NEAR(to_double(gait.dead_band), 0.0059, kLengthLsb_m);
  EXPECT_NEAR(to_double(gait.smoothing), 0.36, 1e-9);
  EXPECT_NEAR(to_double(gait.touchdown_load), 2.5, 1e-4);
  EXPECT_NEAR(to_double(gait.heading_hold), 0.125, 1e-9);
  EXPECT_NEAR(to_double(gait.arm_reaction), 12.34, 1e-5);
}

TEST(Gait, IsInvalidWithoutAnyRequiredParameter) {
  EXPECT_FALSE(is_gait({}));
  EXPECT_TRUE(is_gait(test::tuned_gait()));
  const auto lacks = [](auto&& take_away) {
    WalkParameters parameters = test::tuned_gait();
    take_away(parameters);
    return !is_gait(parameters);
  };
  EXPECT_TRUE(lacks([](WalkParameters& p) { p.step.time_ms = 0; }));
  EXPECT_TRUE(lacks([](WalkParameters& p) { p.step.width = 0; }));
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_TRUE(lacks([i](WalkParameters& p) { p.step.acceleration[i] = 0; })) << i;
  EXPECT_TRUE(lacks([](WalkParameters& p) { p.step.max_forward = 0; }));
  EXPECT_TRUE(lacks([](WalkParameters& p) { p.step.max_lateral = 0; }));
  EXPECT_TRUE(lacks([](WalkParameters& p) { p.step.min_lateral = 0; }));
  EXPECT_TRUE(lacks([](WalkParameters& p) { p.step.min_lateral = p.step.max_lateral + 1; }));
  EXPECT_TRUE(lacks([](WalkParameters& p) { p.posture.com_height = 0; }));
}

TEST(Gait, TruncatesTimesToWholeCyclesAndKeepsOneForTheSwing) {
  EXPECT_EQ(with_steps({.time_ms = 269}).step_ticks, 26);
  EXPECT_EQ(with_steps({.time_ms = 0}).step_ticks, 1);
  EXPECT_EQ(with_steps({.time_ms = 32'000}).step_ticks, std::int32_t{Pendulum::kMaxTicks});
  EXPECT_EQ(with_steps({.time_ms = 260, .double_support = 150}).double_ticks, 3);
  EXPECT_EQ(with_steps({.time_ms = 260, .double_support = 1000}).double_ticks, 25);
  EXPECT_EQ(with_steps({.time_ms = 260, .double_support = -1}).double_ticks, 0);
}

TEST(Speed, ChangesByAtMostTheAccelerationPerCycle) {
  const Gait gait = with_steps({.time_ms = 200, .acceleration = {300, 200, 1500}});
  Speed speed;
  EXPECT_TRUE(speed.is_zero());
  const double step_s = 0.2;
  for (int tick = 1; tick <= 50; ++tick) {
    speed.approach({400, -200, 1500}, gait);
    const double time_s = kTickLength_s * tick;
    const Stride stride = speed.stride(gait);
    EXPECT_NEAR(to_double(stride.distance.x), 0.3 * time_s * step_s, kLengthLsb_m);
    EXPECT_NEAR(to_double(stride.distance.y), -0.2 * time_s * step_s, kLengthLsb_m);
    EXPECT_NEAR(to_double(stride.turn), 1.5 * time_s * step_s, 2e-9);
  }
  EXPECT_FALSE(speed.is_zero());
}

TEST(Speed, ReachesItsCommandAndStaysThere) {
  const Gait gait =
      with_steps({.time_ms = 200, .acceleration = {70, 70, 70}});  // not a divisor of the requested time
  Speed speed;
  const Velocity wanted{100, -33, 7};
  for (int tick = 0; tick < 200; ++tick) speed.approach(wanted, gait);
  EXPECT_NEAR(to_double(speed.stride(gait).distance.x), 0.1 * 0.2, kLengthLsb_m);
  EXPECT_NEAR(to_double(speed.stride(gait).distance.y), -0.033 * 0.2, kLengthLsb_m);
  EXPECT_NEAR(to_double(speed.stride(gait).turn), 0.007 * 0.2, 2e-9);
  EXPECT_NEAR(to_double(speed.turn()), 0.007 * kTickLength_s, 2e-9);
  for (int tick = 0; tick < 200; ++tick) speed.approach({}, gait);
  EXPECT_TRUE(speed.is_zero());
}

TEST(Speed, LeansInProportionToSpeed) {
  WalkParameters parameters = test::tuned_gait();
  parameters.posture.trunk_pitch = 0x100;
  parameters.posture.trunk_pitch_by_speed = 0x1000;
  const Gait gait(parameters);
  Speed speed;
  EXPECT_EQ(speed.lean(gait.carriage), gait.carriage.pitch);
  for (int tick = 0; tick < 100; ++tick) speed.approach({-250, 100, 100}, gait);
  EXPECT_NEAR(to_double(speed.lean(gait.carriage)), to_double(gait.carriage.pitch) - 0.25 * 2.0 * M_PI / 16,
              2e-9);
}

}  // namespace
}  // namespace koboshi::walk
