#include "firmware/policy/residual.h"

#include <gtest/gtest.h>

#include "tests/unit/firmware/policy/policy_builder.h"

namespace koboshi::policy {
namespace {

using test::degrees;

// A policy of one layer without activation: two offsets that follow the trunk's roll, in opposite directions.
class ResidualOfOneLayer : public ::testing::Test {
 protected:
  ResidualOfOneLayer() {
    const auto joints = test::hips_and_ankles(model_);
    left_ = joints[3];
    right_ = joints[7];
    builder_.model_id = model_.id;
    builder_.patience_ticks = 3;
    // 1 degree of roll is 46,603 LSB of the signal and 2,912 of the activation.
    builder_.inputs = {{.signal = 0, .mean = 0, .multiplier = 1 << 28, .low = -500'000, .high = 500'000}};
    // 64 / 2^6: the activation itself.
    builder_.layers = {{.rows = 8, .columns = 8, .multiplier = 1 << 26}};
    builder_.layers[0].biases.resize(8);
    builder_.layers[0].weights.resize(64);
    builder_.layers[0].weights[0] = 64;
    builder_.layers[0].weights[8] = -64;
    // 4,096 LSB of an angle for each: the offset is the roll itself.
    builder_.outputs = {
        {.joint = left_, .scale = 4'096, .bound = degrees(4.0), .rate = degrees(0.5)},
        {.joint = right_, .scale = 4'096, .bound = degrees(4.0), .rate = degrees(0.5)},
    };
    image_ = builder_.image();
    const PolicyVerdict verdict = Policy::open(image_, model_, policy_);
    EXPECT_TRUE(verdict.ok()) << static_cast<int>(verdict.status);
  }

  void advance(int cycles = 1) {
    for (int i = 0; i < cycles; ++i)
      residual_.advance(policy_, {.robot = robot_, .angles = angles_, .targets = angles_});
  }
  double offset_deg(std::size_t output) const {
    return fixed::to_double(residual_.offset(output)) / test::kRadPerDegree;
  }

  robot::RobotModel model_ = test::make_test_robot();
  test::PolicyBuilder builder_;
  std::vector<std::byte> image_;
  Policy policy_;
  estimation::RobotState robot_;
  std::array<fixed::Angle, 20> angles_{};
  Residual residual_;
  std::uint8_t left_ = 0;
  std::uint8_t right_ = 0;
};

TEST_F(ResidualOfOneLayer, MovesToTheOutputsAtTheirRate) {
  robot_.roll = degrees(2.0);
  advance();
  EXPECT_NEAR(offset_deg(0), 0.5, 1e-3);
  EXPECT_NEAR(offset_deg(1), -0.5, 1e-3);
  advance(2);
  EXPECT_NEAR(offset_deg(0), 1.5, 1e-3);
  advance(5);
  EXPECT_NEAR(offset_deg(0), 2.0, 1e-3);
  EXPECT_NEAR(offset_deg(1), -2.0, 1e-3);
  EXPECT_TRUE(residual_.active());
  EXPECT_EQ(residual_.cause(), Cause::kNone);
}

TEST_F(ResidualOfOneLayer, AddsToTheTargetsOfItsJointsAlone) {
  robot_.roll = degrees(1.0);
  advance(10);
  auto targets = angles_;
  targets[left_] = degrees(10.0);
  targets[right_] = fixed::Angle::min();
  residual_.add_to(targets);
  EXPECT_NEAR(fixed::to_double(targets[left_]) / test::kRadPerDegree, 11.0, 1e-3);
  EXPECT_EQ(targets[right_], fixed::Angle::min()) << "the sum has not saturated";
  for (std::size_t joint = 0; joint < targets.size(); ++joint) {
    if (joint == left_ || joint == right_) continue;
    EXPECT_EQ(targets[joint], angles_[joint]);
  }
}

TEST_F(ResidualOfOneLayer, StopsWhenAnOutputStaysBeyondItsBound) {
  robot_.roll = degrees(3.0);
  advance(10);
  robot_.roll = degrees(5.0);
  advance(3);
  EXPECT_EQ(residual_.cause(), Cause::kNone) << "within the patience";
  EXPECT_NEAR(offset_deg(0), 4.0, 1e-3);
  advance();
  EXPECT_EQ(residual_.cause(), Cause::kOutputOutOfRange);
  EXPECT_EQ(residual_.cause_index(), 0);
  EXPECT_NEAR(offset_deg(0), 3.5, 1e-3) << "the way back has its rate, too";
  robot_.roll = {};
  advance(6);
  EXPECT_TRUE(residual_.active());
  advance(2);
  EXPECT_FALSE(residual_.active());
  robot_.roll = degrees(1.0);
  advance(5);
  EXPECT_FALSE(residual_.active()) << "it stays stopped";
}

TEST_F(ResidualOfOneLayer, StopsWhenAnInputStaysOutOfRange) {
  robot_.roll = degrees(30.0);
  advance(3);
  EXPECT_EQ(residual_.cause(), Cause::kNone);
  advance();
  EXPECT_EQ(residual_.cause(), Cause::kInputOutOfRange);
  EXPECT_EQ(residual_.cause_index(), 0);
}

TEST_F(ResidualOfOneLayer, ForgivesShortExcursions) {
  for (int i = 0; i < 10; ++i) {
    robot_.roll = degrees(30.0);
    advance(3);
    robot_.roll = degrees(1.0);
    advance();
  }
  EXPECT_EQ(residual_.cause(), Cause::kNone);
}

TEST_F(ResidualOfOneLayer, HasItsWholePatienceAfterARetreatAndAReset) {
  robot_.roll = degrees(30.0);
  advance(3);
  residual_.retreat(policy_);
  advance(3);
  EXPECT_EQ(residual_.cause(), Cause::kNone);
  residual_.reset();
  advance(3);
  EXPECT_EQ(residual_.cause(), Cause::kNone);
  advance();
  EXPECT_EQ(residual_.cause(), Cause::kInputOutOfRange);
}

TEST_F(ResidualOfOneLayer, BeginsAnewAfterARetreat) {
  robot_.roll = degrees(30.0);
  advance(4);
  EXPECT_EQ(residual_.cause(), Cause::kInputOutOfRange);
  residual_.retreat(policy_);
  EXPECT_EQ(residual_.cause(), Cause::kNone);
  for (int i = 0; i < 10; ++i) residual_.retreat(policy_);
  EXPECT_FALSE(residual_.active());
  robot_.roll = degrees(1.0);
  advance(3);
  EXPECT_NEAR(offset_deg(0), 1.0, 1e-3);
  residual_.reset();
  EXPECT_FALSE(residual_.active());
  EXPECT_EQ(offset_deg(0), 0.0);
}

TEST_F(ResidualOfOneLayer, DeviatesWithinTheBound) {
  robot_.roll = degrees(1.0);
  advance(5);
  const double output_deg = offset_deg(0);
  residual_.deviate({degrees(0.5)});
  advance(5);
  EXPECT_NEAR(offset_deg(0), output_deg + 0.5, 1e-3);
  residual_.deviate({fixed::Angle::min()});
  advance(100);
  EXPECT_NEAR(offset_deg(0), -4.0, 1e-3);
  EXPECT_EQ(residual_.cause(), Cause::kNone) << "only the policy's own outputs are watched";
  residual_.deviate({});
  advance(100);
  EXPECT_NEAR(offset_deg(0), output_deg, 1e-3);
}

TEST_F(ResidualOfOneLayer, DoesNotDeviateOnceItIsStopped) {
  residual_.deviate({degrees(0.5)});
  robot_.roll = degrees(30.0);
  advance(50);
  EXPECT_EQ(residual_.cause(), Cause::kInputOutOfRange);
  EXPECT_FALSE(residual_.active());
}

}  // namespace
}  // namespace koboshi::policy
