#include "tools/motion_files/convert.h"

#include <gtest/gtest.h>

#include <string>

#include "base/text/error.h"
#include "sim_board/description/load.h"
#include "simulation/motion_language/compile/compile.h"
#include "simulation/motion_language/parse/parse.h"
#include "tests/support/temporary_folder.h"
#include "tools/motion_files/format/readers.h"

namespace koboshi::tools {
namespace {

class ConvertTest : public testing::Test {
 protected:
  const sim_board::RobotDescription robot =
      sim_board::load_robot(std::string(KOBOSHI_SOURCE_DIR) + "/robots/koboshi/robot.sdf");
  const simulation::NamedModel model = simulation::load_named_model(robot);

  ConvertedMotion convert(const std::string& bytes, const ConversionOptions& options = {},
                          const std::filesystem::path& map = {}) const {
    const ForeignMotion motion = read_foreign_motions("file.motion", bytes).front();
    return convert_motion("file.motion", motion, find_joints("file.motion", motion, robot, map), model,
                          options);
  }
  // Whether the motion language takes the text.
  std::string errors_of(const ConvertedMotion& converted) const {
    const simulation::MotionFile file = simulation::read_motion_text("motion.yaml", converted.text);
    simulation::Diagnostics diagnostics(file.path, file.text);
    try {
      const simulation::MotionSource source = simulation::parse_motion(file, model, diagnostics);
      static_cast<void>(simulation::compile_motion(source, model, diagnostics));
      diagnostics.throw_errors();
    } catch (const simulation::MotionError& error) {
      return error.what();
    }
    return {};
  }
};

bool has(const std::vector<std::string>& report, const std::string& part) {
  for (const std::string& line : report) {
    if (line.find(part) != std::string::npos) return true;
  }
  return false;
}

TEST_F(ConvertTest, WritesAMotionOfTheMotionLanguage) {
  const ConvertedMotion converted = convert(
      "#WEBOTS_MOTION,V1.0,left_knee,head_pan\n00:00:000,a,0.5,*\n00:01:500,b,0.7,0.1\n00:01:750,c,0.7,0."
      "1\n");
  EXPECT_EQ(converted.text,
            "# Imported from file.motion, a motion of Webots.\nversion: 2\nrobot: \"koboshi\"\nname: "
            "\"file\"\nposes:\n"
            "  p1: {left_knee: 28.648}\n  p2: {left_knee: 40.107, head_pan: 5.73}\n  p3: {left_knee: 40.107, "
            "head_pan: 5.73}\n"
            "steps:\n  - {pose: p1, time_s: 1}\n  - {pose: p2, time_s: 1.5}\n  - {pose: p3, time_s: 0.25}\n");
  EXPECT_EQ(errors_of(converted), "");
  EXPECT_EQ(converted.frames, 3u);
  EXPECT_TRUE(has(converted.report, "line 2: the first move takes 1 s instead of 0 s"))
      << converted.report.front();
}

TEST_F(ConvertTest, NamesAMotionWithoutAsciiByItsFile) {
  ForeignMotion motion{
      .format = MotionFormat::kRoboplusPages,
      .name = "\xE6\xAD\xA9\xE3\x81\x8F",
      .joints = {{.name = "left_knee"}},
      .sections = {{.frames = {{.place = "step 1", .move_us = 1'000'000, .values = {0.5}}}}}};
  const auto text_of = [&](const char* file) {
    return convert_motion(file, motion, find_joints(file, motion, robot), model, {}).text;
  };
  EXPECT_NE(text_of("walk.bin").find("\nname: \"walk\"\n"), std::string::npos) << text_of("walk.bin");
  EXPECT_NE(text_of("\xE6\xAD\xA9.bin").find("\nname: \"imported\"\n"), std::string::npos);
}

TEST_F(ConvertTest, RefusesAMotionThatMovesNothing) {
  try {
    static_cast<void>(convert("#WEBOTS_MOTION,V1.0,left_knee\n00:00:000,a,*\n00:01:000,b,*\n"));
    FAIL();
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(), "file.motion: found no angle of a joint of koboshi, expected at least one");
  }
}

TEST_F(ConvertTest, ClampsAndSaysSoOrRefuses) {
  const std::string file = "t,left_knee_deg\n0,20\n1,171\n";
  const ConvertedMotion converted = convert(file);
  EXPECT_EQ(converted.clamped, 1u);
  EXPECT_TRUE(has(converted.report, "line 3: left_knee 171 -> ")) << converted.report.back();
  EXPECT_EQ(errors_of(converted), "");
  try {
    static_cast<void>(convert(file, {.retime = false, .largest_clamp_rad = 0.01}));
    FAIL() << "nothing was refused";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("line 3: left_knee at 171 degrees"), std::string::npos)
        << error.what();
  }
}

TEST_F(ConvertTest, StretchesMovesOnlyWhenTold) {
  const std::string file = "t,left_knee_deg\n0,0\n0.01,90\n3,90\n";
  const ConvertedMotion as_it_is = convert(file);
  EXPECT_EQ(as_it_is.too_fast, 1u);
  EXPECT_EQ(as_it_is.stretched, 0u);
  EXPECT_NE(errors_of(as_it_is), "");
  const ConvertedMotion slower = convert(file, {.retime = true, .largest_clamp_rad = {}});
  EXPECT_EQ(slower.stretched, 1u);
  EXPECT_EQ(errors_of(slower), "");
  EXPECT_GT(slower.duration_s, slower.original_s + 1.0);
}

// The servo of the knee turns by 428.6 degrees/s; the file asks for 600, and for 100.
TEST_F(ConvertTest, GivesFramesBySpeedTheTimeThatTheirJointsNeed) {
  ForeignMotion motion{.format = MotionFormat::kRoboplusPages,
                       .name = "kick",
                       .joints = {{.name = "left_knee"}},
                       .sections = {{.frames = {{.place = "step 1", .move_us = 1'000'000, .values = {0.0}},
                                                {.place = "step 2", .move_us = 150'000, .values = {1.5}},
                                                {.place = "step 3", .move_us = 860'000, .values = {0.0}}}}}};
  for (ForeignFrame& frame : motion.sections.front().frames) frame.by_speed = true;
  const JointMap map = find_joints("kick.bin", motion, robot);
  const ConvertedMotion converted = convert_motion("kick.bin", motion, map, model, {});
  EXPECT_NE(converted.text.find("{pose: p2, at_least_s: 0.15}"), std::string::npos) << converted.text;
  EXPECT_NE(converted.text.find("{pose: p3, time_s: 0.86}"), std::string::npos) << converted.text;
  EXPECT_EQ(converted.too_fast, 0u);
  EXPECT_EQ(errors_of(converted), "");
  EXPECT_TRUE(has(converted.report, "step 2: at least 0.15 s, and as much more as left_knee needs"));
  EXPECT_NEAR(converted.duration_s, 1.0 + 1.5 / 7.48 + 0.86, 0.001);
  // --retime leaves a margin of a tenth instead.
  const ConvertedMotion retimed = convert_motion("kick.bin", motion, map, model, {.retime = true});
  EXPECT_EQ(retimed.text.find("at_least_s"), std::string::npos) << retimed.text;
  EXPECT_EQ(retimed.stretched, 1u);
}

TEST_F(ConvertTest, LeavesOutFramesOnAStraightLine) {
  std::string file = "t,left_knee_deg,head_pan_deg\n";
  for (int i = 0; i <= 100; ++i)
    file += std::to_string(0.02 * i) + "," + std::to_string(0.5 * std::min(i, 60)) + "," +
            std::to_string(0.1 * i) + "\n";
  const ConvertedMotion converted = convert(file);
  EXPECT_EQ(converted.frames, 101u);
  EXPECT_EQ(converted.left_out, 98u);
  EXPECT_NE(converted.text.find("left_knee: 30, head_pan: 6}"), std::string::npos) << converted.text;
  EXPECT_NE(converted.text.find("time_s: 1.2}"), std::string::npos) << converted.text;
  EXPECT_EQ(errors_of(converted), "");
}

TEST_F(ConvertTest, KeepsTorqueOffAndRepetitions) {
  const ConvertedMotion torque = convert(
      R"({"keyframes": [{"duration": 1, "goals": {"left_knee": 10}, "torque": {"left_elbow": 0}}, {"duration": 1, "goals": {"left_knee": 20}}]})");
  EXPECT_NE(torque.text.find("  - {torque_off: [left_elbow]}\n  - {pose: p1"), std::string::npos)
      << torque.text;
  EXPECT_NE(torque.text.find("  - {stiffness: {left_elbow: 100}}\n  - {pose: p2"), std::string::npos)
      << torque.text;
  EXPECT_EQ(errors_of(torque), "");
}

TEST_F(ConvertTest, MapsServosByAFile) {
  const test::TemporaryFolder folder;
  const std::filesystem::path map = folder.path / "map.yaml";
  test::write_file(map,
                   "version: 1\njoints:\n  14: {joint: left_knee, sign: -1, zero_ticks: 2000}\n  13: {joint: "
                   "right_knee}\n  servo 3: ignore\n");
  const std::string mtn = "page_begin\nname=kick\nplay_param=0 0 4 1 32\nstep=" +
                          std::string("0 0 0 7 0 0 0 0 0 0 0 0 0 2048 1488 0 1\n") + "page_end\n";
  const std::string enabled = "enable=0 0 0 1 0 0 0 0 0 0 0 0 0 1 1\n" + mtn;
  const ConvertedMotion converted = convert(enabled, {}, map);
  EXPECT_NE(converted.text.find("left_knee: 45, right_knee: 0}"), std::string::npos) << converted.text;
  EXPECT_NE(converted.text.find("  - loop:\n      times: 4\n      steps:\n        - {pose: p1"),
            std::string::npos)
      << converted.text;
  EXPECT_EQ(errors_of(converted), "");
  try {
    static_cast<void>(convert(enabled));
    FAIL() << "a motion without its servos was taken";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what())
                  .find("found servo 3, servo 13, servo 14, expected servos that the robot names"),
              std::string::npos)
        << error.what();
  }
}

TEST_F(ConvertTest, FindsJointsByTheMeaningOfTheirNames) {
  const auto name_of_joint = [&](const std::string& name) {
    const ForeignMotion motion =
        read_foreign_motions("f", "t," + name + "_rad,head_pan_rad\n0,0,0\n").front();
    const auto mapped = find_joints("f", motion, robot).joints.front();
    return mapped ? robot.joints[mapped->joint].name : std::string();
  };
  EXPECT_EQ(name_of_joint("LHipYaw"), "left_hip_yaw");
  EXPECT_EQ(name_of_joint("RKneePitch"), "right_knee");
  EXPECT_EQ(name_of_joint("l_ankle_roll_joint"), "left_ankle_roll");
  EXPECT_EQ(name_of_joint("head_pitch"), "head_tilt");
  EXPECT_EQ(name_of_joint("r_sho_pitch"), "right_shoulder_pitch");
  EXPECT_EQ(name_of_joint("LHipYawPitch"), "");  // one motor for both directions is no joint of this robot
  EXPECT_EQ(name_of_joint("tail"), "");
}

TEST_F(ConvertTest, TurnsAroundAGuessedJointWhoseLimitsSaySo) {
  const ForeignMotion motion = read_foreign_motions("f", "t,l_calf_deg\n0,-60\n").front();
  const JointMap map = find_joints("f", motion, robot);
  EXPECT_EQ(map.joints.front()->sign, -1.0);
  EXPECT_NE(map.notes.back().text.find("l_calf turn the other way"), std::string::npos)
      << map.notes.back().text;
}

TEST_F(ConvertTest, KnowsTheJointsOfADarwin) {
  // The walking pose: hips and ankles back, knees bent, by motors that mirror each other.
  const ConvertedMotion converted = convert(
      "#WEBOTS_MOTION,V1.0,LegUpperR,LegUpperL,LegLowerR,LegLowerL,AnkleR,AnkleL\n"
      "00:01:000,a,-0.5,0.5,0.9,-0.9,0.4,-0.4\n");
  EXPECT_NE(converted.text.find("left_hip_pitch: -28.648, left_knee: 51.566, left_ankle_pitch: -22.918, "
                                "right_hip_pitch: -28.648, right_knee: 51.566, right_ankle_pitch: -22.918"),
            std::string::npos)
      << converted.text;
  EXPECT_TRUE(has(converted.report, "taken for those of a DARwIn-OP"));
}

TEST_F(ConvertTest, TurnsGuessedHipsAndAnklesSoThatSolesAreLevel) {
  const ConvertedMotion converted = convert(
      "t,l_hip_pitch_deg,l_calf_deg,l_ankle_pitch_deg,r_hip_pitch_deg,r_calf_deg,r_ankle_pitch_deg\n"
      "1,-30,-60,-30,30,60,30\n2,-20,-41,-22,20,41,20\n");
  EXPECT_NE(converted.text.find(
                "p1: {left_hip_pitch: -30, left_knee: 60, left_ankle_pitch: -30, right_hip_pitch: -30, "
                "right_knee: 60, right_ankle_pitch: -30}"),
            std::string::npos)
      << converted.text;
  EXPECT_TRUE(
      has(converted.report, "limits or level soles say that l_calf, r_hip_pitch, r_ankle_pitch turn"));
}

}  // namespace
}  // namespace koboshi::tools
