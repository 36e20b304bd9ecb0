#include "firmware/balance/feedback.h"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "firmware/robot/kinematics.h"
#include "firmware/robot/model_check.h"
#include "tests/unit/firmware/robot/test_robot.h"

namespace koboshi::balance {
namespace {

using fixed::Angle;
using fixed::AngularRate;
using fixed::from_double;
using fixed::to_double;

constexpr JointGains kTenth{
    .ankle_pitch = 410, .ankle_roll = 410, .hip_roll = 410, .knee = 410, .hip_pitch = 410};
constexpr FeedbackGains kTenthOfASecond{.rate = kTenth, .lean = {}};

estimation::TrunkMotion rates(double roll_rad_per_s, double pitch_rad_per_s) {
  return {.roll_rate = from_double<AngularRate>(roll_rad_per_s),
          .pitch_rate = from_double<AngularRate>(pitch_rad_per_s),
          .roll = {},
          .pitch = {}};
}

estimation::TrunkMotion lean(double roll_rad, double pitch_rad) {
  return {.roll_rate = {},
          .pitch_rate = {},
          .roll = from_double<Angle>(roll_rad),
          .pitch = from_double<Angle>(pitch_rad)};
}

class FeedbackTest : public testing::Test {
 protected:
  void SetUp() override { ASSERT_EQ(robot::check_model(model), robot::ModelStatus::kOk); }
  std::vector<Angle> corrected(const FeedbackGains& gains, const estimation::TrunkMotion& trunk) const {
    std::vector<Angle> targets = pose;
    Feedback(model).correct(gains, trunk, targets);
    return targets;
  }
  double change_rad(const std::vector<Angle>& targets, std::size_t joint) const {
    return to_double(targets[joint] - pose[joint]);
  }
  // Returns the rotation of the trunk B about axis i in the sole frame when the foot of this side stays in
  // place.
  double trunk_turn_rad(const std::vector<Angle>& targets, hal::Side side, std::size_t axis) const {
    robot::LinkPoses before;
    robot::LinkPoses after;
    robot::forward_kinematics(model, pose, before);
    robot::forward_kinematics(model, targets, after);
    // R_SoleB after . (R_SoleB before)^T; its skew part is the small rotation.
    const robot::Rotation turn =
        robot::transpose(robot::sole_pose(model, side, after).R) * robot::sole_pose(model, side, before).R;
    return axis == 0 ? to_double(turn.rows[2].y) : to_double(turn.rows[0].z);
  }

  robot::RobotModel model = test::make_test_robot();
  std::vector<Angle> pose = [] {
    std::vector<Angle> squat(20);
    for (const std::size_t leg : {0u, 6u}) {
      squat[leg + 2] = test::degrees(-20);
      squat[leg + 3] = test::degrees(40);
      squat[leg + 4] = test::degrees(-20);
    }
    return squat;
  }();
};

TEST_F(FeedbackTest, ChangesNoBitWithoutGains) { EXPECT_EQ(corrected({}, rates(10, -10)), pose); }

TEST_F(FeedbackTest, AddsGainTimesRate) {
  const auto targets = corrected(
      {.rate = {.ankle_pitch = 205, .ankle_roll = 123, .hip_roll = -82, .knee = 41, .hip_pitch = 20},
       .lean = {}},
      rates(0.5, 1.0));
  for (const std::size_t leg : {0u, 6u}) {
    EXPECT_NEAR(change_rad(targets, leg + 1), -82.0 / 4096 * 0.5, 1e-8);
    EXPECT_NEAR(change_rad(targets, leg + 3), 41.0 / 4096 * 1.0, 1e-8);
    EXPECT_NEAR(change_rad(targets, leg + 4), 205.0 / 4096 * 1.0, 1e-8);
    EXPECT_NEAR(change_rad(targets, leg + 5), 123.0 / 4096 * 0.5, 1e-8);
    EXPECT_NEAR(change_rad(targets, leg + 2), 20.0 / 4096 * 1.0, 1e-8);
    EXPECT_EQ(targets[leg], pose[leg]);  // hip yaw
  }
  for (std::size_t joint = 12; joint < 20; ++joint) EXPECT_EQ(targets[joint], pose[joint]);
}

TEST_F(FeedbackTest, AddsGainTimesLean) {
  const auto targets = corrected(
      {.rate = {},
       .lean = {.ankle_pitch = 2050, .ankle_roll = 1230, .hip_roll = -820, .knee = 410, .hip_pitch = 200}},
      lean(0.1, -0.2));
  for (const std::size_t leg : {0u, 6u}) {
    EXPECT_NEAR(change_rad(targets, leg + 1), -820.0 / 4096 * 0.1, 1e-8);
    EXPECT_NEAR(change_rad(targets, leg + 2), 200.0 / 4096 * -0.2, 1e-8);
    EXPECT_NEAR(change_rad(targets, leg + 3), 410.0 / 4096 * -0.2, 1e-8);
    EXPECT_NEAR(change_rad(targets, leg + 4), 2050.0 / 4096 * -0.2, 1e-8);
    EXPECT_NEAR(change_rad(targets, leg + 5), 1230.0 / 4096 * 0.1, 1e-8);
  }
}

TEST_F(FeedbackTest, AddsRateAndLean) {
  const FeedbackGains gains{.rate = {.ankle_pitch = 410}, .lean = {.ankle_pitch = 2048}};
  estimation::TrunkMotion trunk = rates(0, -0.5);
  trunk.pitch = from_double<Angle>(0.2);
  EXPECT_NEAR(change_rad(corrected(gains, trunk), 4), 0.5 * 0.2 - 410.0 / 4096 * 0.5, 5e-8);
}

// Checks the sign of each gain by the kinematics: when the trunk pitches forward, the response of each joint
// turns it back.
TEST_F(FeedbackTest, TurnsAFallingTrunkBack) {
  const JointGains each[] = {
      {.ankle_pitch = 410}, {.knee = 410}, {.hip_pitch = 410}, {.ankle_roll = 410}, {.hip_roll = 410}};
  for (std::size_t i = 0; i < std::size(each); ++i) {
    const std::size_t axis = i < 3 ? 1 : 0;
    for (const double rate : {0.5, -0.5}) {
      const auto targets =
          corrected({.rate = each[i], .lean = {}}, axis == 0 ? rates(rate, 0) : rates(0, rate));
      for (const hal::Side side : {hal::Side::kLeft, hal::Side::kRight}) {
        EXPECT_NEAR(trunk_turn_rad(targets, side, axis), -410.0 / 4096 * rate, 1e-3) << i << " " << rate;
      }
    }
  }
}

TEST_F(FeedbackTest, PressesTheToesDownInAForwardFall) {
  const auto targets = corrected(kTenthOfASecond, rates(0, 1));
  EXPECT_GT(change_rad(targets, 4), 0.0);  // positive ankle pitch: toes down
  EXPECT_GT(change_rad(targets, 10), 0.0);
}

TEST_F(FeedbackTest, RespectsTheSignOfAJointsAxis) {
  model.joints[4].axis = -robot::kAxisY;
  const auto targets = corrected(kTenthOfASecond, rates(0, 1));
  EXPECT_LT(change_rad(targets, 4), 0.0);
  EXPECT_GT(change_rad(targets, 10), 0.0);
}

TEST_F(FeedbackTest, StopsAtItsBound) {
  const auto targets = corrected(kTenthOfASecond, rates(0, 50));
  EXPECT_EQ(targets[4] - pose[4], Feedback::kMaxCorrection);
  EXPECT_EQ(corrected(kTenthOfASecond, rates(0, -50))[4] - pose[4], -Feedback::kMaxCorrection);
}

TEST_F(FeedbackTest, DoesNotWrapATargetAtHalfATurn) {
  pose[5] = Angle::max();
  EXPECT_EQ(corrected(kTenthOfASecond, rates(1, 0))[5], Angle::max());
}

TEST_F(FeedbackTest, DoesNothingWithoutLegs) {
  model.joint_count = 0;
  EXPECT_EQ(corrected(kTenthOfASecond, rates(1, 1)), pose);
}

// Hips at 45 degrees: yaw and roll share both axes, and one joint alone would also turn the trunk about z.
TEST_F(FeedbackTest, TurnsTheTrunkAboutTheLeanAtObliqueHips) {
  constexpr double kHalf = 0.70710678118655;
  const auto axis = [](double x, double z) {
    return robot::Direction{from_double<fixed::Ratio>(x), {}, from_double<fixed::Ratio>(z)};
  };
  for (const std::size_t leg : {0u, 6u}) {
    model.joints[leg].axis = axis(-kHalf, kHalf);
    model.joints[leg + 1].axis = axis(kHalf, kHalf);
  }
  pose.assign(20, Angle());
  ASSERT_EQ(robot::check_model(model), robot::ModelStatus::kOk);
  const JointGains hips{.ankle_pitch = 0, .ankle_roll = 0, .hip_roll = 410, .knee = 0, .hip_pitch = 410};
  for (const auto& [roll, pitch] : {std::pair{0.1, 0.0}, {0.0, 0.1}, {-0.05, 0.08}}) {
    const auto targets = corrected({.rate = {}, .lean = hips}, lean(roll, pitch));
    for (const std::size_t leg : {0u, 6u}) {
      EXPECT_NEAR(change_rad(targets, leg), -0.1 * roll * kHalf, 1e-5);
      EXPECT_NEAR(change_rad(targets, leg + 1), 0.1 * roll * kHalf, 1e-5);
      EXPECT_NEAR(change_rad(targets, leg + 2), 0.1 * pitch, 1e-5);
    }
    for (const hal::Side side : {hal::Side::kLeft, hal::Side::kRight}) {
      EXPECT_NEAR(std::abs(trunk_turn_rad(targets, side, 0)), std::abs(0.1 * roll), 1e-4);
      EXPECT_NEAR(std::abs(trunk_turn_rad(targets, side, 1)), std::abs(0.1 * pitch), 1e-4);
    }
  }
}

// In a walk, the leg that bears the robot alone; while both do, and in all other modes, both.
TEST_F(FeedbackTest, CorrectsOnlyTheLegThatBearsTheRobotInAWalk) {
  FeedbackParameters parameters;
  parameters.walking = kTenthOfASecond;
  parameters.standing = kTenthOfASecond;
  parameters.motion = kTenth;
  const Feedback feedback(model);
  using enum FeedbackMode;
  for (const FeedbackMode mode : {kWalking, kStanding, kMotion}) {
    for (const auto support :
         {std::optional<hal::Side>(), std::optional(hal::Side::kLeft), std::optional(hal::Side::kRight)}) {
      std::vector<Angle> targets = pose;
      feedback.correct(mode, parameters, rates(0.5, 0.5), support, targets);
      for (const hal::Side side : {hal::Side::kLeft, hal::Side::kRight}) {
        const bool bears = mode != kWalking || !support || *support == side;
        for (const std::size_t place : {1u, 2u, 3u, 4u, 5u}) {
          const std::size_t joint = model.leg(side)[place];
          EXPECT_EQ(targets[joint] != pose[joint], bears) << joint;
        }
      }
    }
  }
}

}  // namespace
}  // namespace koboshi::balance
