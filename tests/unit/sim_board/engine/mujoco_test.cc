#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "sim_board/description/hinge_tree.h"
#include "sim_board/engine/common/model_constants.h"
#include "sim_board/engine/make_world.h"
#include "sim_board/engine/mujoco/constraint_row.h"
#include "sim_board/engine/mujoco/library.h"
#include "sim_board/engine/mujoco/model_text.h"
#include "sim_board/engine/mujoco/scene.h"
#include "tests/support/sample_robots.h"

namespace koboshi::sim_board {
namespace {

using testing::HasSubstr;

TEST(Mujoco, ThrowsItsErrorsAndLeavesNoLog) {
  start_mujoco();
  EXPECT_THROW(mju_error("out of memory"), MujocoError);
  mju_warning("a warning");
  EXPECT_FALSE(std::filesystem::exists("MUJOCO_LOG.TXT"));
}

TEST(Mujoco, StatesWhyItRejectsARobot) {
  RobotDescription robot = sample_box(1.0, {0.1, 0.1, 0.1});
  robot.links[0].I_LCom_L = Eigen::Vector3d(1.0, 1.0, 3.0).asDiagonal();  // of no body: 1 + 1 < 3
  WorldOptions options;
  options.stepper = Stepper::kMujoco;
  try {
    make_world(robot, options);
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_THAT(error.what(), HasSubstr("inertia"));
  }
}

// Row by row what constraint_row.h claims: in the rows that MuJoCo makes of a model stand B = 1/h,
// K d = ERP/h^2 and R = CFM/h.
TEST(Mujoco, HasRowsEquivalentToOde) {
  for (const double step_s : {0.001, 0.00025}) {
    const RobotDescription robot = sample_box(1.2, {0.1, 0.056, 0.01});
    WorldOptions options;
    options.step_s = step_s;
    options.stepper = Stepper::kMujoco;
    options.X_WB.translation().z() = 0.00499;
    options = checked(options, robot);
    const auto pairs = touching_pairs(robot, hinge_tree(robot), options);
    const MujocoModel model = load_model(model_text(robot, {}, pairs, options, Base::kFree));
    std::fill_n(model->body_invweight0 + 2, 2, kInverseInertia);
    const MujocoData data = make_data(*model);
    mj_forward(model.get(), data.get());
    const Softness expected = pairs.at(0).surface.softness;
    ASSERT_EQ(data->ncon, 4);
    for (int i = 0; i < data->ncon; ++i) {
      const int row = data->contact[i].efc_address;
      const mjtNum* KBIP = data->efc_KBIP + 4 * row;
      EXPECT_NEAR(KBIP[0] * KBIP[2] * step_s * step_s, expected.error_reduction, 1e-9);
      EXPECT_NEAR(KBIP[1] * step_s, 1.0, 1e-9);
      EXPECT_NEAR(data->efc_R[row] * step_s / expected.constraint_force_mixing, 1.0, 1e-9);
      EXPECT_NEAR(data->contact[i].friction[0], 0.8, 1e-12);
    }
  }
}

// The same of the row that couples a follower with its leader, in which two joints move. With a step of 1 ms,
// MuJoCo's bound of the impedance makes it twice as soft.
TEST(Mujoco, HasACouplingEquivalentToOde) {
  RobotDescription robot = sample_hinge({.inertia_kg_m2 = 1e-4, .axis = Eigen::Vector3d::UnitZ()});
  FollowerDescription follower{.hinge = robot.joints[0], .leader = 0, .multiplier = -0.7, .offset_rad = 0.1};
  follower.hinge.name = "follower";
  follower.hinge.child = 2;
  follower.hinge.p_MJ = Eigen::Vector3d(0.0, 0.3, 0.0);
  robot.links.push_back(robot.links[1]);
  robot.links.back().name = "other";
  robot.links.back().X_ML.translation() += follower.hinge.p_MJ;
  robot.joints.push_back(follower.hinge);
  for (const double step_s : {0.00025, 0.0001}) {
    WorldOptions options;
    options.step_s = step_s;
    options.stepper = Stepper::kMujoco;
    options.fixed_base = true;
    options.ground.present = false;
    options = checked(options, robot);
    const MujocoModel model = load_model(model_text(robot, {&follower, 1}, {}, options, Base::kFixed));
    std::fill_n(model->dof_invweight0, model->nv, kInverseInertia);
    const MujocoData data = make_data(*model);
    mj_forward(model.get(), data.get());
    ASSERT_EQ(data->ne, 1);  // equalities come first
    const mjtNum* KBIP = data->efc_KBIP;
    EXPECT_NEAR(KBIP[0] * KBIP[2] * step_s * step_s, kCouplingErrorReduction, 1e-9);
    EXPECT_NEAR(KBIP[1] * step_s, 1.0, 1e-9);
    EXPECT_NEAR(data->efc_R[0] * step_s / kCouplingForceMixing, 1.0, 1e-6);
  }
}

// A foot-sized box that is struck sideways slides to a halt on the ground: it neither takes off nor goes
// further than Coulomb lets it.
TEST(Mujoco, SlidesWithoutTakingOff) {
  WorldOptions options;
  options.stepper = Stepper::kMujoco;
  options.X_WB.translation().z() = 0.005;
  const auto world = make_world(sample_box(1.2, {0.1, 0.056, 0.01}), options);
  for (int i = 0; i < 200; ++i) world->step();
  world->push(0, Eigen::Vector3d::Zero(), {1200.0, 0.0, 0.0});  // 1 m/s
  double highest_m = 0.0;
  for (int i = 0; i < 400; ++i) {
    world->step();
    highest_m = std::max(highest_m, world->body(0).X_WL.translation().z());
  }
  const double travel_m = 0.5 / (0.8 * 9.80665);
  EXPECT_LT(highest_m, 0.0051);  // 17 mm when the blow is left out of the contacts, 0.05 mm with it
  EXPECT_NEAR(world->body(0).X_WL.translation().x(), travel_m, 0.02 * travel_m);
}

// A base that is let go goes on from where it hangs, and falls.
TEST(Mujoco, ReleasesTheBaseAtItsPresentPose) {
  WorldOptions options;
  options.stepper = Stepper::kMujoco;
  options.ground.present = false;
  options.fixed_base = true;
  options.X_WB = Eigen::Translation3d(0.1, 0.2, 0.3) * Eigen::AngleAxisd(0.4, Eigen::Vector3d::UnitX());
  const auto world = make_world(sample_humanoid(), options);
  for (int i = 0; i < 100; ++i) world->step();
  const JointState knee = world->joint(3);
  world->release_base();
  EXPECT_TRUE(world->body(0).X_WL.isApprox(options.X_WB, 1e-12));
  EXPECT_EQ(world->joint(3).position_rad, knee.position_rad);
  EXPECT_EQ(world->joint(3).speed_rad_per_s, knee.speed_rad_per_s);
  EXPECT_NEAR(world->time_s(), 0.1, 1e-12);
  for (int i = 0; i < 100; ++i) world->step();
  EXPECT_LT(world->body(0).X_WL.translation().z(), 0.3 - 0.02);
}

}  // namespace
}  // namespace koboshi::sim_board
