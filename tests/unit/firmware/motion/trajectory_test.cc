#include "firmware/motion/trajectory.h"

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <span>

#include "tests/unit/firmware/motion/motion_builder.h"

namespace koboshi::motion {
namespace {

using test::degrees;

constexpr std::uint32_t kTurnPerSecond = 1u << 24;

TEST(TrajectoryTest, LeavesReleasedJointsWithoutAMeasurementWhereTheyAre) {
  const robot::RobotModel model = test::load_test_robot();
  Trajectory trajectory(model);
  std::array<fixed::Angle, 20> pose{};
  pose[3] = degrees(40);
  trajectory.reset(pose);
  std::array<fixed::Angle, 20> measured = pose;
  measured[3] = degrees(50);
  trajectory.release(1u << 3, std::span(measured).first(3));
  EXPECT_EQ(trajectory.targets()[3], degrees(40));
  trajectory.release(1u << 3, std::span(measured).first(4));
  EXPECT_EQ(trajectory.targets()[3], degrees(50));
}

TEST(TrajectoryTest, ReleasesOnlyTheNamedJoints) {
  const robot::RobotModel model = test::load_test_robot();
  Trajectory trajectory(model);
  std::array<fixed::Angle, 20> measured{};
  measured[3] = degrees(50);
  measured[18] = degrees(10);
  trajectory.release(1u << 18, measured);
  EXPECT_EQ(trajectory.targets()[3], fixed::Angle());
  EXPECT_EQ(trajectory.targets()[18], degrees(10));
}

// Half a turn at a peak speed of a turn a second takes half a second times the ratio of peak to mean speed,
// rounded up to a microsecond, and stays within the times of a step.
TEST(TrajectoryTest, TakesTheTimeOfItsSpeed) {
  const auto time_us = [](Interpolation interpolation, std::uint32_t travel, std::uint32_t speed) {
    return Trajectory::duration_us(interpolation, travel, speed);
  };
  constexpr std::uint32_t kHalfTurn = 1u << 31;
  EXPECT_EQ(time_us(Interpolation::kLinear, kHalfTurn, kTurnPerSecond), 500'000u);
  EXPECT_EQ(time_us(Interpolation::kMinimumJerk, kHalfTurn, kTurnPerSecond), 937'500u);
  EXPECT_EQ(time_us(Interpolation::kCubic, kHalfTurn, kTurnPerSecond), 750'000u);
  EXPECT_EQ(time_us(Interpolation::kLinear, kHalfTurn + 1, kTurnPerSecond), 500'001u);
  EXPECT_EQ(time_us(Interpolation::kLinear, 0, kTurnPerSecond), kMinStepTime_us);
  EXPECT_EQ(time_us(Interpolation::kLinear, kHalfTurn, 1), kMaxStepTime_us);
}

}  // namespace
}  // namespace koboshi::motion
