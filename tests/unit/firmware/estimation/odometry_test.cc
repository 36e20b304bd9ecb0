#include "firmware/estimation/odometry.h"

#include <gtest/gtest.h>

#include <cmath>

#include "firmware/fixed/host/convert.h"
#include "tests/unit/firmware/robot/test_robot.h"

namespace koboshi::estimation {
namespace {

using fixed::from_double;
using fixed::to_double;
using hal::Side;

constexpr double kCycleOfOdometry_s = 0.01;

robot::Pose pose(double x_m, double y_m, double yaw_rad) {
  return {.R = robot::rotation_about(robot::kAxisZ, from_double<fixed::Angle>(yaw_rad)),
          .p = test::position(x_m, y_m, -0.2)};
}

// A robot whose feet stand on the floor at known places, and whose trunk moves in the plane.
struct PlaneWalk {
  // Advances the trunk by this speed in its own axes.
  void advance(double forward_m_per_s, double left_m_per_s, double turn_rad_per_s, Side stands,
               bool rests = false) {
    yaw += turn_rad_per_s * kCycleOfOdometry_s;
    x += (forward_m_per_s * std::cos(yaw) - left_m_per_s * std::sin(yaw)) * kCycleOfOdometry_s;
    y += (forward_m_per_s * std::sin(yaw) + left_m_per_s * std::cos(yaw)) * kCycleOfOdometry_s;
    Posture posture;
    for (const Side side : {Side::kLeft, Side::kRight}) {
      const Foot& foot = feet[side];
      const double dx = foot.x - x;
      const double dy = foot.y - y;
      posture.X_BSole[side] = pose(dx * std::cos(yaw) + dy * std::sin(yaw),
                                   dy * std::cos(yaw) - dx * std::sin(yaw), foot.yaw - yaw);
    }
    const double turn_rad = (turn_rad_per_s + gyro_bias_rad_per_s) * kCycleOfOdometry_s;
    odometry.update(posture, level_axes(posture.X_BSole[stands].R, robot::kAxisZ), robot::kAxisZ,
                    from_double<fixed::Angle>(turn_rad), stands, rests);
  }

  struct Foot {
    double x;
    double y;
    double yaw;
  };
  hal::BySide<Foot> feet{Foot{0, 0.04, 0}, Foot{0, -0.04, 0}};
  double x = 0.0;
  double y = 0.0;
  double yaw = 0.0;
  double gyro_bias_rad_per_s = 0.0;
  Odometry odometry;
};

void expect_place(const PlaneWalk& walk, double tolerance_m) {
  const Odometer& odometer = walk.odometry.odometer();
  EXPECT_NEAR(to_double(odometer.x), walk.x, tolerance_m);
  EXPECT_NEAR(to_double(odometer.y), walk.y, tolerance_m);
  EXPECT_NEAR(std::remainder(to_double(odometer.heading) - walk.yaw, 2 * M_PI), 0.0, 1e-3);
}

// Twenty steps in a curve, sideways too; in each the foot in the air goes where it will stand.
TEST(Odometry, FollowsAWalkInACurve) {
  PlaneWalk walk;
  walk.advance(0, 0, 0, Side::kLeft);
  for (int step = 0; step < 40; ++step) {
    const Side stands = step % 2 == 0 ? Side::kLeft : Side::kRight;
    const Side swings = step % 2 == 0 ? Side::kRight : Side::kLeft;
    for (int cycle = 0; cycle < 20; ++cycle) {
      auto& foot = walk.feet[swings];
      // In the first cycle both stand.
      if (cycle > 0)
        foot = {foot.x + 0.004 * std::cos(walk.yaw), foot.y + 0.004 * std::sin(walk.yaw), walk.yaw};
      walk.advance(0.2, 0.05, 0.3, stands);
    }
  }
  EXPECT_GT(std::hypot(walk.x, walk.y), 0.5);
  expect_place(walk, 2e-3);
}

// A foot that twists on the floor does not turn the robot in the plane.
TEST(Odometry, TakesTheHeadingFromTheGyro) {
  PlaneWalk walk;
  walk.advance(0, 0, 0, Side::kLeft);
  for (int cycle = 0; cycle < 100; ++cycle) {
    walk.feet[Side::kLeft].yaw -= 0.002;
    walk.advance(0.1, 0, 0.2, Side::kLeft);
  }
  expect_place(walk, 2e-3);
}

TEST(Odometry, StaysWhileTheRobotRests) {
  PlaneWalk walk;
  walk.gyro_bias_rad_per_s = 0.01;
  for (int cycle = 0; cycle < 1000; ++cycle) walk.advance(0, 0, 0, Side::kLeft, true);
  EXPECT_EQ(walk.odometry.odometer().heading, fixed::Angle());
  EXPECT_EQ(walk.odometry.odometer().x, fixed::Length());
  // It goes on from there.
  for (int cycle = 0; cycle < 100; ++cycle) walk.advance(0.1, 0, 0, Side::kLeft);
  EXPECT_NEAR(to_double(walk.odometry.odometer().x), 0.1, 1e-3);
  EXPECT_NEAR(to_double(walk.odometry.odometer().heading), 0.01, 1e-4);
}

}  // namespace
}  // namespace koboshi::estimation
