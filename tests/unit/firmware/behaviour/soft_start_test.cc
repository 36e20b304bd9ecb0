#include "firmware/behaviour/soft_start.h"

#include <gtest/gtest.h>

#include <array>

#include "tests/unit/firmware/robot/test_robot.h"

namespace koboshi::behaviour {
namespace {

constexpr std::int16_t kSixtyDegreesASecond = 683;
constexpr std::uint32_t kTick_us = 10'000;

using Pose = std::array<fixed::Angle, 3>;

const estimation::RobotState robot;  // a ramp does not depend on it

TEST(SoftStart, ArrivesWithAllJointsAtOnceAndTurnsNoneFasterThanItsRate) {
  const Pose from{};
  const Pose to{test::degrees(90), test::degrees(-30), test::degrees(0)};
  SoftStart ramp;
  ramp.begin(from, to, kSixtyDegreesASecond);
  Pose targets = from;
  int ticks = 0;
  while (ramp.running()) {
    const Pose before = targets;
    ramp.advance(kTick_us, {.robot = robot}, targets);
    ++ticks;
    EXPECT_LE(targets[0].raw() - before[0].raw(), test::degrees(0.61).raw());
    EXPECT_NEAR(targets[1].raw(), -targets[0].raw() / 3, 2);
    EXPECT_EQ(targets[2], from[2]);
  }
  EXPECT_EQ(ticks, 150);  // 90 degrees
  EXPECT_EQ(targets, to);
}

TEST(SoftStart, TakesAtLeastHalfASecond) {
  const Pose pose{};
  SoftStart ramp;
  ramp.begin(pose, pose, kSixtyDegreesASecond);
  Pose targets{};
  int ticks = 0;
  for (; ramp.running(); ++ticks) ramp.advance(kTick_us, {.robot = robot}, targets);
  EXPECT_EQ(ticks, 50);
}

TEST(SoftStartDeathTest, RequiresAPositiveRateAndPosesOfEqualSize) {
  SoftStart ramp;
  const Pose pose{};
  EXPECT_DEATH(ramp.begin(pose, pose, 0), "rate");
  EXPECT_DEATH(ramp.begin(pose, std::span(pose).first(2), kSixtyDegreesASecond), "size");
}

}  // namespace
}  // namespace koboshi::behaviour
