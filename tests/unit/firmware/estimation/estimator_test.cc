// The first stage alone: takes samples, returns a RobotState. Uses no bus or board.

#include "firmware/estimation/estimator.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/firmware/robot/test_robot.h"

namespace koboshi::estimation {
namespace {

using fixed::to_double;
using test::kCountsPerRadPerS;
using test::kRadPerDegree;

constexpr bool kRests = true;
constexpr bool kMoves = false;

class EstimatorTest : public testing::Test {
 protected:
  // Runs a cycle of ten samples. The IMU's x points forward, its z up.
  const RobotState& cycle(const hal::ImuSample& sample, bool rests) {
    for (int i = 0; i < 10; ++i) estimator.add(sample, now_us += 1'000);
    return estimator.update(angles, rests, now_us);
  }
  const RobotState& run(int cycles, const hal::ImuSample& sample, bool rests) {
    for (int i = 0; i < cycles; ++i) cycle(sample, rests);
    return estimator.state();
  }
  static hal::ImuSample at_rest(double pitch_rad = 0.0) {
    const double counts_per_g = 9.80665 / 39.2 * 32768;
    return {
        .accelerometer_raw = {static_cast<std::int16_t>(std::lround(-std::sin(pitch_rad) * counts_per_g)), 0,
                              static_cast<std::int16_t>(std::lround(std::cos(pitch_rad) * counts_per_g))}};
  }
  static hal::ImuSample turning(double rate_rad_per_s) {
    hal::ImuSample sample = at_rest();
    sample.gyro_raw[1] = static_cast<std::int16_t>(std::lround(rate_rad_per_s * kCountsPerRadPerS));
    return sample;
  }

  robot::RobotModel model = test::make_test_robot();
  std::array<fixed::Angle, robot::kMaxJoints> angles{};
  Estimator estimator{model};
  std::uint64_t now_us = 0;
};

TEST_F(EstimatorTest, IsInvalidBeforeTheFirstSample) {
  const RobotState& state = estimator.update(angles, kRests, 10'000);
  EXPECT_EQ(state.inertial_age_us, RobotState::kNever);
  EXPECT_EQ(state.ankle_age_us[0], RobotState::kNever);
  EXPECT_FALSE(state.gyro_known);
  EXPECT_FALSE(state.zmp.valid);
}

TEST_F(EstimatorTest, EndsNoCalibrationThatNobodyBegan) {
  for (int i = 0; i < 250; ++i) {
    cycle(at_rest(), kRests);
    ASSERT_EQ(estimator.calibration(), Estimator::Calibration::kNone) << i;
  }
  EXPECT_TRUE(estimator.state().gyro_known);
  cycle(turning(1.0), kMoves);
  EXPECT_EQ(estimator.calibration(), Estimator::Calibration::kNone);
}

TEST_F(EstimatorTest, EstimatesTheLeanOfTheTrunk) {
  const RobotState& state = run(100, at_rest(10 * kRadPerDegree), kRests);
  EXPECT_NEAR(to_double(state.pitch) / kRadPerDegree, 10.0, 0.1);
  EXPECT_NEAR(to_double(state.roll), 0.0, 1e-3);
}

TEST_F(EstimatorTest, ReportsTheAgeOfItsSamples) {
  cycle(at_rest(), kRests);
  estimator.add(hal::Side::kRight, {}, now_us);
  const RobotState& state = estimator.update(angles, kRests, now_us + 30'000);
  EXPECT_EQ(state.inertial_age_us, 30'000u);
  EXPECT_EQ(state.ankle_age_us[0], RobotState::kNever);
  EXPECT_EQ(state.ankle_age_us[1], 30'000u);
}

TEST_F(EstimatorTest, MeasuresTheGyrosBiasInASecondOfRest) {
  EXPECT_FALSE(run(99, turning(0.1), kRests).gyro_known);
  const RobotState& state = cycle(turning(0.1), kRests);
  EXPECT_TRUE(state.gyro_known);
  EXPECT_EQ(estimator.gyro_calibrations(), 1u);
  EXPECT_NEAR(to_double(state.rates_B.y), 0.0, 1e-3);
}

TEST_F(EstimatorTest, DoesNotMistakeARotationForABias) {
  EXPECT_NEAR(to_double(run(200, turning(0.1), kMoves).rates_B.y), 0.1, 1e-3);
  EXPECT_EQ(estimator.gyro_calibrations(), 0u);
}

TEST_F(EstimatorTest, UsesAStoredBias) {
  estimator.assume_gyro_bias({{}, fixed::from_double<fixed::AngularRate>(0.1), {}});
  const RobotState& state = run(20, turning(0.1), kMoves);
  EXPECT_TRUE(state.gyro_known);
  EXPECT_NEAR(to_double(state.rates_B.y), 0.0, 1e-3);
}

TEST_F(EstimatorTest, EndsACalibrationAfterASecondOfRest) {
  run(50, at_rest(), kRests);
  estimator.begin_calibration();
  run(99, at_rest(), kRests);
  EXPECT_EQ(estimator.calibration(), Estimator::Calibration::kNone);
  cycle(at_rest(), kRests);
  EXPECT_EQ(estimator.calibration(), Estimator::Calibration::kDone);
  cycle(at_rest(), kRests);
  EXPECT_EQ(estimator.calibration(), Estimator::Calibration::kNone) << "it has ended once";
}

TEST_F(EstimatorTest, AbortsACalibrationWhenTheRobotMoves) {
  estimator.begin_calibration();
  run(50, at_rest(), kRests);
  cycle(at_rest(), kMoves);
  EXPECT_EQ(estimator.calibration(), Estimator::Calibration::kMoved);
}

TEST_F(EstimatorTest, FindsTheZmpUnderTheFootThatCarries) {
  // 20 N at a full scale of 32768 counts, vertically through the right ankle.
  hal::AnkleSample loaded;
  loaded.force_raw[2] =
      static_cast<std::int16_t>(std::lround(20.0 / to_double(model.scales.ankle_force) * 32768));
  cycle(at_rest(), kRests);
  estimator.add(hal::Side::kRight, loaded, now_us);
  const RobotState& state = cycle(at_rest(), kRests);
  EXPECT_TRUE(state.zmp.valid);
  EXPECT_EQ(state.zmp.frame, hal::Side::kRight);
  EXPECT_TRUE(state.feet[1].valid);
  EXPECT_FALSE(state.feet[0].valid);
  EXPECT_GT(to_double(state.centre_of_mass.z), 0.05) << "over the sole";
}

using EstimatorDeathTest = EstimatorTest;

TEST_F(EstimatorDeathTest, RequiresAnAngleOfEveryJoint) {
  EXPECT_DEATH(estimator.update(std::span(angles).first(model.joint_count - 1), kRests, 0), "joint_count");
}

}  // namespace
}  // namespace koboshi::estimation
