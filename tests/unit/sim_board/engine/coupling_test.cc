// One motor that turns two hinges, in each engine.

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/support/sample_robots.h"
#include "tests/unit/sim_board/engine/engines.h"

namespace koboshi::sim_board {
namespace {

using Eigen::Vector3d;

constexpr double kMultiplier = -0.7;
constexpr double kOffset_rad = 0.1;
constexpr double kInertia_kg_m2 = 1e-4;  // of either arm about its hinge

// A base with two arms on parallel hinges, without gravity; the second one follows the first.
RobotDescription two_arms() {
  const RobotDescription one = sample_hinge({.inertia_kg_m2 = kInertia_kg_m2, .axis = Vector3d::UnitZ()});
  RobotDescription robot = one;
  robot.links.push_back(one.links[1]);
  robot.links.back().name = "other";
  FollowerDescription follower{
      .hinge = one.joints[0], .leader = 0, .multiplier = kMultiplier, .offset_rad = kOffset_rad};
  follower.hinge.name = "follower";
  follower.hinge.child = 2;
  follower.hinge.p_MJ = Vector3d(0.0, 0.3, 0.0);
  robot.links.back().X_ML.translation() += follower.hinge.p_MJ;
  robot.followers.push_back(follower);
  return robot;
}

double turn_of(const World& world, int link) {
  const Eigen::Matrix3d& R = world.body(link).X_WL.linear();
  return std::atan2(R(1, 0), R(0, 0));
}

class Coupling : public testing::TestWithParam<Stepper> {
 protected:
  void SetUp() override {
    if (GetParam() == Stepper::kMujoco && !has_mujoco()) GTEST_SKIP() << "built without MuJoCo";
  }
  static WorldOptions options() {
    WorldOptions options;
    options.stepper = GetParam();
    options.gravity_W_m_per_s2.setZero();
    options.ground.present = false;
    return options;
  }
  static double error_rad(const World& world) {
    return turn_of(world, 2) - (kMultiplier * world.joint(0).position_rad + kOffset_rad);
  }
};

// The motor feels both arms: I1 + multiplier^2 I2, and its rotor.
TEST_P(Coupling, AcceleratesBothInertias) {
  WorldOptions fixed = options();
  fixed.fixed_base = true;
  const auto world = make_world(two_arms(), fixed);
  EXPECT_NEAR(error_rad(*world), 0.0, 1e-12);
  constexpr double kTorque_Nm = 0.002;
  constexpr double kRotor_kg_m2 = 5e-5;
  world->set_servo(0, {.drive_Nm = kTorque_Nm, .rotor_inertia_kg_m2 = kRotor_kg_m2});
  run(*world, 0.2);
  const double expected = kTorque_Nm / (kInertia_kg_m2 * (1.0 + kMultiplier * kMultiplier) + kRotor_kg_m2);
  EXPECT_NEAR(world->joint(0).speed_rad_per_s, 0.2 * expected, 2e-3 * 0.2 * expected);
  EXPECT_LT(std::abs(error_rad(*world)), 2e-4);
  EXPECT_NEAR(world->body(2).w_WL_W.z(), kMultiplier * world->joint(0).speed_rad_per_s, 1e-3);
}

// A torque on the follower's arm moves the leader's: a locked leader holds both.
TEST_P(Coupling, HoldsTheFollowerByTheLeadersFriction) {
  WorldOptions fixed = options();
  fixed.fixed_base = true;
  const auto world = make_world(two_arms(), fixed);
  for (int step = 0; step < 200; ++step) {
    world->set_servo(0, {.friction_Nm = 0.02});
    world->push(2, Vector3d(0.1, 0.0, 0.0), Vector3d(0.0, 0.2, 0.0));  // 0.02 N m, 0.014 at the leader
    world->step();
  }
  EXPECT_LT(std::abs(world->joint(0).position_rad), 1e-3);
  EXPECT_LT(std::abs(error_rad(*world)), 1e-3);
  for (int step = 0; step < 200; ++step) {
    world->set_servo(0, {.friction_Nm = 0.005});
    world->push(2, Vector3d(0.1, 0.0, 0.0), Vector3d(0.0, 0.2, 0.0));
    world->step();
  }
  EXPECT_LT(world->joint(0).position_rad, -0.5);  // the ratio is negative
  EXPECT_LT(std::abs(error_rad(*world)), 2e-3);
}

// Without a servo's work the sum of angular momenta stays, and no energy appears (engine/guarded_world.h).
TEST_P(Coupling, KeepsMomentumOfAFreeRobot) {
  const RobotDescription robot = two_arms();
  const auto world = make_world(robot, options());
  for (int step = 0; step < 500; ++step) {
    world->set_servo(0, {.drive_Nm = 0.002 * std::sin(0.02 * step), .rotor_inertia_kg_m2 = 0.0});
    world->step();
  }
  Vector3d momentum = Vector3d::Zero();
  Vector3d spin = Vector3d::Zero();
  double largest = 0.0;
  for (int l = 0; l < 3; ++l) {
    const LinkDescription& link = robot.links[static_cast<std::size_t>(l)];
    const BodyState state = world->body(l);
    const Eigen::Matrix3d R = state.X_WL.linear();
    const Vector3d own = R * link.I_LCom_L * R.transpose() * state.w_WL_W;
    momentum += link.mass_kg * state.v_WCom_W;
    spin += own + (state.X_WL * link.p_LCom_L).cross(link.mass_kg * state.v_WCom_W);
    largest = std::max(largest, own.norm());
  }
  ASSERT_GT(largest, 1e-5);
  EXPECT_LT(momentum.norm(), 1e-6);
  EXPECT_LT(spin.norm(), 0.02 * largest);
  EXPECT_LT(std::abs(turn_of(*world, 2) - turn_of(*world, 0) -
                     (kMultiplier * world->joint(0).position_rad + kOffset_rad)),
            2e-3);
}

// The stop of the leader is that of both.
TEST_P(Coupling, StopsAtTheLeadersStop) {
  RobotDescription robot = two_arms();
  robot.joints[0].lower_rad = -0.3;
  robot.joints[0].upper_rad = 0.3;
  WorldOptions fixed = options();
  fixed.fixed_base = true;
  const auto world = make_world(robot, fixed);
  world->set_servo(0, {.drive_Nm = 0.02, .damping_Nm_s = 0.002});
  run(*world, 1.0);
  EXPECT_NEAR(world->joint(0).position_rad, 0.3, 1e-3);
  EXPECT_LT(std::abs(error_rad(*world)), 1e-3);
}

INSTANTIATE_TEST_SUITE_P(Engines, Coupling,
                         testing::Values(Stepper::kWorld, Stepper::kLumped, Stepper::kMujoco), engine_name);

}  // namespace
}  // namespace koboshi::sim_board
