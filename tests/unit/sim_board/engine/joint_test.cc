#include <gtest/gtest.h>

#include <cmath>

#include "sim_board/engine/make_world.h"
#include "sim_board/world/ground_truth.h"
#include "tests/support/sample_robots.h"
#include "tests/unit/sim_board/engine/engines.h"

namespace koboshi::sim_board {
namespace {

using Eigen::Vector3d;

// One link on a hinge whose bearing stands still; no gravity unless the rig has an arm.
std::unique_ptr<World> make_rig(const HingeRig& rig, WorldOptions options, double start_rad = 0.0) {
  options.ground.present = false;
  options.fixed_base = true;
  options.joint_positions_rad = {start_rad};
  if (rig.arm_m == 0.0) options.gravity_W_m_per_s2.setZero();
  return make_world(sample_hinge(rig), options);
}

// The ways of solving dry friction: two in ODE, one in MuJoCo.
std::vector<WorldOptions> friction_methods() {
  std::vector<WorldOptions> methods(3);
  methods[0].friction = FrictionMethod::kRows;
  methods[1].friction = FrictionMethod::kLockAndCheck;
  methods[2].stepper = Stepper::kMujoco;
  return methods;
}

class JointInEachEngine : public EachEngine {};
class FrictionOfJoint : public testing::TestWithParam<WorldOptions> {
 protected:
  void SetUp() override {
    if (GetParam().stepper == Stepper::kMujoco && !has_mujoco()) GTEST_SKIP() << "built without MuJoCo";
  }
};

TEST_P(FrictionOfJoint, HoldsBelowItsBound) {
  const auto world = make_rig({}, GetParam());
  world->set_servo(0, {.drive_Nm = 0.99 * 0.0275, .rotor_inertia_kg_m2 = 0.00116, .friction_Nm = 0.0275});
  run(*world, 1.0);
  EXPECT_LT(std::abs(world->joint(0).position_rad), 1e-6);
}

TEST_P(FrictionOfJoint, SlidesAboveItsBound) {
  const auto world = make_rig({}, GetParam());
  world->set_servo(0, {.drive_Nm = 1.1 * 0.0275, .rotor_inertia_kg_m2 = 0.00116, .friction_Nm = 0.0275});
  run(*world, 1.0);
  const double acceleration = 0.1 * 0.0275 / (0.00116 + 1e-4);
  EXPECT_NEAR(world->joint(0).speed_rad_per_s, acceleration, 0.001 * acceleration);
  EXPECT_NEAR(world->joint(0).position_rad, 0.5 * acceleration, 0.002 * acceleration);
}

TEST_P(FrictionOfJoint, StopsASlidingJointAndKeepsItThere) {
  const auto world = make_rig({}, GetParam());
  const double inertia = 0.00116 + 1e-4;
  world->set_servo(0, {.rotor_inertia_kg_m2 = 0.00116, .friction_Nm = 0.0275});
  world->push(1, {0.1, 0, 0}, {0, 0, -inertia * 5.0 / 0.001 / 0.1});  // 5 rad/s about +y, less friction
  run(*world, 1.0);
  // Braked by Kc / I from 5 rad/s: 0.5 w^2 I / Kc of way.
  const double way = 0.5 * 25.0 * inertia / 0.0275;
  EXPECT_NEAR(world->joint(0).position_rad, way, 0.01 * way);
  EXPECT_LT(std::abs(world->joint(0).speed_rad_per_s), 1e-9);
}

INSTANTIATE_TEST_SUITE_P(Methods, FrictionOfJoint, testing::ValuesIn(friction_methods()),
                         [](const auto& info) {
                           if (info.param.stepper == Stepper::kMujoco) return "Mujoco";
                           return info.param.friction == FrictionMethod::kRows ? "Rows" : "LockAndCheck";
                         });

TEST_P(JointInEachEngine, TransfersAnImpactToLinkAndRotorTogether) {
  const auto world = make_rig({.inertia_kg_m2 = 1e-4}, options());
  world->set_servo(0, {.rotor_inertia_kg_m2 = 0.00116});
  world->push(1, {0.1, 0, 0}, {0, 0, -60.0});  // 6 N m about +y for one step
  world->step();
  EXPECT_NEAR(world->joint(0).speed_rad_per_s, 6.0 * 0.001 / (0.00116 + 1e-4), 1e-6);  // 4.76
}

TEST_P(JointInEachEngine, AppliesATorqueThatIsAffineInTheNewSpeed) {
  const auto world = make_rig({.inertia_kg_m2 = 1e-4}, options());
  const double a = 0.3, b = 0.2, inertia = 1e-4 + 0.00116;
  world->set_servo(0, {.drive_Nm = a, .damping_Nm_s = b, .rotor_inertia_kg_m2 = 0.00116});
  double w = 0.0;
  for (int i = 0; i < 50; ++i) {
    world->step();
    w = (inertia * w + 0.001 * a) / (inertia + 0.001 * b);  // I (w_new - w) = h (a - b w_new)
    ASSERT_NEAR(world->joint(0).speed_rad_per_s, w, 1e-7);
  }
}

TEST_P(JointInEachEngine, SwingsFreelyWithoutAServo) {
  const HingeRig rig{.mass_kg = 0.05, .inertia_kg_m2 = 1e-5, .arm_m = 0.1};
  const RobotDescription robot = sample_hinge(rig);
  const double start_rad = kPi / 2 - 0.05;  // nearly hanging: +y turns x down
  const auto world = make_rig(rig, options(), start_rad);
  const double period_s = 2 * kPi * std::sqrt((1e-5 + 0.05 * 0.01) / (0.05 * kGravity * 0.1));
  run(*world, std::round(10 * period_s * 1000) / 1000);
  EXPECT_NEAR(world->joint(0).position_rad, start_rad, 0.05 * 0.05);
  EXPECT_NEAR(world->joint(0).speed_rad_per_s, 0.0, 0.05 * 0.05 * 2 * kPi / period_s * 2);
}

TEST_P(JointInEachEngine, HoldsAtItsStops) {
  for (const double direction : {-1.0, 1.0}) {
    const auto world = make_rig({.lower_rad = -0.5, .upper_rad = 0.5}, options());
    world->set_servo(0, {.drive_Nm = direction * 1.373,
                         .damping_Nm_s = 0.187,
                         .rotor_inertia_kg_m2 = 0.00116,
                         .friction_Nm = 0.0275});
    double farthest = 0.0;
    for (int i = 0; i < 1000; ++i) {
      world->step();
      farthest = std::max(farthest, std::abs(world->joint(0).position_rad));
    }
    EXPECT_NEAR(world->joint(0).position_rad, direction * (0.5 + (1.373 - 0.0275) / 1e4),
                6e-6);          // friction helps either way
    EXPECT_LT(farthest, 0.51);  // ran into it at 7 rad/s
    EXPECT_NEAR(world->joint(0).speed_rad_per_s, 0.0, 1e-6);
  }
}

TEST_P(JointInEachEngine, CountsTurnsAndStopsBeyondHalfATurn) {
  const auto world = make_rig({.lower_rad = -1.0, .upper_rad = 7.5}, options());
  world->set_servo(0, {.drive_Nm = 0.5, .damping_Nm_s = 0.1, .rotor_inertia_kg_m2 = 0.00116});
  run(*world, 1.0);
  EXPECT_NEAR(world->joint(0).position_rad, 5.0, 0.1);  // 5 rad/s
  run(*world, 1.0);
  EXPECT_NEAR(world->joint(0).position_rad, 7.5, 1e-3);
}

// The bearing feels the arm's weight, and a torque of m g d about the hinge, whatever holds the arm.
TEST(Joint, TransmitsTheWeightOfAStaticArm) {
  const HingeRig hanging{.mass_kg = 0.2, .inertia_kg_m2 = 1e-4, .arm_m = 0.1};
  HingeRig on_stop = hanging;
  on_stop.upper_rad = 0.0;
  const double load_Nm = 0.2 * kGravity * 0.1;
  const ServoTorque motor{.drive_Nm = -load_Nm, .damping_Nm_s = 0.2, .rotor_inertia_kg_m2 = 0.00116};
  const ServoTorque friction{.friction_Nm = 0.5};
  const ServoTorque half{.drive_Nm = -0.5 * load_Nm, .damping_Nm_s = 0.2, .friction_Nm = 0.9 * load_Nm};
  const struct {
    HingeRig rig;
    ServoTorque servo;
  } cases[] = {{hanging, motor}, {hanging, friction}, {hanging, half}, {on_stop, {}}, {on_stop, half}};
  for (const WorldOptions& method : friction_methods()) {
    for (const auto& [rig, servo] : cases) {
      const auto world = make_rig(rig, method);
      world->set_servo(0, servo);
      run(*world, 0.5);
      const Wrench wrench = world->joint_wrench(0);
      EXPECT_NEAR(wrench.force_N.z(), -0.2 * kGravity, 1e-5);  // the arm pulls the bearing down
      EXPECT_NEAR(wrench.force_N.x(), 0.0, 1e-3);
      EXPECT_NEAR(wrench.torque_Nm.y(), load_Nm, 1e-4);  // and turns it, +y being x towards -z
      EXPECT_NEAR(wrench.torque_Nm.x(), 0.0, 1e-6);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Engines, JointInEachEngine, testing::ValuesIn(engines()), engine_name);

}  // namespace
}  // namespace koboshi::sim_board
