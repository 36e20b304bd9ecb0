#include "simulation/scenario/scenario.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <numbers>

#include "base/text/error.h"
#include "simulation/scenario/player.h"
#include "tests/support/sample_robots.h"

namespace koboshi::simulation {
namespace {

using ::testing::HasSubstr;

Push make_push(Push::Shape shape) {
  Push push;
  push.at_us = 10'300;
  push.duration_us = 5'400;
  push.shape = shape;
  push.force_W_N = Eigen::Vector3d(2.0, 0.0, -1.0);
  return push;
}

// The impulse along x, N s, in steps of a size that neither begins nor ends with the push.
double impulse(const Push& push, std::uint64_t step_us) {
  double sum = 0.0;
  for (std::uint64_t time_us = 0; time_us < 30'000; time_us += step_us) {
    sum += push.mean_force_W_N(time_us, time_us + step_us).x() * static_cast<double>(step_us) * 1e-6;
  }
  return sum;
}

TEST(Push, HasTheSameImpulseForAnyStep) {
  for (const std::uint64_t step_us : {1000u, 500u, 250u, 20u}) {
    EXPECT_NEAR(impulse(make_push(Push::Shape::kRectangle), step_us), 2.0 * 0.0054, 1e-12) << step_us;
    EXPECT_NEAR(impulse(make_push(Push::Shape::kHalfSine), step_us), 2.0 * 0.0054 * 2.0 / std::numbers::pi,
                1e-12)
        << step_us;
  }
}

TEST(Push, ActsOnlyDuringItsInterval) {
  const Push push = make_push(Push::Shape::kRectangle);
  EXPECT_EQ(push.mean_force_W_N(9'300, 10'300), Eigen::Vector3d::Zero());
  EXPECT_EQ(push.mean_force_W_N(15'700, 16'700), Eigen::Vector3d::Zero());
  EXPECT_TRUE(push.mean_force_W_N(11'000, 12'000).isApprox(push.force_W_N));
  EXPECT_NEAR(push.mean_force_W_N(10'000, 11'000).x(), 2.0 * 0.7, 1e-12);
}

TEST(Push, PeaksInTheMiddleOfAHalfSine) {
  const Push push = make_push(Push::Shape::kHalfSine);
  EXPECT_NEAR(push.mean_force_W_N(12'999, 13'001).x(), 2.0, 1e-6);
  EXPECT_LT(push.mean_force_W_N(10'300, 10'400).x(), 0.07);
}

sim_board::RobotDescription one_knee() {
  sim_board::RobotDescription robot;
  robot.links.resize(2);
  robot.links[0].name = "trunk";
  robot.links[1].name = "shank";
  sim_board::JointDescription knee;
  knee.name = "knee";
  knee.lower_rad = 0.0;
  knee.upper_rad = 0.5 * std::numbers::pi;
  robot.joints.push_back(knee);
  robot.left_ankle.emplace();
  return robot;
}

SourcedName at_line(const std::string& name, int line) { return {name, "a.yaml", line}; }

std::string refusal_of_event(const Scenario& scenario) {
  try {
    check(scenario, one_knee());
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

Scenario with_fault(Fault::Kind kind, const std::string& target, hal::Side side = hal::Side::kLeft) {
  Scenario scenario;
  Fault& fault = scenario.faults.emplace_back();
  fault.kind = kind;
  fault.target = at_line(target, 5);
  fault.side = side;
  return scenario;
}

TEST(ScenarioCheck, AcceptsElementsOfTheRobot) {
  Scenario scenario = with_fault(Fault::Kind::kDriveSilent, "knee");
  scenario.initial.joints.push_back({at_line("knee", 3), 0.5 * std::numbers::pi});
  scenario.pushes.push_back(make_push(Push::Shape::kRectangle));
  scenario.pushes[0].link = at_line("shank", 4);
  EXPECT_EQ(refusal_of_event(scenario), "");
}

TEST(ScenarioCheck, RejectsAnUnknownLink) {
  Scenario scenario;
  scenario.pushes.push_back(make_push(Push::Shape::kRectangle));
  scenario.pushes[0].link = at_line("tail", 4);
  EXPECT_EQ(refusal_of_event(scenario), "a.yaml:4: found the unknown link tail, expected trunk or shank");
}

TEST(ScenarioCheck, RejectsAnUnknownJoint) {
  EXPECT_THAT(refusal_of_event(with_fault(Fault::Kind::kDrivePowerLoss, "hip")),
              HasSubstr("a.yaml:5: found the unknown joint hip"));
  Scenario scenario;
  scenario.initial.joints.push_back({at_line("hip", 3), 0.0});
  EXPECT_THAT(refusal_of_event(scenario), HasSubstr("a.yaml:3: found the unknown joint hip"));
}

// A scenario for many robots sets the ankles' roll where there is one; left_out_text() says where not.
TEST(ScenarioCheck, PassesOverInitialRolesThatTheRobotDoesNotHave) {
  Scenario scenario;
  for (const char* role : {"ankle_roll", "left_ankle_roll", "waist_yaw"})
    scenario.initial.joints.push_back({at_line(role, 3), 0.1});
  EXPECT_EQ(refusal_of_event(scenario), "");
  scenario.initial.joints.push_back({at_line("ankle_rol", 4), 0.1});
  EXPECT_THAT(refusal_of_event(scenario), HasSubstr("a.yaml:4: found the unknown joint ankle_rol"));
}

TEST(ScenarioCheck, RejectsAPositionBeyondTheLimits) {
  Scenario scenario;
  scenario.initial.joints.push_back({at_line("knee", 3), 0.51 * std::numbers::pi});
  EXPECT_THAT(refusal_of_event(scenario), HasSubstr("a.yaml:3: found knee = 91.8"));
  EXPECT_THAT(refusal_of_event(scenario), HasSubstr("from 0 to 90 degrees"));
}

TEST(ScenarioCheck, RoundsLimitsInMessages) {
  sim_board::RobotDescription robot = one_knee();
  robot.joints[0].upper_rad = 2.617994;  // 150.00000699057244 degrees
  Scenario scenario;
  scenario.initial.joints.push_back({at_line("knee", 3), 151.0 * std::numbers::pi / 180.0});
  try {
    check(scenario, robot);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(),
                 "a.yaml:3: found knee = 151, expected a number from 0 to 150 degrees, the joint's limits");
  }
}

sim_board::RobotDescription two_hips() {
  sim_board::RobotDescription robot = one_knee();
  for (const char* name : {"left_hip_roll", "right_hip_roll", "left_hip_pitch", "right_hip_pitch"}) {
    sim_board::JointDescription& joint = robot.joints.emplace_back(robot.joints[0]);
    joint.name = name;
    joint.lower_rad = -1.0;
    joint.upper_rad = 1.0;
    joint.axis_M = joint.name.ends_with("roll") ? Eigen::Vector3d::UnitX() : Eigen::Vector3d::UnitY();
  }
  return robot;
}

TEST(InitialJoints, WithoutTheirSideAreBothTheRightOneMirrored) {
  const sim_board::RobotDescription robot = two_hips();
  const auto signs = [&](const char* name) {
    std::vector<std::pair<int, int>> found;
    for (const sim_board::MirroredJoint& joint : robot.find_joints(name))
      found.emplace_back(joint.joint, joint.sign);
    return found;
  };
  using Found = std::vector<std::pair<int, int>>;
  EXPECT_EQ(signs("hip_roll"), (Found{{1, 1}, {2, -1}}));
  EXPECT_EQ(signs("hip_pitch"), (Found{{3, 1}, {4, 1}}));
  EXPECT_EQ(signs("left_hip_roll"), (Found{{1, 1}}));
  EXPECT_EQ(signs("tail"), Found());

  Scenario scenario;
  scenario.initial.joints.push_back({at_line("hip_roll", 3), 0.2});
  EXPECT_NO_THROW(check(scenario, robot));
  scenario.initial.base_height_m = 0.2;
  const sim_board::WorldOptions world = board_options(scenario, robot).world;
  EXPECT_EQ(world.joint_positions_rad, (std::vector<double>{0.0, 0.2, -0.2, 0.0, 0.0}));
}

TEST(InitialJoints, HaveOneAngleEach) {
  Scenario scenario;
  scenario.initial.joints.push_back({at_line("hip_roll", 3), 0.2});
  scenario.initial.joints.push_back({at_line("right_hip_roll", 4), 0.2});
  try {
    check(scenario, two_hips());
    FAIL();
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(),
                 "a.yaml:4: found a second angle for right_hip_roll, expected one angle a joint");
  }
}

TEST(ScenarioCheck, RejectsFaultsOfMissingSensors) {
  EXPECT_THAT(refusal_of_event(with_fault(Fault::Kind::kImuStop, "imu_stop")), HasSubstr("a.yaml:5"));
  EXPECT_THAT(refusal_of_event(with_fault(Fault::Kind::kAnkleStop, "right", hal::Side::kRight)),
              HasSubstr("right ankle sensor"));
  EXPECT_EQ(refusal_of_event(with_fault(Fault::Kind::kAnkleStop, "left")), "");
  EXPECT_EQ(refusal_of_event(with_fault(Fault::Kind::kControllerStop, "controller_stop")), "");
}

TEST(ScenarioCheck, AcceptsKnownNodesInFrameFaults) {
  EXPECT_EQ(refusal_of_event(with_fault(Fault::Kind::kFramesLost, "")), "");
  EXPECT_EQ(refusal_of_event(with_fault(Fault::Kind::kFramesLost, "controller")), "");
  EXPECT_EQ(refusal_of_event(with_fault(Fault::Kind::kFramesDoubled, "knee")), "");
  EXPECT_THAT(refusal_of_event(with_fault(Fault::Kind::kFramesDoubled, "hip")),
              HasSubstr("a.yaml:5: found the unknown joint hip"));
}

TEST(BoardOptions, PlaceTheLowestPointOnTheGround) {
  const sim_board::RobotDescription box = sim_board::sample_box(1.0, {0.1, 0.06, 0.02});
  Scenario scenario;
  scenario.initial.drop_m = 0.003;
  EXPECT_NEAR(board_options(scenario, box).world.X_WB.translation().z(), 0.01 + 0.003, 1e-12);
  scenario.initial.R_WB =
      Eigen::AngleAxisd(0.5 * std::numbers::pi, Eigen::Vector3d::UnitY()).toRotationMatrix();
  const Eigen::Isometry3d X_WB = board_options(scenario, box).world.X_WB;
  EXPECT_NEAR(X_WB.translation().z(), 0.05 + 0.003, 1e-12);
  EXPECT_TRUE(X_WB.linear().isApprox(scenario.initial.R_WB));
}

}  // namespace
}  // namespace koboshi::simulation
