#include "simulation/observe/walk_observer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "sim_board/description/load.h"

namespace koboshi::simulation {
namespace {

constexpr std::uint8_t kWalk = 3;

// A walk that the test defines tick by tick. The plan's support foot is the right one, with the ZMP at (0.01,
// 0) in its frame.
class Walk : public testing::Test {
 protected:
  Walk() {
    said_.state = behaviour::State::kMotion;
    said_.motion = kWalk;
    truth_.X_WSole = {Eigen::Isometry3d(Eigen::Translation3d(0.0, 0.03, 0.0)),
                      Eigen::Isometry3d(Eigen::Translation3d(0.0, -0.03, 0.0))};
  }

  GaitInstant plan(double time_s) {
    planned_for_s_.push_back(time_s);
    GaitInstant instant;
    instant.support = hal::Side::kRight;
    instant.zmp_S_m = {0.01, 0.0};
    return instant;
  }
  void tick(double x_m, double y_m, double yaw_rad) {
    truth_.p_WB_W = {x_m, y_m, 0.17};
    truth_.rpy_rad.z() = yaw_rad;
    observer_.observe_tick(truth_, said_);
  }

  const sim_board::RobotDescription robot_ =
      sim_board::load_robot(KOBOSHI_SOURCE_DIR "/robots/koboshi/robot.sdf");
  Telemetry said_;
  GroundTruth truth_;
  std::vector<double> planned_for_s_;
  WalkObserver observer_{robot_, {}, [this](double time_s) { return plan(time_s); }, kWalk};
};

TEST_F(Walk, StartsWithItsOwnMotionOnly) {
  said_.state = behaviour::State::kStanding;
  tick(0.0, 0.0, 0.0);
  said_.state = behaviour::State::kMotion;
  said_.motion = kWalk - 1;
  tick(0.0, 0.0, 0.0);
  EXPECT_FALSE(observer_.summary());
  said_.motion = kWalk;
  tick(0.0, 0.0, 0.0);
  EXPECT_TRUE(observer_.summary());
}

TEST_F(Walk, IsMeasuredAlongTheHeadingAtItsStart) {
  const double heading_rad = 0.5;
  const Eigen::Vector2d ahead(std::cos(heading_rad), std::sin(heading_rad));
  const Eigen::Vector2d left(-ahead.y(), ahead.x());
  for (int i = 0; i <= 100; ++i) {
    const Eigen::Vector2d p_m = Eigen::Vector2d(3.0, 2.0) + 0.002 * i * ahead - 0.0001 * i * left;
    tick(p_m.x(), p_m.y(), heading_rad + 0.001 * i);
  }
  const auto summary = observer_.summary();
  EXPECT_NEAR(summary->distance_m, 0.2, 1e-12);
  EXPECT_NEAR(summary->speed_m_per_s, 0.2, 1e-12);
  EXPECT_NEAR(summary->lateral_drift_m, -0.01, 1e-12);
  EXPECT_NEAR(summary->heading_drift_rad, 0.1, 1e-12);
}

TEST_F(Walk, CountsTurnsBeyondHalfATurn) {
  for (int i = 0; i <= 40; ++i) tick(0.0, 0.0, std::remainder(0.1 * i, 2.0 * M_PI));
  EXPECT_NEAR(observer_.summary()->heading_drift_rad, 4.0, 1e-12);
}

TEST_F(Walk, EndsForGoodWithItsMotionOrAFall) {
  tick(0.0, 0.0, 0.0);
  tick(0.1, 0.0, 0.0);
  said_.state = behaviour::State::kStanding;
  tick(0.2, 0.0, 0.0);
  said_.state = behaviour::State::kMotion;
  tick(0.3, 0.0, 0.0);
  EXPECT_NEAR(observer_.summary()->distance_m, 0.1, 1e-12);
  EXPECT_FALSE(observer_.planned_zmp_W(truth_));

  WalkObserver falls(
      robot_, {}, [this](double time_s) { return plan(time_s); }, kWalk);
  truth_.p_WB_W.x() = 0.0;
  falls.observe_tick(truth_, said_);
  truth_.tilt_rad = 1.1;
  truth_.p_WB_W.x() = 0.5;
  falls.observe_tick(truth_, said_);
  EXPECT_EQ(falls.summary()->distance_m, 0.0);
}

TEST_F(Walk, ComparesWithThePlanAtTheDrivesTime) {
  for (int i = 0; i < 3; ++i) tick(0.0, 0.0, 0.0);
  ASSERT_EQ(planned_for_s_.size(), 3u);
  EXPECT_NEAR(planned_for_s_[0], -0.00265, 1e-12);
  EXPECT_NEAR(planned_for_s_[2], 0.01735, 1e-12);
}

TEST_F(Walk, ComparesZmpsInThePlannedSupportsFrameWhileValid) {
  tick(0.0, 0.0, 0.0);
  EXPECT_TRUE(std::isnan(observer_.summary()->zmp_rms_error_m));
  said_.zmp = {.x_m = 0.013, .y_m = -0.06 + 0.004, .valid = true, .frame = hal::Side::kLeft};
  tick(0.0, 0.0, 0.0);
  EXPECT_NEAR(observer_.summary()->zmp_rms_error_m, 0.005, 1e-12);
  EXPECT_LT((*observer_.planned_zmp_W(truth_) - Eigen::Vector3d(0.01, -0.03, 0.0)).norm(), 1e-12);
}

TEST_F(Walk, PlacesTheZmpThatTheControllerPlansAtItsFoot) {
  said_.state = behaviour::State::kWalking;
  said_.planned_zmp = {.x_m = 0.02, .y_m = 0.01, .valid = true, .frame = hal::Side::kRight};
  tick(0.0, 0.0, 0.0);
  const Eigen::Vector3d planned_W = truth_.X_WSole[1] * Eigen::Vector3d(0.02, 0.01, 0.0);
  ASSERT_TRUE(observer_.planned_zmp_W(truth_));
  EXPECT_LT((*observer_.planned_zmp_W(truth_) - planned_W).norm(), 1e-12);
  EXPECT_TRUE(std::isnan(observer_.summary()->zmp_rms_error_m));
  said_.planned_zmp.valid = false;
  tick(0.0, 0.0, 0.0);
  EXPECT_FALSE(observer_.planned_zmp_W(truth_));
}

// A ZMP that swings as planned, but 25 ms late and 4 mm to the side.
TEST_F(Walk, SeparatesLagAndErrorOfTheZmp) {
  const auto swinging = [](double time_s) {
    GaitInstant instant;
    instant.support = hal::Side::kRight;
    instant.zmp_S_m = {0.0, 0.03 * std::sin(2.0 * std::numbers::pi * time_s / 0.7)};
    return instant;
  };
  for (const double lag_s : {0.025, -0.025}) {
    WalkObserver observer(robot_, {}, swinging, kWalk);
    for (int i = 0; i < 500; ++i) {
      // Telemetry contains values measured one tick ago; the drives follow a plan that is 2.65 ms older.
      const Eigen::Vector2d zmp_S_m = swinging(0.01 * (i - 1) - 0.00265 - lag_s).zmp_S_m;
      said_.zmp = {.x_m = 0.004, .y_m = zmp_S_m.y(), .valid = true, .frame = hal::Side::kRight};
      observer.observe_tick(truth_, said_);
    }
    EXPECT_NEAR(observer.summary()->zmp_lag_s, lag_s, 1e-9);
    EXPECT_NEAR(observer.summary()->zmp_rms_error_m, 0.004, 1e-9);
  }
}

TEST_F(Walk, ReportsTheRollOfTheTrunk) {
  for (int i = 0; i < 100; ++i) {
    truth_.rpy_rad.x() = i % 2 == 0 ? 0.03 : -0.03;
    observer_.observe_tick(truth_, said_);
  }
  EXPECT_NEAR(observer_.summary()->roll_rms_rad, 0.03, 1e-12);
}

// Steps of 5, 6 and 9 mm; the phase after the last step is not complete.
TEST_F(Walk, ReportsTheLiftOfTheSteps) {
  const auto foot = [&](std::size_t side, double load_N, double height_m) {
    truth_.foot_load_N[side] = load_N;
    truth_.foot_height_m[side] = height_m;
    tick(0.0, 0.0, 0.0);
  };
  truth_.foot_load_N = {6.0, 6.0};
  for (const double lift_m : {0.005, 0.009, 0.006}) {
    foot(1, 0.0, 0.5 * lift_m);
    foot(1, 0.0, lift_m);
    foot(1, 6.0, 0.0);
  }
  foot(0, 0.0, 0.02);
  EXPECT_NEAR(observer_.summary()->foot_lift_m, 0.006, 1e-12);
}

TEST_F(Walk, ByCommandNeedsNoPlan) {
  WalkObserver observer(robot_, {});
  const auto tick_at = [&](double x_m) {
    truth_.p_WB_W = {x_m, 0.0, 0.17};
    observer.observe_tick(truth_, said_);
  };
  tick_at(0.0);  // any motion
  EXPECT_FALSE(observer.summary());
  said_.state = behaviour::State::kWalking;
  said_.zmp = {.x_m = 0.013, .y_m = 0.0, .valid = true, .frame = hal::Side::kLeft};
  for (int i = 0; i <= 100; ++i) tick_at(0.3 + 0.001 * i);
  EXPECT_FALSE(observer.planned_zmp_W(truth_));
  said_.state = behaviour::State::kStanding;
  tick_at(0.5);
  const auto summary = observer.summary();
  EXPECT_NEAR(summary->distance_m, 0.1, 1e-12);
  EXPECT_NEAR(summary->speed_m_per_s, 0.1, 1e-12);
  EXPECT_TRUE(std::isnan(summary->zmp_rms_error_m));
}

TEST_F(Walk, ReportsTheFifthPercentileOfTheMargin) {
  for (int i = 0; i <= 100; ++i) {
    truth_.zmp_margin_m = 0.001 * (100 - i);
    tick(0.0, 0.0, 0.0);
  }
  truth_.zmp_margin_m.reset();  // airborne
  tick(0.0, 0.0, 0.0);
  EXPECT_NEAR(observer_.summary()->zmp_margin_p05_m, 0.005, 1e-12);
}

}  // namespace
}  // namespace koboshi::simulation
