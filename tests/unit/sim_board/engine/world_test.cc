#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

#include "sim_board/engine/make_world.h"
#include "sim_board/world/ground_truth.h"
#include "tests/support/sample_robots.h"
#include "tests/unit/sim_board/engine/engines.h"

namespace koboshi::sim_board {
namespace {

using Eigen::Vector3d;
using testing::AllOf;
using testing::HasSubstr;

class WorldInEachEngine : public EachEngine {
 protected:
  static WorldOptions in_the_air() {
    WorldOptions options = EachEngine::options();
    options.ground.present = false;
    return options;
  }
};

TEST_P(WorldInEachEngine, DropsABodyAsGravityDictates) {
  const auto world = make_world(sample_box(0.7, {0.1, 0.2, 0.3}), in_the_air());
  run(*world, 1.0);
  EXPECT_NEAR(world->time_s(), 1.0, 1e-12);
  // Semi-implicit Euler falls g h t / 2 further than the parabola.
  EXPECT_NEAR(world->body(0).X_WL.translation().z(), -0.5 * 9.80665 * (1.0 + 0.001), 1e-9);
  EXPECT_NEAR(world->body(0).v_WCom_W.z(), -9.80665, 1e-9);
}

TEST_P(WorldInEachEngine, PushesForOneStepAtTheGivenPoint) {
  WorldOptions options = in_the_air();
  options.gravity_W_m_per_s2.setZero();
  options.X_WB.linear() = Eigen::AngleAxisd(M_PI / 2, Vector3d::UnitZ()).toRotationMatrix();
  const RobotDescription box = sample_box(0.5, {0.1, 0.2, 0.3});
  const auto world = make_world(box, options);
  const Vector3d f_W(0, 0, 4.0), p_L(0.05, 0, 0);  // the point is at y = 0.05 in the world
  world->push(0, p_L, f_W);
  world->push(0, p_L, f_W);
  run(*world, 0.002);
  EXPECT_NEAR(world->body(0).v_WCom_W.z(), 8.0 * 0.001 / 0.5, 1e-12);
  EXPECT_NEAR(world->body(0).w_WL_W.x(), 8.0 * 0.05 * 0.001 / box.links[0].I_LCom_L(1, 1), 1e-6);
}

TEST_P(WorldInEachEngine, StartsInThePoseOfTheOptions) {
  RobotDescription robot = sample_humanoid();
  for (LinkDescription& link : robot.links) link.collisions.clear();  // the pose is not one of a real robot
  WorldOptions options = in_the_air();
  options.X_WB = Eigen::Translation3d(1, 2, 3) * Eigen::AngleAxisd(0.7, Vector3d(1, 2, 3).normalized());
  for (std::size_t j = 0; j < robot.joints.size(); ++j)
    options.joint_positions_rad.push_back(0.1 * (static_cast<double>(j) - 10.0));
  const auto world = make_world(robot, options);
  EXPECT_TRUE(world->body(0).X_WL.isApprox(options.X_WB, 1e-12));
  options.gravity_W_m_per_s2.setZero();
  const auto weightless = make_world(robot, options);
  weightless->step();
  for (int j = 0; j < 20; ++j) {
    EXPECT_NEAR(world->joint(j).position_rad, options.joint_positions_rad[static_cast<std::size_t>(j)],
                1e-12);
    // Measured by the solver from the bodies' poses: the poses agree with the joint positions.
    EXPECT_NEAR(weightless->joint(j).position_rad, options.joint_positions_rad[static_cast<std::size_t>(j)],
                1e-9);
  }
}

TEST_P(WorldInEachEngine, TurnsAPositiveJointByTheRightHandRule) {
  WorldOptions options = in_the_air();
  options.fixed_base = true;
  options.joint_positions_rad = {0.5};
  const auto world = make_world(sample_hinge({.arm_m = 0.1, .axis = Vector3d::UnitZ()}), options);
  const BodyState arm = world->body(1);
  EXPECT_NEAR(arm.X_WL.linear()(1, 0), std::sin(0.5), 1e-12);  // its x axis has turned towards y
}

TEST_P(WorldInEachEngine, KeepsAFixedBase) {
  WorldOptions options = in_the_air();
  options.fixed_base = true;
  const auto world = make_world(sample_humanoid(), options);
  run(*world, 0.5);
  EXPECT_TRUE(world->body(0).X_WL.isApprox(Eigen::Isometry3d::Identity(), 1e-12));
}

TEST_P(WorldInEachEngine, MovesTheCentreOfMassByExternalForcesOnly) {
  const RobotDescription robot = sample_humanoid();
  WorldOptions options = in_the_air();
  const auto world = make_world(robot, options);
  const CentreOfMass start = centre_of_mass(robot, *world);
  for (int j = 0; j < 20; ++j) world->set_servo(j, {.drive_Nm = 0.01 * (j - 7), .damping_Nm_s = 0.05});
  run(*world, 0.2);
  const CentreOfMass end = centre_of_mass(robot, *world);
  // MuJoCo's state is joint speeds, not momenta: their sum drifts by 5e-5 m/s here, in proportion to the
  // step.
  const double drift_m_per_s = in_mujoco() ? 1e-4 : 1e-6;
  EXPECT_NEAR(end.v_WCom_W.z(), -9.80665 * 0.2, drift_m_per_s);
  EXPECT_NEAR(end.v_WCom_W.x(), 0.0, in_mujoco() ? 1e-4 : 1e-9);
  EXPECT_NEAR((end.p_WCom_W - start.p_WCom_W).z(), -0.5 * 9.80665 * 0.2 * 0.201, in_mujoco() ? 2e-5 : 1e-6);
}

TEST_P(WorldInEachEngine, ThrowsTimeBodyAndReasonWhenABodyIsTooFast) {
  const auto world = make_world(sample_box(0.001, {0.1, 0.1, 0.1}), in_the_air());
  run(*world, 0.25);
  world->push(0, Vector3d::Zero(), {0, 0, 1e3});
  try {
    world->step();
    FAIL();
  } catch (const WorldBlewUp& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("0.251"), HasSubstr("'box'"), HasSubstr("m/s")));
  }
}

TEST_P(WorldInEachEngine, RejectsNonFiniteValues) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto world = make_world(sample_hinge({}), in_the_air());
  EXPECT_THROW(world->push(1, Vector3d::Zero(), {nan, 0, 0}), WorldBlewUp);
  EXPECT_THROW(world->push(1, {0, nan, 0}, {1, 0, 0}), WorldBlewUp);
  world->set_servo(0, {.drive_Nm = nan});
  EXPECT_THROW(world->step(), WorldBlewUp);
  world->set_servo(0, {.damping_Nm_s = -1.0});
  EXPECT_THROW(world->step(), WorldBlewUp);
}

TEST_P(WorldInEachEngine, RejectsInvalidOptions) {
  const RobotDescription robot = sample_hinge({});
  for (const double step_s : {0.0, -0.001, 0.002, 0.0003, 0.0007}) {
    WorldOptions options = this->options();
    options.step_s = step_s;
    EXPECT_THROW(make_world(robot, options), std::invalid_argument) << step_s;
  }
  WorldOptions options = this->options();
  options.joint_positions_rad = {0.0, 0.0};
  EXPECT_THROW(make_world(robot, options), std::invalid_argument);
  options.joint_positions_rad.clear();
  RobotDescription light = robot;
  light.links[1].mass_kg = 0.0;
  EXPECT_THROW(make_world(light, options), std::invalid_argument);
  RobotDescription loop = robot;
  loop.joints.push_back(loop.joints[0]);
  EXPECT_THROW(make_world(loop, options), std::invalid_argument);
  RobotDescription apart = robot;
  apart.joints.clear();
  EXPECT_THROW(make_world(apart, options), std::invalid_argument);
}

INSTANTIATE_TEST_SUITE_P(Engines, WorldInEachEngine, testing::ValuesIn(engines()), engine_name);

}  // namespace
}  // namespace koboshi::sim_board
