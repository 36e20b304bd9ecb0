#include "tools/import/normalise/linkages.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

namespace koboshi::tools {
namespace {

ImportedJoint hinge(const std::string& name, int parent, int child, bool has_actuator) {
  ImportedJoint joint{.name = name, .kind = JointKind::kHinge, .parent = parent, .child = child};
  joint.lower_rad = -1.0;
  joint.upper_rad = 1.0;
  joint.has_actuator = has_actuator;
  return joint;
}

// A trunk, a limb of 1 kg and a gear of 1 g; the limb follows the gear.
ImportedRobot with_gear(double ratio) {
  ImportedRobot robot;
  robot.links = {{.name = "trunk", .mass_kg = 5.0},
                 {.name = "limb", .mass_kg = 1.0},
                 {.name = "gear", .mass_kg = 0.001}};
  robot.joints = {hinge("driven", 0, 1, false), hinge("drive", 0, 2, true)};
  robot.joints[0].mimics = "drive";
  robot.joints[0].mimic_ratio = ratio;
  robot.joints[1].effort_Nm = 2.0;
  robot.joints[1].rotor_inertia_kg_m2 = 0.01;
  return robot;
}

TEST(MoveActuators, FromAGearToTheLimbThatFollowsIt) {
  ImportedRobot robot = with_gear(-0.8);
  ImportReport report;
  move_actuators(robot, report);
  EXPECT_TRUE(robot.joints[0].has_actuator);
  EXPECT_TRUE(robot.joints[0].mimics.empty());
  EXPECT_NEAR(robot.joints[0].reduction, 1.25, 1e-12);
  EXPECT_NEAR(robot.joints[0].effort_Nm, 2.5, 1e-12);
  EXPECT_NEAR(robot.joints[0].rotor_inertia_kg_m2, 0.01 * 1.25 * 1.25, 1e-12);
  EXPECT_TRUE(robot.joints[0].has_stage);
  EXPECT_FALSE(robot.joints[1].has_actuator);
  EXPECT_EQ(robot.joints[1].mimics, "driven");  // which locks it
  EXPECT_EQ(report.normalised.size(), 1U);
}

// A finger that follows a driven one, which is as heavy, stays a follower.
TEST(MoveActuators, LeavesFollowersThatCarryNoMore) {
  ImportedRobot robot = with_gear(1.0);
  robot.links[1].mass_kg = robot.links[2].mass_kg;
  ImportReport report;
  move_actuators(robot, report);
  EXPECT_FALSE(robot.joints[0].has_actuator);
  EXPECT_EQ(robot.joints[0].mimics, "drive");
  EXPECT_EQ(robot.joints[1].reduction, 1.0);
}

// Shank, a crank with a rod on it, and a foot that the rod moves: pitch has no actuator.
ImportedRobot with_rod() {
  ImportedRobot robot;
  robot.links = {{.name = "shank", .mass_kg = 1.0},
                 {.name = "crank", .mass_kg = 0.02},
                 {.name = "rod", .mass_kg = 0.02},
                 {.name = "foot", .mass_kg = 0.3}};
  robot.joints = {hinge("motor", 0, 1, true), hinge("ball", 1, 2, false), hinge("pitch", 0, 3, false)};
  robot.loops = {{.one = 2, .other = 3}};
  return robot;
}

TEST(MoveActuators, ThroughARodToTheFoot) {
  ImportedRobot robot = with_rod();
  robot.loops.push_back({.one = 2, .other = 3});  // a second constraint of the same rod
  ImportReport report;
  move_actuators(robot, report);
  EXPECT_TRUE(robot.joints[2].has_actuator);
  EXPECT_FALSE(robot.joints[0].has_actuator);
  EXPECT_FALSE(robot.joints[1].has_actuator);
  ASSERT_EQ(report.warnings.size(), 1U);
  EXPECT_NE(report.warnings[0].find("motor moves pitch through rods"), std::string::npos);
}

TEST(MoveActuators, WarnOfALoopThatMovesNone) {
  ImportedRobot robot = with_rod();
  robot.joints[2].has_actuator = true;
  ImportReport report;
  move_actuators(robot, report);
  EXPECT_TRUE(robot.joints[0].has_actuator);
  ASSERT_EQ(report.warnings.size(), 1U);
  EXPECT_NE(report.warnings[0].find("closes a loop"), std::string::npos);
}

}  // namespace
}  // namespace koboshi::tools
