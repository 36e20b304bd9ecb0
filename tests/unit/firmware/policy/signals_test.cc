#include "firmware/policy/signals.h"

#include <gtest/gtest.h>

#include "firmware/fixed/host/convert.h"
#include "tests/unit/firmware/robot/test_robot.h"

namespace koboshi::policy {
namespace {

using fixed::from_double;
using test::degrees;

constexpr double kTurnPerDegree = 1.0 / 360.0;

class SignalsOfACycle : public ::testing::Test {
 protected:
  std::int32_t at(Signal signal, std::size_t place = 0) const {
    return signals_.values()[static_cast<std::size_t>(signal) + place];
  }
  void expect(Signal signal, std::size_t place, double value, int bits, double tolerance = 2.0) const {
    EXPECT_NEAR(at(signal, place), std::ldexp(value, bits), tolerance)
        << static_cast<int>(signal) << " " << place;
  }

  estimation::RobotState robot_;
  std::array<fixed::Angle, 20> angles_{};
  std::array<fixed::Angle, 20> targets_{};
  Signals signals_;
};

TEST_F(SignalsOfACycle, HaveTheirUnits) {
  robot_.roll = degrees(-5.0);
  robot_.pitch = degrees(12.0);
  robot_.up_B = {from_double<fixed::Ratio>(0.6), from_double<fixed::Ratio>(0.0),
                 from_double<fixed::Ratio>(0.8)};
  robot_.rates_B = {from_double<fixed::AngularRate>(1.0), from_double<fixed::AngularRate>(-2.0),
                    from_double<fixed::AngularRate>(0.5)};
  robot_.accelerations_B.z = from_double<fixed::Acceleration>(9.80665);
  robot_.feet[0].load = from_double<fixed::Force>(7.5);
  robot_.feet[1].load = from_double<fixed::Force>(4.5);
  robot_.feet[1].y = from_double<fixed::Length>(-0.012);
  angles_[7] = degrees(33.0);
  targets_[7] = degrees(34.0);
  signals_.update({.robot = robot_,
                   .angles = angles_,
                   .targets = targets_,
                   .planned_pitch = degrees(3.0),
                   .velocity = {.forward_mm_per_s = 40, .left_mm_per_s = -10, .turn_mrad_per_s = 300},
                   .phase = degrees(30.0),
                   .swing = hal::Side::kRight});
  const double kTurnPerRad = kTurnPerDegree / test::kRadPerDegree;
  expect(Signal::kRoll, 0, -5.0 * kTurnPerDegree, 24);
  expect(Signal::kPitch, 0, 12.0 * kTurnPerDegree, 24);
  expect(Signal::kPlannedPitch, 0, 3.0 * kTurnPerDegree, 24);
  expect(Signal::kUpX, 0, 0.6, 24);
  expect(Signal::kUpX, 2, 0.8, 24);
  expect(Signal::kRollRate, 0, 1.0 * kTurnPerRad, 20);
  expect(Signal::kRollRate, 1, -2.0 * kTurnPerRad, 20);
  expect(Signal::kAccelerationX, 2, 9.80665, 16);
  expect(Signal::kVelocity, 0, 40.0, 14);
  expect(Signal::kVelocity, 1, -10.0, 14);
  expect(Signal::kVelocity, 2, 300.0, 14);
  expect(Signal::kLoad, 0, 7.5, 16);
  expect(Signal::kLoad, 1, 4.5, 16);
  expect(Signal::kZmp, 3, -0.012, 24);
  expect(Signal::kPhaseSine, 0, 0.5, 24);
  expect(Signal::kPhaseCosine, 0, std::sqrt(0.75), 24);
  expect(Signal::kSwing, 0, -1.0, 24);
  expect(Signal::kJointAngle, 7, 33.0 * kTurnPerDegree, 24);
  expect(Signal::kJointTarget, 7, 34.0 * kTurnPerDegree, 24);
  expect(Signal::kJointRate, 7, 0.0, 20);
}

TEST_F(SignalsOfACycle, HaveRatesFromTheSecondCycleOn) {
  const auto update = [&] { signals_.update({.robot = robot_, .angles = angles_, .targets = targets_}); };
  angles_[3] = degrees(-170.0);
  update();
  EXPECT_EQ(at(Signal::kJointRate, 3), 0);
  angles_[3] = degrees(-168.0);
  update();
  expect(Signal::kJointRate, 3, 200.0 * kTurnPerDegree, 20, 8.0);
  signals_.forget();
  angles_[3] = degrees(160.0);
  update();
  EXPECT_EQ(at(Signal::kJointRate, 3), 0);
  EXPECT_EQ(at(Signal::kPhaseSine), 0);
  EXPECT_EQ(at(Signal::kPhaseCosine), 0);
  EXPECT_EQ(at(Signal::kSwing), 0);
}

TEST_F(SignalsOfACycle, AreBoundedForEveryState) {
  constexpr std::int32_t kLow = std::numeric_limits<std::int32_t>::min();
  const auto extreme = [&](std::int32_t raw) {
    robot_.roll = robot_.pitch = fixed::Angle::from_raw(raw);
    robot_.up_B.x = fixed::Ratio::from_raw(raw);
    robot_.rates_B.x = fixed::AngularRate::from_raw(raw);
    robot_.accelerations_B.x = fixed::Acceleration::from_raw(raw);
    robot_.feet[0].load = fixed::Force::from_raw(raw);
    robot_.feet[0].x = fixed::Length::from_raw(raw);
    angles_.fill(fixed::Angle::from_raw(raw));
    targets_.fill(fixed::Angle::from_raw(raw));
    const auto v = static_cast<std::int16_t>(raw >> 16);
    signals_.update({.robot = robot_, .angles = angles_, .targets = targets_, .velocity = {v, v, v}});
    for (const std::int32_t value : signals_.values()) {
      ASSERT_LE(value, kMaxSignal);
      ASSERT_GE(value, -kMaxSignal);
    }
  };
  extreme(kLow);
  extreme(std::numeric_limits<std::int32_t>::max());
  extreme(kLow);
}

}  // namespace
}  // namespace koboshi::policy
