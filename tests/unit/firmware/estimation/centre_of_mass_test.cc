#include "firmware/estimation/centre_of_mass.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "firmware/fixed/host/convert.h"
#include "firmware/fixed/literals.h"
#include "tests/unit/firmware/estimation/random_posture.h"

namespace koboshi::estimation {
namespace {

using fixed::Length;
using fixed::to_double;
using hal::Side;
using test::Point;

constexpr double kObserved_s = 0.01;
constexpr double kComAt_m = 0.16;
constexpr double kComTimeConstant_s = 0.12773;  // sqrt(z / g)
constexpr double kApart_m = 0.08;

// Both soles level at z = 0 of B, the left one at the origin; the centre of mass above them.
Posture standing_posture(double x_m, double y_m) {
  Posture posture;
  posture.X_BSole[Side::kRight].p = test::position(0.0, -kApart_m, 0.0);
  posture.p_BCom = test::position(x_m, y_m, kComAt_m);
  return posture;
}

robot::Vector<fixed::Acceleration> specific_force(double x, double y) {
  return {fixed::from_double<fixed::Acceleration>(x), fixed::from_double<fixed::Acceleration>(y),
          fixed::from_double<fixed::Acceleration>(9.80665)};
}

const CentreOfMassMotion& update(CentreOfMassObserver& observer, const Posture& posture,
                                 const robot::Direction& up_B,
                                 const robot::Vector<fixed::Acceleration>& force_B, Side sole) {
  return observer.update(posture, level_axes(posture.X_BSole[sole].R, up_B), up_B, force_B, sole);
}

TEST(CentreOfMassObserver, HasTheCentreOfMassItselfAsTheDcmAtRest) {
  CentreOfMassObserver observer;
  for (int cycle = 0; cycle < 200; ++cycle)
    update(observer, standing_posture(0.02, -0.03), robot::kAxisZ, specific_force(0, 0), Side::kLeft);
  const CentreOfMassMotion& motion = observer.motion();
  EXPECT_TRUE(motion.valid);
  EXPECT_NEAR(to_double(motion.position.x), 0.02, 1e-6);
  EXPECT_NEAR(to_double(motion.position.y), -0.03, 1e-6);
  EXPECT_NEAR(to_double(motion.height), kComAt_m, 1e-6);
  EXPECT_NEAR(to_double(motion.velocity.x), 0.0, 1e-6);
  EXPECT_NEAR(to_double(motion.dcm.x), 0.02, 1e-6);
  EXPECT_NEAR(to_double(motion.dcm.y), -0.03, 1e-6);
}

// Oscillations like those of a walk, with two amplitudes and frequencies, so that no axis stands for the
// other.
TEST(CentreOfMassObserver, FollowsAMovingCentreOfMass) {
  const double rate_x = 2.0 * M_PI * 2.5;
  const double rate_y = 2.0 * M_PI * 1.5;
  CentreOfMassObserver observer;
  for (int cycle = 0; cycle < 400; ++cycle) {
    const double t = kObserved_s * cycle;
    const double x = 0.01 * std::sin(rate_x * t);
    const double y = 0.02 * std::cos(rate_y * t);
    const auto motion = update(observer, standing_posture(x, y), robot::kAxisZ,
                               specific_force(-rate_x * rate_x * x, -rate_y * rate_y * y), Side::kLeft);
    if (cycle < 60) continue;
    const double x_speed = 0.01 * rate_x * std::cos(rate_x * t);
    const double y_speed = -0.02 * rate_y * std::sin(rate_y * t);
    ASSERT_NEAR(to_double(motion.position.x), x, 0.6e-3) << cycle;
    ASSERT_NEAR(to_double(motion.position.y), y, 0.6e-3) << cycle;
    ASSERT_NEAR(to_double(motion.velocity.x), x_speed, 0.02) << cycle;
    ASSERT_NEAR(to_double(motion.velocity.y), y_speed, 0.02) << cycle;
    ASSERT_NEAR(to_double(motion.dcm.x),
                to_double(motion.position.x) + kComTimeConstant_s * to_double(motion.velocity.x), 5e-6);
    ASSERT_NEAR(to_double(motion.dcm.y),
                to_double(motion.position.y) + kComTimeConstant_s * to_double(motion.velocity.y), 5e-6);
  }
}

// A push moves the mass before the joints feel it, if they ever do: the accelerometer tells at once.
TEST(CentreOfMassObserver, SensesAPushByTheAccelerometer) {
  CentreOfMassObserver observer;
  for (int cycle = 0; cycle < 50; ++cycle)
    update(observer, standing_posture(0, 0), robot::kAxisZ, specific_force(0, 0), Side::kLeft);
  for (int cycle = 0; cycle < 3; ++cycle)
    update(observer, standing_posture(0, 0), robot::kAxisZ, specific_force(5.0, -2.0), Side::kLeft);
  EXPECT_GT(to_double(observer.motion().velocity.x), 0.1);
  EXPECT_LT(to_double(observer.motion().velocity.y), -0.04);
}

// The trunk leans to the front and to the right: the mass is ahead of the foot and to its right.
TEST(CentreOfMassObserver, LevelsByTheAttitude) {
  for (const auto& [pitch, roll] : {std::pair{0.2, 0.0}, std::pair{0.0, 0.1}}) {
    const robot::Direction up{fixed::from_double<fixed::Ratio>(-std::sin(pitch)),
                              fixed::from_double<fixed::Ratio>(std::sin(roll)),
                              fixed::from_double<fixed::Ratio>(std::cos(pitch) * std::cos(roll))};
    const robot::Vector<fixed::Acceleration> gravity{
        fixed::from_double<fixed::Acceleration>(-9.80665 * std::sin(pitch)),
        fixed::from_double<fixed::Acceleration>(9.80665 * std::sin(roll)),
        fixed::from_double<fixed::Acceleration>(9.80665 * std::cos(pitch) * std::cos(roll))};
    CentreOfMassObserver observer;
    for (int cycle = 0; cycle < 100; ++cycle)
      update(observer, standing_posture(0, 0), up, gravity, Side::kLeft);
    EXPECT_NEAR(to_double(observer.motion().position.x), kComAt_m * std::sin(pitch), 20e-6);
    EXPECT_NEAR(to_double(observer.motion().position.y), -kComAt_m * std::sin(roll), 20e-6);
    EXPECT_NEAR(to_double(observer.motion().height), kComAt_m * std::cos(pitch) * std::cos(roll), 1e-5);
  }
}

// A turned foot: its own axes are those of the motion, and it is the same motion.
TEST(CentreOfMassObserver, GoesOverToTheOtherFoot) {
  constexpr double kYaw = 0.5;
  const auto posture = [&](double x_m) {
    Posture turned = standing_posture(x_m, 0.0);
    turned.X_BSole[Side::kRight].R =
        robot::rotation_about(robot::kAxisZ, fixed::from_double<fixed::Angle>(kYaw));
    return turned;
  };
  CentreOfMassObserver observer;
  double x_m = 0.0;
  for (int cycle = 0; cycle < 100; ++cycle) {
    x_m += 0.2 * kObserved_s;
    update(observer, posture(x_m), robot::kAxisZ, specific_force(0, 0), Side::kLeft);
  }
  const CentreOfMassMotion left = observer.motion();
  EXPECT_NEAR(to_double(left.velocity.x), 0.2, 1e-3);
  x_m += 0.2 * kObserved_s;
  const CentreOfMassMotion right =
      update(observer, posture(x_m), robot::kAxisZ, specific_force(0, 0), Side::kRight);
  EXPECT_EQ(right.sole, Side::kRight);
  const double x = to_double(right.position.x);
  const double y = to_double(right.position.y);
  EXPECT_NEAR(x * std::cos(kYaw) - y * std::sin(kYaw), x_m, 0.3e-3);
  EXPECT_NEAR(x * std::sin(kYaw) + y * std::cos(kYaw), kApart_m, 0.3e-3);
  EXPECT_NEAR(to_double(right.velocity.x), 0.2 * std::cos(kYaw), 2e-3);
  EXPECT_NEAR(to_double(right.velocity.y), -0.2 * std::sin(kYaw), 2e-3);
}

TEST(CentreOfMassObserver, IsInvalidWhileTheSoleStandsOnEdgeAndBeginsAnew) {
  Posture on_edge = standing_posture(0.05, 0.02);
  on_edge.X_BSole[Side::kLeft].R =
      robot::rotation_about(robot::kAxisY, fixed::from_double<fixed::Angle>(70.0 * M_PI / 180.0));
  CentreOfMassObserver observer;
  update(observer, standing_posture(0, 0), robot::kAxisZ, specific_force(3, 0), Side::kLeft);
  EXPECT_FALSE(update(observer, on_edge, robot::kAxisZ, specific_force(3, 0), Side::kLeft).valid);
  const auto again =
      update(observer, standing_posture(0.03, 0.01), robot::kAxisZ, specific_force(0, 0), Side::kLeft);
  EXPECT_TRUE(again.valid);
  EXPECT_NEAR(to_double(again.position.x), 0.03, 1e-6);
  EXPECT_NEAR(to_double(again.velocity.x), 0.0, 1e-6);
}

// Any pose, by forward kinematics in double.
TEST(CentreOfMassObserver, FindsTheCentreOfMassInAnyPose) {
  test::RandomPosture robot;
  double worst_m = 0.0;
  for (int round = 0; round < 500; ++round) {
    robot.draw();
    const Point forward = robot.from_sole(Side::kRight, {1, 0, 0}) - robot.from_sole(Side::kRight, {});
    if (std::hypot(forward.x, forward.y) < 0.6) continue;  // the sole stands on edge
    CentreOfMassObserver observer;
    const auto motion = update(observer, robot.posture, robot::kAxisZ, specific_force(0, 0), Side::kRight);
    ASSERT_TRUE(motion.valid);
    const Point com = robot.com_B() - robot.from_sole(Side::kRight, {});
    const double length = std::hypot(forward.x, forward.y);
    const double x = (com.x * forward.x + com.y * forward.y) / length;
    const double y = (com.y * forward.x - com.x * forward.y) / length;
    worst_m = std::max(
        {worst_m, std::abs(to_double(motion.position.x) - x), std::abs(to_double(motion.position.y) - y)});
  }
  EXPECT_LT(worst_m, 2e-6);
  EXPECT_GT(worst_m, 1e-9);
}

}  // namespace
}  // namespace koboshi::estimation
