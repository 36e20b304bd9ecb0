#include "lab/bring_up/start_values.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "base/text/error.h"
#include "base/text/user_units.h"
#include "lab/bring_up/standing_pose.h"
#include "sim_board/description/load.h"
#include "simulation/scenario/reader.h"

namespace koboshi::lab {
namespace {

const std::filesystem::path kKoboshi = std::filesystem::path(KOBOSHI_SOURCE_DIR) / "robots/koboshi/robot.sdf";

class StartValuesOf : public testing::Test {
 protected:
  StartValues scaled(const StartFactors& factors = {}) const {
    return scaled_values(reference_, measure(koboshi_), robot_, simulation::load_named_model(robot_),
                         factors);
  }
  double of_reference(const char* key) const { return StartValues{.parameters = reference_}.value(key); }
  // Moves the soles forward or back below the ankles.
  void move_soles(double by_m) {
    for (sim_board::LinkDescription& link : robot_.links) {
      if (link.name != "left_foot" && link.name != "right_foot") continue;
      for (sim_board::BoxDescription& box : link.collisions) box.X_LG.translation().x() += by_m;
    }
  }
  void set_stiffness(double times) {
    for (sim_board::JointDescription& joint : robot_.joints) joint.servo.full_voltage_error_rad /= times;
  }

  void limit_hips(double inward_deg) {
    for (sim_board::JointDescription& joint : robot_.joints) {
      if (joint.name == "left_hip_roll") joint.lower_rad = -inward_deg * kRadPerDegree;
      if (joint.name == "right_hip_roll") joint.upper_rad = inward_deg * kRadPerDegree;
    }
  }

  const sim_board::RobotDescription koboshi_ = sim_board::load_robot(kKoboshi);
  const simulation::RobotParameters reference_ = simulation::read_robot_parameters(kKoboshi);
  sim_board::RobotDescription robot_ = koboshi_;
};

TEST_F(StartValuesOf, TheReferenceAreItsOwn) {
  const StartValues values = scaled();
  for (const char* key : {"step_time_ms", "pushed_step_time_ms", "com_height_mm", "zmp_forward_mm",
                          "pitch_compliance_rad_per_m", "roll_compliance_rad_per_m", "trunk_pitch_deg"})
    EXPECT_NEAR(values.value(key), of_reference(key), 1e-9) << key;
  EXPECT_DOUBLE_EQ(values.time_scale, 1.0);
}

// They may strike its trunk.
TEST_F(StartValuesOf, ARobotKeepsItsArmsStillWhenItIsPushed) {
  EXPECT_GT(of_reference("arm_reaction_rad_per_m"), 0.0);
  EXPECT_EQ(scaled().value("arm_reaction_rad_per_m"), 0.0);
}

TEST_F(StartValuesOf, ASoleElsewhereTakeTheZmpAlong) {
  move_soles(-0.012);
  EXPECT_NEAR(scaled().value("zmp_forward_mm"), of_reference("zmp_forward_mm") - 12.0, 1e-6);
}

TEST_F(StartValuesOf, SofterServosCompensateMoreUntilGravityTipsTheRobot) {
  const double stiff = scaled().value("pitch_compliance_rad_per_m");
  set_stiffness(0.8);
  const double softer = scaled().value("pitch_compliance_rad_per_m");
  const BodyMeasures body = measure(robot_);
  const double tips = body.weight_N * body.com_m / body.pitch_stiffness_Nm_per_rad;
  const double margin = (1.0 - tips) / (1.0 - 0.8 * tips);
  EXPECT_NEAR(softer / stiff, 1.25 * margin * margin * margin, 1e-9);
  set_stiffness(1e-2);  // too soft to stand on a leg
  EXPECT_EQ(scaled().value("pitch_compliance_rad_per_m"), 0.0);
}

// As DARwIn-OP with mx_28 servos: gravity tips it nearly as strongly as they hold it.
TEST_F(StartValuesOf, SoftServosAreHelpedByStraighterLegsAndByTheLean) {
  const StartValues stiff = scaled();
  const BodyMeasures before = measure(robot_);
  set_stiffness(1.4 * before.weight_N * before.com_m / before.pitch_stiffness_Nm_per_rad);
  const StartValues soft = scaled();
  EXPECT_NEAR(soft.leg_use, 0.9, 0.01);
  EXPECT_GT(soft.leg_use, stiff.leg_use + 0.02);
  for (const char* key :
       {"walking_lean_gain_ankle_pitch_percent", "standing_lean_gain_ankle_pitch_percent"}) {
    EXPECT_EQ(stiff.value(key), of_reference(key)) << key;
    EXPECT_NEAR(soft.value(key), 100.0 * (2.3 / 1.4 - 1.0), 1e-6) << key;
  }
  EXPECT_GT(soft.value("highest_velocity_forward_mm_per_s"),
            1.2 * stiff.value("highest_velocity_forward_mm_per_s"));
  EXPECT_GT(soft.value("step_height_mm"), 1.2 * stiff.value("step_height_mm"));
}

TEST_F(StartValuesOf, KneesThatEndEarlyMakeAShallowerSquat) {
  const auto squat = [this] {
    return standing_pose(scaled(), simulation::load_named_model(robot_), "A test").squat_text;
  };
  const std::string deep = squat();
  for (sim_board::JointDescription& joint : robot_.joints)
    if (joint.name.ends_with("_knee")) joint.upper_rad = 95.0 * kRadPerDegree;
  EXPECT_NE(squat(), deep);
}

TEST_F(StartValuesOf, HipsThatEndEarlyNarrowTheSteps) {
  const StartValues wide = scaled();
  limit_hips(13.5);
  const StartValues narrow = scaled();
  EXPECT_LT(narrow.step_width_m, wide.step_width_m - 0.003);
  EXPECT_GE(narrow.value("step_width_mm"), narrow.value("narrowest_step_mm"));
  EXPECT_NEAR(narrow.value("step_width_mm"), kMmPerM * narrow.step_width_m, 1e-9);
}

// A robot that cannot shift its weight statically may still walk.
TEST_F(StartValuesOf, AMotionThatTheLegsDoNotReachIsNamedWithItsCause) {
  limit_hips(2.0);  // no part of the sole
  const StandingPose pose = standing_pose(scaled(), simulation::load_named_model(robot_), "A test");
  EXPECT_TRUE(pose.shift_text.empty());
  EXPECT_FALSE(pose.squat_text.empty());
  ASSERT_EQ(pose.unreached.count("shift"), 1U);
  EXPECT_NE(pose.unreached.at("shift").find("shift.yaml"), std::string::npos);
}

// A level pelvis over one foot needs an angle whose tangent is the hip's distance from the middle over the
// leg.
TEST_F(StartValuesOf, HipsThatHardlyTurnInwardsKeepTheWeightOnTheInnerPartOfTheSole) {
  const auto shift = [this] {
    return standing_pose(scaled(), simulation::load_named_model(robot_), "A test").shift_text;
  };
  EXPECT_NE(shift().find("support: left, com: {y_mm: 0.0}"), std::string::npos);
  limit_hips(12.5);
  const std::string inner = shift();
  EXPECT_EQ(inner.find("support: left, com: {y_mm: 0.0}"), std::string::npos);
  EXPECT_NE(inner.find("support: left, com: {y_mm: -"), std::string::npos);
  EXPECT_NE(inner.find("support: right, com: {y_mm: "), std::string::npos);
}

TEST_F(StartValuesOf, AnklesThatBendLittleStraightenTheLegs) {
  const StartValues before = scaled();
  for (sim_board::JointDescription& joint : robot_.joints)
    if (joint.name.ends_with("_ankle_pitch")) joint.lower_rad = -44.0 * kRadPerDegree;
  const StartValues after = scaled();
  EXPECT_GT(after.leg_use, before.leg_use + 0.01);
  EXPECT_NEAR(after.value("com_height_mm"), kMmPerM * after.com_height_m, 1e-9);
  static_cast<void>(standing_pose(after, simulation::load_named_model(robot_), "A test"));
}

TEST_F(StartValuesOf, AHeavierTrunkBendTheKneesAlike) {
  const StartValues before = scaled();
  robot_.links[0].mass_kg *= 1.5;
  const StartValues after = scaled();
  EXPECT_GT(after.com_height_m, before.com_height_m);
  EXPECT_NEAR(after.leg_use, before.leg_use, 1e-9);
}

TEST_F(StartValuesOf, AComHeightOutOfTheLegsReachIsRefused) {
  try {
    static_cast<void>(scaled({.com_height = 0.72}));
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("CoM height"), std::string::npos) << error.what();
  }
}

// The parameters have no file yet that the error could name, and the value is that of the start.
TEST_F(StartValuesOf, KneesThatHardlyBendAreNamedWithTheRobotsFile) {
  const double com_height_mm = scaled().value("com_height_mm");
  for (sim_board::JointDescription& joint : robot_.joints)
    if (joint.name.ends_with("_knee")) joint.upper_rad = 20.0 * kRadPerDegree;
  try {
    static_cast<void>(scaled());
    FAIL();
  } catch (const InputError& error) {
    EXPECT_EQ(error.file(), kKoboshi);
    EXPECT_NE(error.found().find("start values do not fit it: com_height_mm = "), std::string::npos)
        << error.what();
    EXPECT_NEAR(std::stod(error.found().substr(error.found().find("= ") + 2)), com_height_mm, 0.1);
  }
}

}  // namespace
}  // namespace koboshi::lab
