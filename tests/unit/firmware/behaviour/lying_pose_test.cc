#include "firmware/behaviour/lying_pose.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "firmware/fixed/host/convert.h"
#include "tests/unit/firmware/robot/test_robot.h"

namespace koboshi::behaviour {
namespace {

// Roll about x, then pitch about y.
robot::Direction up(double roll_deg, double pitch_deg) {
  const double roll = roll_deg * std::numbers::pi / 180.0;
  const double pitch = pitch_deg * std::numbers::pi / 180.0;
  const auto ratio = [](double value) { return fixed::from_double<fixed::Ratio>(value); };
  return {.x = ratio(-std::sin(pitch)),
          .y = ratio(std::sin(roll) * std::cos(pitch)),
          .z = ratio(std::cos(roll) * std::cos(pitch))};
}

// Classifies a trunk with the thighs in line with it.
LyingPose classify_straight(const robot::Direction& up_B) { return classify(up_B, test::degrees(0)); }

TEST(LyingPoseTest, HasAName) {
  EXPECT_EQ(classify_straight(up(0, 0)), LyingPose::kUpright);
  EXPECT_EQ(classify_straight(up(0, 90)), LyingPose::kProne);
  EXPECT_EQ(classify_straight(up(0, -90)), LyingPose::kSupine);
  EXPECT_EQ(classify_straight(up(-90, 0)), LyingPose::kLeftSide);
  EXPECT_EQ(classify_straight(up(90, 0)), LyingPose::kRightSide);
}

TEST(LyingPoseTest, IsTheNearerOfTwoAndASideFromItsShoulderOn) {
  EXPECT_EQ(classify_straight(up(0, 14)), LyingPose::kUpright);
  EXPECT_EQ(classify_straight(up(0, 16)), LyingPose::kProne);
  EXPECT_EQ(classify_straight(up(0, -16)), LyingPose::kSupine);
  for (const double roll : {-89.0, 89.0}) {
    EXPECT_EQ(classify_straight(up(roll, 50)), LyingPose::kProne);
    EXPECT_EQ(classify_straight(up(roll, -50)), LyingPose::kSupine);
    EXPECT_EQ(classify_straight(up(roll, 30)), roll < 0 ? LyingPose::kLeftSide : LyingPose::kRightSide);
  }
}

TEST(LyingPoseTest, OnTheHeadIsTheSideOfItsLean) {
  EXPECT_EQ(classify_straight(up(180, 20)), LyingPose::kProne);
  EXPECT_EQ(classify_straight(up(180, -20)), LyingPose::kSupine);
  EXPECT_EQ(classify_straight(up(150, 0)), LyingPose::kRightSide);
}

TEST(LyingPoseTest, SitsWhenTheThighsAreRaised) {
  for (const double pitch : {-50.0, -20.0, 0.0, 30.0, 50.0}) {
    EXPECT_EQ(classify(up(0, pitch), test::degrees(-90)), LyingPose::kSitting) << pitch;
  }
  EXPECT_EQ(classify(up(30, 0), test::degrees(-90)), LyingPose::kSitting);
  EXPECT_EQ(classify(up(0, 0), test::degrees(-44)), LyingPose::kUpright);  // on bent legs
  EXPECT_EQ(classify(up(0, -55), test::degrees(-170)), LyingPose::kSupine);
  EXPECT_EQ(classify(up(0, 90), test::degrees(-30)), LyingPose::kProne);
}

TEST(LyingPoseTest, IsUprightWithinFifteenDegrees) {
  EXPECT_TRUE(is_upright(up(0, 14)));
  EXPECT_FALSE(is_upright(up(-16, 0)));
}

TEST(LyingPoseTest, IsDownBeyondSixtyDegrees) {
  EXPECT_FALSE(is_down(up(0, 59)));
  EXPECT_TRUE(is_down(up(0, 61)));
  EXPECT_TRUE(is_down(up(-61, 0)));
  EXPECT_TRUE(is_down(up(180, 0)));
  EXPECT_FALSE(is_down(up(0, 0)));
}

TEST(LyingPoseTest, CanRestOnItsFeetWithinThirtyDegrees) {
  EXPECT_TRUE(can_rest_on_feet(up(0, 29)));
  EXPECT_TRUE(can_rest_on_feet(up(-29, 0)));
  EXPECT_FALSE(can_rest_on_feet(up(0, -31)));
  EXPECT_FALSE(can_rest_on_feet(up(180, 0)));
}

}  // namespace
}  // namespace koboshi::behaviour
