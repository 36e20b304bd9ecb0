#include "lab/bring_up/recovery_motion.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "base/text/error.h"
#include "sim_board/description/load.h"
#include "simulation/model/robot_model.h"
#include "simulation/motion_language/compile/compile.h"
#include "simulation/motion_language/parse/parse.h"

namespace koboshi::lab {
namespace {

const std::filesystem::path kRecovering =
    std::filesystem::path(KOBOSHI_SOURCE_DIR) / "robots/koboshi/robot.sdf";

class RecoveryMotionTest : public testing::Test {
 protected:
  RecoveryMotion retargeted(const char* name, double time_scale = 1.0) const {
    return RecoveryMotion::retarget(name, kRecovering, robot_, standing_, time_scale);
  }
  simulation::MotionSource parsed(const std::string& text) const {
    const simulation::NamedModel model = simulation::load_named_model(robot_);
    const simulation::MotionFile file = simulation::read_motion_text("motion.yaml", text);
    simulation::Diagnostics diagnostics(file.path, file.text);
    simulation::MotionSource source = simulation::parse_motion(file, model, diagnostics);
    static_cast<void>(simulation::compile_motion(source, model, diagnostics));
    diagnostics.throw_errors();
    return source;
  }

  sim_board::RobotDescription robot_ = sim_board::load_robot(kRecovering);
  std::vector<std::pair<std::string, double>> standing_{{"left_knee", 40.0}, {"right_knee", 40.0}};
};

TEST_F(RecoveryMotionTest, OfTheSameRobotHasTheSamePosesTimesAndExpectations) {
  const simulation::NamedModel model = simulation::load_named_model(robot_);
  for (const char* name : {"fall_front", "roll_left", "rise_prone", "rise_supine"}) {
    const std::filesystem::path folder =
        kRecovering.parent_path() / (std::string_view(name).starts_with("rise") ? "bring_up" : "motions");
    const simulation::MotionSource own =
        simulation::parse_motion(folder / (std::string(name) + ".yaml"), model);
    const simulation::MotionSource copy = parsed(retargeted(name).text("Origin"));
    ASSERT_EQ(copy.steps.size(), own.steps.size()) << name;
    for (std::size_t i = 0; i < own.steps.size(); ++i) {
      ASSERT_EQ(copy.steps[i].kind, own.steps[i].kind) << name << " " << i;
      EXPECT_EQ(copy.steps[i].attitude.up_B, own.steps[i].attitude.up_B);
      EXPECT_EQ(copy.steps[i].attitude.min_cosine, own.steps[i].attitude.min_cosine);
      if (own.steps[i].kind != simulation::StepSource::Kind::kMove) continue;
      EXPECT_EQ(copy.steps[i].at_least, own.steps[i].at_least || i == 0) << name << " begins anywhere";
      // Never shorter, and longer only where the servos need it.
      EXPECT_GE(copy.steps[i].time_us, own.steps[i].time_us);
      EXPECT_LE(copy.steps[i].time_us, 2 * own.steps[i].time_us);
      const simulation::PoseSource& pose = own.poses[own.steps[i].pose];
      if (pose.name == "stand") continue;
      for (std::size_t joint = 0; joint < pose.angles.size(); ++joint) {
        const auto& other = copy.poses[copy.steps[i].pose].angles[joint];
        ASSERT_EQ(other.has_value(), pose.angles[joint].has_value());
        if (!other) continue;
        EXPECT_NEAR(other->raw(), pose.angles[joint]->raw(), 0.03 / 360.0 * 4294967296.0);
      }
    }
  }
}

TEST_F(RecoveryMotionTest, KeepsWithinTheLimitsOfTheOtherRobot) {
  for (sim_board::JointDescription& joint : robot_.joints) joint.upper_rad = std::min(joint.upper_rad, 1.0);
  static_cast<void>(parsed(retargeted("rise_prone").text("Origin")));  // the compiler checks the limits
}

TEST_F(RecoveryMotionTest, ScalesTimesAndGivesSlowServosMore) {
  const auto duration_us = [&](const RecoveryMotion& motion) {
    std::uint64_t sum = 0;
    for (const simulation::StepSource& step : parsed(motion.text("Origin")).steps) sum += step.time_us;
    return sum;
  };
  const std::uint64_t own = duration_us(retargeted("rise_supine"));
  EXPECT_NEAR(static_cast<double>(duration_us(retargeted("rise_supine", 2.0))),
              2.0 * static_cast<double>(own), 0.2 * static_cast<double>(own));
  for (sim_board::JointDescription& joint : robot_.joints) joint.max_speed_rad_per_s *= 0.3;
  EXPECT_GT(duration_us(retargeted("rise_supine")), own);
}

TEST_F(RecoveryMotionTest, TheMiddleOfTheBoxChangesNothingAndMovesBothSidesAlike) {
  const RecoveryMotion motion = retargeted("rise_prone");
  const auto variables = motion.variables();
  ASSERT_GT(variables.size(), 10u);
  std::vector<double> x(variables.size(), 0.5);
  EXPECT_EQ(motion.with(variables, x).text("Origin"), motion.text("Origin"));
  const auto hip = std::ranges::find(variables, "hip_pitch", &RecoveryMotion::Variable::role);
  x[static_cast<std::size_t>(hip - variables.begin())] = 0.6;
  const auto before = parsed(motion.text("Origin")).poses[hip->pose].angles;
  const auto after = parsed(motion.with(variables, x).text("Origin")).poses[hip->pose].angles;
  const auto left = static_cast<std::size_t>(*robot_.find_joint("left_hip_pitch"));
  const auto right = static_cast<std::size_t>(*robot_.find_joint("right_hip_pitch"));
  EXPECT_NE(after[left]->raw(), before[left]->raw());
  EXPECT_EQ(after[left]->raw() - before[left]->raw(), after[right]->raw() - before[right]->raw());
}

TEST_F(RecoveryMotionTest, DropsAndNamesJointsThatTheRobotLacks) {
  std::erase_if(robot_.joints,
                [](const sim_board::JointDescription& joint) { return joint.name == "head_tilt"; });
  const RecoveryMotion motion = retargeted("fall_front");
  ASSERT_EQ(motion.notes().size(), 1u);
  EXPECT_NE(motion.notes().front().find("head_tilt"), std::string::npos);
  EXPECT_EQ(motion.text("Origin").find("head_tilt"), std::string::npos);
}

// The legs of the reference have equal thighs and shanks, so that half of the knee's angle is that between
// shank and leg.
TEST_F(RecoveryMotionTest, KneesThatEndEarlyKeepTheDirectionOfTheLegAndTheLeanOfTheTrunk) {
  const auto angle_deg = [&](const simulation::MotionSource& motion, const char* pose, const char* joint) {
    const auto found = std::ranges::find(motion.poses, pose, &simulation::PoseSource::name);
    const auto& angle = found->angles[static_cast<std::size_t>(*robot_.find_joint(joint))];
    return angle->raw() * 360.0 / 4294967296.0;
  };
  const simulation::MotionSource own = parsed(retargeted("rise_prone").text("Origin"));
  for (sim_board::JointDescription& joint : robot_.joints)
    if (joint.name.ends_with("_knee")) joint.upper_rad = 110.0 / 57.29577951308232;
  const simulation::MotionSource other = parsed(retargeted("rise_prone").text("Origin"));
  const double cut_deg = 10.0;  // of the 120 degrees of `tuck`
  EXPECT_NEAR(angle_deg(other, "tuck", "left_knee"), 110.0, 0.1);
  EXPECT_NEAR(angle_deg(other, "tuck", "left_ankle_pitch"), -80.0 + 0.5 * cut_deg, 0.1);
  EXPECT_NEAR(angle_deg(other, "tuck", "left_hip_pitch"), -110.0 + 0.5 * cut_deg, 0.1);
  EXPECT_NEAR(angle_deg(other, "stand", "left_knee"), 40.0, 0.1);
  for (const char* joint : {"left_hip_pitch", "left_knee", "left_ankle_pitch"})
    EXPECT_NEAR(angle_deg(other, "spread", joint), angle_deg(own, "spread", joint), 0.1) << joint;
}

TEST_F(RecoveryMotionTest, OverTheSideOneSidePushesAndTheRestIsTheRiseFromTheChest) {
  const RecoveryMotion prone = retargeted("rise_prone");
  const simulation::MotionSource chest = parsed(prone.text("Origin"));
  const simulation::MotionSource side = parsed(RecoveryMotion::over_the_side(prone).text("Origin"));
  EXPECT_EQ(side.name, "rise_supine");
  ASSERT_EQ(side.steps.size(), chest.steps.size() + 5);
  EXPECT_LT(side.steps[1].attitude.up_B[0] * chest.steps[2].attitude.up_B[0], 0);  // back and chest
  for (std::size_t i = 0; i < chest.steps.size(); ++i)
    EXPECT_EQ(side.steps[i + 5].kind, chest.steps[i].kind) << i;
  const simulation::PoseSource& push = side.poses[side.steps[2].pose];
  for (std::size_t joint = 0; joint < push.angles.size(); ++joint)
    EXPECT_EQ(push.angles[joint].has_value(), robot_.joints[joint].name == "right_shoulder_pitch" ||
                                                  robot_.joints[joint].name == "right_hip_pitch");
}

TEST_F(RecoveryMotionTest, FindsTheStepOfALine) {
  const RecoveryMotion motion = retargeted("rise_prone");
  const simulation::MotionSource source = parsed(motion.text("Origin"));
  for (std::size_t i = 0; i < source.steps.size(); ++i)
    EXPECT_EQ(motion.step_of_line(source.steps[i].place.line), i);
  EXPECT_FALSE(motion.step_of_line(3));
  EXPECT_FALSE(motion.step_of_line(source.steps.back().place.line + 1));
}

}  // namespace
}  // namespace koboshi::lab
