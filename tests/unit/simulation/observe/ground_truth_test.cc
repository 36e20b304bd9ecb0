#include "simulation/observe/ground_truth.h"

#include <gtest/gtest.h>

#include <numbers>
#include <vector>

#include "sim_board/description/load.h"
#include "tests/unit/simulation/observe/staged_world.h"

namespace koboshi::simulation {
namespace {

class Truth : public testing::Test {
 protected:
  const sim_board::RobotDescription robot_ =
      sim_board::load_robot(KOBOSHI_SOURCE_DIR "/robots/koboshi/robot.sdf");
  const int left_foot_ = robot_.joints[static_cast<std::size_t>(robot_.left_ankle->joint)].child;
  const Telemetry telemetry_;
  StagedWorld world_{robot_};
  TruthObserver observer_{robot_};
};

TEST_F(Truth, PoseHeightIsThatOfTheTrunkAboveTheSoles) {
  EXPECT_NEAR(observer_.observe(world_, telemetry_).pose_height_m, 0.17, 1e-6);
  Telemetry bent;
  for (const char* side : {"left", "right"}) {
    const std::string prefix = std::string(side) + "_";
    bent.joints[static_cast<std::size_t>(*robot_.find_joint(prefix + "hip_pitch"))].target_rad = -0.5;
    bent.joints[static_cast<std::size_t>(*robot_.find_joint(prefix + "knee"))].target_rad = 1.0;
    bent.joints[static_cast<std::size_t>(*robot_.find_joint(prefix + "ankle_pitch"))].target_rad = -0.5;
  }
  // Thigh and shank of 65 mm are each inclined by half a radian.
  EXPECT_NEAR(observer_.observe(world_, bent).pose_height_m, 0.04 + 2 * 0.065 * std::cos(0.5), 1e-6);
}

// A robot that walks down a slope is no nearer to the ground than before.
TEST_F(Truth, HeightIsAboveTheGroundBelowTheTrunk) {
  const double slope_rad = 0.04;
  const Eigen::Vector3d normal_W(std::sin(slope_rad), 0.0, std::cos(slope_rad));
  sim_board::GroundDescription ground;
  ground.normal_W = normal_W;
  TruthObserver on_slope(robot_, ground);
  const double x_m = 3.0;
  world_.pose(Eigen::Isometry3d(Eigen::Translation3d(x_m, 0.0, 0.17 - x_m * std::tan(slope_rad))));
  EXPECT_NEAR(on_slope.observe(world_, telemetry_).height_m, 0.17 * std::cos(slope_rad), 1e-9);
  ground.present = false;
  TruthObserver without_ground(robot_, ground);
  EXPECT_NEAR(without_ground.observe(world_, telemetry_).height_m, 0.17 - x_m * std::tan(slope_rad), 1e-12);
}

TEST_F(Truth, TiltAndAnglesAreThoseOfTheTrunk) {
  world_.pose(Eigen::Translation3d(0.0, 0.0, 0.17) * Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitZ()) *
              Eigen::AngleAxisd(0.2, Eigen::Vector3d::UnitY()) *
              Eigen::AngleAxisd(-0.1, Eigen::Vector3d::UnitX()));
  const GroundTruth& truth = observer_.observe(world_, telemetry_);
  EXPECT_NEAR(truth.rpy_rad.x(), -0.1, 1e-12);
  EXPECT_NEAR(truth.rpy_rad.y(), 0.2, 1e-12);
  EXPECT_NEAR(truth.rpy_rad.z(), 0.3, 1e-12);
  EXPECT_NEAR(truth.tilt_rad, std::acos(std::cos(0.2) * std::cos(0.1)), 1e-12);
}

TEST_F(Truth, FootHeightIsThatOfItsLowestCorner) {
  world_.pose(Eigen::Isometry3d(Eigen::Translation3d(0.0, 0.0, 0.18)));
  EXPECT_NEAR(observer_.observe(world_, telemetry_).foot_height_m[0], 0.01, 1e-9);
  world_.pose(Eigen::Translation3d(0.0, 0.0, 0.2) * Eigen::AngleAxisd(0.1, Eigen::Vector3d::UnitY()));
  const GroundTruth& pitched = observer_.observe(world_, telemetry_);
  for (std::size_t side = 0; side < 2; ++side) {
    const double centre_m = pitched.X_WSole[side].translation().z();
    EXPECT_LT(pitched.foot_height_m[side], centre_m - 0.003);  // each sole is 100 mm long
    EXPECT_GT(pitched.foot_height_m[side], centre_m - 0.008);
  }
}

TEST_F(Truth, SlipIsCountedFromTheLoadingOfAFoot) {
  world_.load(left_foot_, 6.0);
  observer_.observe(world_, telemetry_);
  world_.pose(Eigen::Isometry3d(Eigen::Translation3d(0.003, 0.004, 0.17)));
  const GroundTruth& slid = observer_.observe(world_, telemetry_);
  EXPECT_NEAR(slid.foot_slip_m[0], 0.005, 1e-12);
  EXPECT_EQ(slid.foot_slip_m[1], 0.0);  // the foot carries no load
  EXPECT_EQ(slid.foot_load_N[0], 6.0);

  world_.unload();
  EXPECT_EQ(observer_.observe(world_, telemetry_).foot_slip_m[0], 0.0);
  world_.load(left_foot_, 6.0);
  EXPECT_EQ(observer_.observe(world_, telemetry_).foot_slip_m[0], 0.0);
}

TEST_F(Truth, ZmpOfBothFeetLiesBetweenThemByTheirLoads) {
  const int right_foot = robot_.joints[static_cast<std::size_t>(robot_.right_ankle->joint)].child;
  world_.load(left_foot_, 9.0, {0.01, 0.035, 0.0});
  world_.load(right_foot, 3.0, {0.03, -0.03, 0.0});
  const GroundTruth& truth = observer_.observe(world_, telemetry_);
  EXPECT_LT((*truth.foot_zmp_S_m[0] - Eigen::Vector2d(0.01, 0.005)).norm(), 1e-12);
  EXPECT_LT((*truth.foot_zmp_S_m[1] - Eigen::Vector2d(0.03, 0.0)).norm(), 1e-12);
  EXPECT_LT((*truth.p_WZmp_W - Eigen::Vector3d(0.015, 0.01875, 0.0)).norm(), 1e-12);
  // The soles extend 38 mm behind and 62 mm in front of the ankles, and laterally 28 mm to each side of 30
  // mm.
  EXPECT_NEAR(*truth.zmp_margin_m, 0.058 - 0.01875, 1e-9);
}

TEST_F(Truth, ZmpIsInvalidBelowTheLoadThreshold) {
  world_.load(left_foot_, 0.9, {0.01, 0.03, 0.0});
  const GroundTruth& truth = observer_.observe(world_, telemetry_);
  EXPECT_FALSE(truth.foot_zmp_S_m[0]);
  EXPECT_FALSE(truth.p_WZmp_W);
  EXPECT_FALSE(truth.zmp_margin_m);
}

}  // namespace
}  // namespace koboshi::simulation
