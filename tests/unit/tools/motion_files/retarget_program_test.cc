#include "tools/motion_files/retarget_program.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstddef>
#include <filesystem>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "base/text/error.h"
#include "sim_board/description/load.h"
#include "simulation/motion_language/compile/compile.h"

namespace koboshi::tools {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

sim_board::RobotDescription load(const std::string& robot) {
  return sim_board::load_robot(std::string(KOBOSHI_SOURCE_DIR) + "/robots/" + robot + "/robot.sdf");
}

// A program of nearly all steps, with names that people chose.
const std::string kProgram = R"(# Looks around, and bends a knee where it has room.
version: 2
robot: koboshi
name: all
interpolation: minimum_jerk
variables: {rounds: 0}
exit: leave
poses:
  stand: {others: zero, knee: 20}  # both
  bent: {from: stand, left_knee: 40, head_pan: 10}
  look: {head_pan: -10}
routines:
  glance:
    - {pose: look, time_s: 0.5}
    - return
steps:
  - {pose: stand, time_s: 2}
  - {pose: bent, time_s: 2, path: zmp}
  - {stiffness: {knee: 50, head_pan: 30}}
  - {torque_off: [head_pan]}
  - {gain: {left_knee: 80}}
  - loop:
      until: stopped  # by the operator
      steps:
        - {pose: bent, time_s: 1, during: {left_knee: [0.5, 1], head_pan: [0, 0.5]}}
        - {pose: {left_knee: 10}, time_s: 0.5, mix: {left_knee: {pitch_rate: 0.05, limit_deg: 3}}, lean: {pitch_deg: 5}}
        - {call: glance}
        - {set: {rounds: += 1}}
  - {label: leave}
  - {if: "angle_mdeg(left_knee) > 5000 and left_load_mN < 100", then: [{wait_s: 0.1}], else: [fail]}
  - {wait: {until: "-error_mdeg(left_knee) < 3000", timeout_s: 2, else: continue}}
  - {expect: {pitch_deg: 0, roll_deg: 0, within_deg: 30}}
  - {mix: none}
  - {pose: stand, time_s: 2}
)";

class RetargetProgramTest : public testing::Test {
 protected:
  RetargetedMotion retarget(const std::string& text, const ConversionOptions& options = {},
                            bool by_targets = false) const {
    const simulation::NamedModel from_model = simulation::load_named_model(from);
    const simulation::NamedModel to_model = simulation::load_named_model(to);
    return retarget_program(simulation::read_motion_text("a.yaml", text), {from, from_model}, {to, to_model},
                            by_targets, options);
  }
  std::vector<std::byte> image_of(const sim_board::RobotDescription& robot, const std::string& text) const {
    const simulation::NamedModel model = simulation::load_named_model(robot);
    const simulation::MotionFile file = simulation::read_motion_text("a.yaml", text);
    simulation::Diagnostics messages(file.path, file.text);
    const simulation::MotionSource motion = simulation::parse_motion(file, model, messages);
    messages.throw_errors();
    return simulation::compile_motion(motion, model);
  }
  sim_board::JointDescription& joint(const std::string& name) {
    return to.joints[static_cast<std::size_t>(*to.find_joint(name))];
  }
  const sim_board::RobotDescription from = load("koboshi");
  sim_board::RobotDescription to = from;
};

TEST_F(RetargetProgramTest, KeepsTheProgramForTheSameRobot) {
  const RetargetedMotion result = retarget(kProgram);
  EXPECT_THAT(result.report, IsEmpty());
  EXPECT_THAT(result.text,
              testing::StartsWith("# Retargeted from a.yaml, a motion of koboshi.\n# Looks around"));
  EXPECT_THAT(result.text, HasSubstr("until: stopped  # by the operator\n"));
  EXPECT_EQ(image_of(to, result.text), image_of(from, kProgram));
}

// Another name, and an axis that points the other way: in poses, corrections and conditions. Settings keep a
// name that is the joint's role.
TEST_F(RetargetProgramTest, NamesAndTurnsJointsAsTheOtherRobotHasThem) {
  sim_board::JointDescription& knee = joint("left_knee");
  knee.name = "l_leg_kny";
  knee.stated_role = "left_knee";
  knee.axis_M = -knee.axis_M;
  std::swap(knee.lower_rad, knee.upper_rad);
  knee.lower_rad = -knee.lower_rad;
  knee.upper_rad = -knee.upper_rad;
  std::string text = kProgram;
  text.erase(text.find(", path: zmp"), 11);  // closed forms do not know such legs
  const RetargetedMotion result = retarget(text);
  EXPECT_THAT(result.report, ElementsAre(HasSubstr("turn the other way in koboshi: left_knee")));
  EXPECT_THAT(result.text,
              AllOf(HasSubstr("l_leg_kny: -40"), HasSubstr("{stiffness: {knee: 50, head_pan: 30}}"),
                    HasSubstr("gain: {left_knee: 80}"),
                    HasSubstr("during: {left_knee: [0.5, 1], head_pan: [0, 0.5]}"),
                    HasSubstr("pose: {l_leg_kny: -10}"),
                    HasSubstr("mix: {left_knee: {pitch_rate: -0.05, limit_deg: 3}}"),
                    HasSubstr("\"-angle_mdeg(l_leg_kny) > 5000 and left_load_mN < 100\""),
                    HasSubstr("until: \"error_mdeg(l_leg_kny) < 3000\"")));
  EXPECT_FALSE(image_of(to, result.text).empty());
}

TEST_F(RetargetProgramTest, LeavesOutWhatTheOtherRobotLacks) {
  to = load("chibi");  // no hip yaw, no tilting head
  const std::string text =
      "version: 2\nrobot: koboshi\nname: a\nposes:\n  stand: {others: zero}\n  nod: {head_tilt: 10}\n"
      "  both: {head_tilt: 5, head_pan: 5}\nsteps:\n  - {pose: stand, time_s: 2}\n"
      "  - {stiffness: {head_tilt: 50}}\n  - {pose: nod, time_s: 0.5, pause_s: 0.25}\n"
      "  - {pose: both, time_s: 1, stiffness: {head_tilt: 20}, gain: {head: 90}}\n"
      "  - {pose: nod, speed_deg_per_s: 10}\n";
  const RetargetedMotion result = retarget(text);
  EXPECT_THAT(result.text,
              AllOf(HasSubstr("steps:\n  - {pose: stand, time_s: 2}\n  - {wait_s: 0.75}\n"
                              "  - {pose: both, time_s: 1, gain: {head: 90}}\n"),
                    Not(HasSubstr("nod")), Not(HasSubstr("tilt")), HasSubstr("both: {head_pan: 5}")));
  EXPECT_THAT(result.report, Contains("line 10: stiffness of joints that chibi lacks is left out"));
  EXPECT_THAT(result.report, Contains("line 11: a move of joints that chibi lacks is a wait"));
  EXPECT_THAT(result.report, Contains("line 13: a move of joints that chibi lacks is left out"));
  EXPECT_FALSE(image_of(to, result.text).empty());
}

TEST_F(RetargetProgramTest, RefusesConditionsAboutJointsThatTheOtherRobotLacks) {
  to = load("chibi");
  const std::string text =
      "version: 2\nrobot: koboshi\nname: a\nposes:\n  p: {left_knee: 20}\nsteps:\n"
      "  - {loop: {while: \"angle_mdeg(head_tilt) > 0\", steps: [{pose: p, time_s: 1}]}}\n";
  try {
    static_cast<void>(retarget(text));
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("a.yaml:7: found a condition about head_tilt, which chibi lacks"));
  }
}

// A third of the speed: moves get the time, parts of moves in proportion, and speeds become slower.
TEST_F(RetargetProgramTest, GivesMovesTheTimeThatTheServosNeed) {
  const std::string text =
      "version: 2\nrobot: koboshi\nname: a\nposes:\n  p: {left_knee: 0}\n  q: {left_knee: 60}\nsteps:\n"
      "  - {pose: p, time_s: 1}\n  - {pose: q, time_s: 1}\n"
      "  - {pose: p, time_s: 2, during: {left_knee: [0.5, 1.5]}}\n  - {pose: q, speed_deg_per_s: 60}\n"
      "  - {pose: p, at_least_s: 0.1}\n  - {pose: q, time_s: 20}\n";
  joint("left_knee").max_speed_rad_per_s = 40.0 * std::numbers::pi / 180.0;
  const RetargetedMotion fast = retarget(text);
  EXPECT_EQ(fast.too_fast, 3u);
  EXPECT_EQ(fast.stretched, 0u);
  EXPECT_THAT(fast.report,
              Contains("move to pose q: is too fast: left_knee would have to move by 60 degrees/s"));
  const RetargetedMotion result = retarget(text, {.retime = true, .largest_clamp_rad = {}});
  EXPECT_EQ(result.stretched, 3u);
  EXPECT_THAT(result.report, ElementsAre(HasSubstr("1 -> 1.667 s"), HasSubstr("2 -> 3.334 s"),
                                         HasSubstr("60 -> 35.999 degrees/s")));
  EXPECT_THAT(result.text, HasSubstr("during: {left_knee: [0.8335, 2.5005]}"));
  EXPECT_EQ(retarget(result.text).too_fast, 0u);
}

TEST_F(RetargetProgramTest, ClampsAnglesAndSaysSo) {
  joint("left_knee").upper_rad = 30.0 * std::numbers::pi / 180.0;
  const std::string text =
      "version: 2\nrobot: koboshi\nname: a\nposes:\n  p: {knee: 40}\nsteps:\n  - {pose: p, time_s: 1}\n"
      "  - {pose: {left_knee: 50}, time_s: 1}\n";
  const RetargetedMotion result = retarget(text);
  EXPECT_THAT(result.report, ElementsAre("pose p: left_knee 40 -> 30 degrees, its limit",
                                         "line 8: left_knee 50 -> 30 degrees, its limit"));
  EXPECT_THAT(result.text, HasSubstr("p: {left_knee: 30, right_knee: 40}"));
  EXPECT_THROW(static_cast<void>(retarget(text, {.retime = false, .largest_clamp_rad = 0.1})), InputError);
}

// A step that plays the mirror image of its own pose.
TEST_F(RetargetProgramTest, KeepsMirrorImagesOfPosesWithinSteps) {
  const std::string text =
      "version: 2\nrobot: koboshi\nname: a\nsteps:\n"
      "  - {pose: {left_shoulder_roll: 20, left_elbow: -30}, mirror: true, time_s: 1}\n";
  const RetargetedMotion result = retarget(text);
  EXPECT_THAT(result.text, HasSubstr("pose: {left_shoulder_roll: 20, left_elbow: -30}, mirror: true"));
  EXPECT_EQ(image_of(to, result.text), image_of(from, text));
}

// Every motion of the robot that has no angles of legs which others lack: the program stays, and compiles.
TEST_F(RetargetProgramTest, GivesMotionsOfTheLibraryToOtherRobots) {
  for (const std::string name : {"hanpo", "noppo", "chibi"}) {
    to = load(name);
    for (const std::string motion : {"balance", "greet", "push_up", "squat", "touch_floor", "wave"}) {
      const auto file =
          std::filesystem::path(KOBOSHI_SOURCE_DIR) / "robots/koboshi/motions" / (motion + ".yaml");
      const simulation::NamedModel from_model = simulation::load_named_model(from);
      const simulation::NamedModel to_model = simulation::load_named_model(to);
      const RetargetedMotion result =
          retarget_program(simulation::read_motion_file(file), {from, from_model}, {to, to_model}, true,
                           {.retime = true, .largest_clamp_rad = {}});
      EXPECT_FALSE(image_of(to, result.text).empty()) << name << ' ' << motion;
    }
  }
}

}  // namespace
}  // namespace koboshi::tools
