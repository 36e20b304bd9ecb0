#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "base/text/error.h"
#include "sim_board/description/load.h"
#include "simulation/motion_language/compile/compile.h"
#include "simulation/motion_language/parse/parse.h"
#include "tests/support/temporary_folder.h"
#include "tools/motion_files/convert.h"
#include "tools/motion_files/export.h"
#include "tools/motion_files/format/readers.h"
#include "tools/motion_files/joint_map.h"

namespace koboshi::tools {
namespace {

using testing::HasSubstr;

// Servo numbers of some joints, and a name.
constexpr const char* kServos = R"(version: 1
joints:
  13: {joint: right_knee, sign: 1, zero_ticks: 2000, ticks_per_turn: 4096}
  14: {joint: left_knee, sign: -1}
  19: {joint: head_pan, zero_deg: 5}
  LegLowerL: {joint: left_knee, sign: -1}
)";

class ExportTest : public testing::Test {
 protected:
  ExportTest() { test::write_file(map, kServos); }

  ExportedMotion exported(const std::string& text, const std::string& format) const {
    const simulation::MotionFile file = simulation::read_motion_text("motion.yaml", text);
    simulation::Diagnostics messages(file.path, file.text);
    const simulation::MotionSource source = simulation::parse_motion(file, model, messages);
    messages.throw_errors();
    return export_motion(source, *writable_format(format), robot, model, map);
  }
  std::string imported(const std::string& bytes) const {
    const ForeignMotion motion = read_foreign_motions("file", bytes).front();
    return convert_motion("file", motion, find_joints("file", motion, robot, map), model).text;
  }
  // The frames without the first line, which names the format, the motion's name, and the interpolation.
  static std::string frames_of(const std::string& text) { return text.substr(text.find("poses:")); }

  const test::TemporaryFolder folder;
  const std::filesystem::path map = folder.path / "map.yaml";
  const sim_board::RobotDescription robot =
      sim_board::load_robot(std::string(KOBOSHI_SOURCE_DIR) + "/robots/koboshi/robot.sdf");
  const simulation::NamedModel model = simulation::load_named_model(robot);
};

// Times that a controller's cycles of 8 ms can express, partial poses, no pauses.
constexpr const char* kMotion = R"(version: 2
robot: koboshi
name: squat
poses:
  p1: {left_knee: 10.127, right_knee: 20.5, head_pan: 0}
  p2: {left_knee: 60.033, right_knee: 0}
  p3: {left_knee: 12, right_knee: 35.001, head_pan: 30}
steps:
  - {pose: p1, time_s: 1}
  - {pose: p2, time_s: 0.352}
  - {pose: p3, time_s: 0.4}
)";

TEST_F(ExportTest, RoundTripsAreTheIdentity) {
  for (const std::string format : {"webots", "csv", "bit-bots", "pseq"}) {
    const std::string bytes = exported(kMotion, format).bytes;
    const std::string text = imported(bytes);
    EXPECT_EQ(
        frames_of(text),
        "poses:\n"
        "  p1: {left_knee: 10.127, right_knee: 20.5, head_pan: 0}\n"
        "  p2: {left_knee: 60.033, right_knee: 0}\n"
        "  p3: {left_knee: 12, right_knee: 35.001, head_pan: 30}\n"
        "steps:\n  - {pose: p1, time_s: 1}\n  - {pose: p2, time_s: 0.352}\n  - {pose: p3, time_s: 0.4}\n")
        << format;
    EXPECT_EQ(imported(exported(text, format).bytes), text) << format;
  }
}

TEST_F(ExportTest, RoundTripsKeepTheTimeOfTheFirstMove) {
  std::string motion = kMotion;
  motion.replace(motion.find("time_s: 1}"), 10, "time_s: 1.6}");  // a multiple of the 8 ms of ROBOTIS
  for (const std::string format : {"webots", "csv", "bit-bots", "pseq", "mtn", "bin"})
    EXPECT_THAT(imported(exported(motion, format).bytes), HasSubstr("{pose: p1, time_s: 1.6}")) << format;
}

TEST_F(ExportTest, RoundTripsInTicksAreTheIdentityFromTheFirstImportOn) {
  for (const std::string format : {"mtn", "bin"}) {
    const std::string bytes = exported(kMotion, format).bytes;
    const std::string text = imported(bytes);
    EXPECT_THAT(text, HasSubstr("{pose: p2, time_s: 0.352}")) << format;
    EXPECT_THAT(text, HasSubstr("left_knee: 10.107")) << format;  // 115 ticks of 360 / 4096 degrees
    EXPECT_EQ(imported(exported(text, format).bytes), text) << format;
    EXPECT_EQ(exported(text, format).bytes, bytes) << format;
  }
}

TEST_F(ExportTest, UsesNamesNumbersAndSignsOfTheMap) {
  const std::string webots = exported(kMotion, "webots").bytes;
  EXPECT_THAT(webots, HasSubstr("#WEBOTS_MOTION,V1.0,LegLowerL,right_knee,head_pan\n00:01:000,Pose1,-0.17"));
  EXPECT_THAT(webots, HasSubstr("00:01:352,Pose2,-1.0477735,0.0000000,*\n"));
  EXPECT_THAT(exported(kMotion, "mtn").bytes, HasSubstr("enable=0 0 0 0 0 0 0 0 0 0 0 0 0 1 1 0 0 0 0 1\n"));
}

TEST_F(ExportTest, KeepsPausesTorqueAndLoops) {
  const std::string motion =
      "version: 2\nrobot: koboshi\nname: a\nposes:\n  p: {left_knee: 10}\n  q: {left_knee: 20}\nsteps:\n"
      "  - loop:\n      times: 2\n      steps:\n        - {pose: p, time_s: 1, pause_s: 0.2}\n        - "
      "{wait_s: 0.04}\n"
      "  - {pose: q, time_s: 1, stiffness: {left_knee: 0}}\n";
  const ForeignMotion frames = read_foreign_motions("file", exported(motion, "bit-bots").bytes).front();
  const auto& list = frames.sections.front().frames;
  ASSERT_EQ(list.size(), 3u);
  EXPECT_EQ(list[1].pause_us, 240'000);
  EXPECT_TRUE(list[1].without_torque.empty());
  EXPECT_EQ(list[2].without_torque.size(), 1u);
  EXPECT_NEAR(exported(motion, "csv").duration_s, 3.48, 1e-9);
  EXPECT_THAT(exported(motion, "csv").report, testing::Contains(HasSubstr("no joints without torque")));
}

// The knee turns to 40 degrees from 0.25 s to 0.5 s, the elbow to -20 degrees in the whole second.
TEST_F(ExportTest, WritesAKeyFrameAtEachEndOfAJointsOwnTime) {
  const std::string motion =
      "version: 2\nrobot: koboshi\nname: a\nsteps:\n"
      "  - {pose: {left_knee: 0, left_elbow: 0}, time_s: 1}\n"
      "  - {pose: {left_knee: 40, left_elbow: -20}, time_s: 1, pause_s: 0.5, during: {left_knee: [0.25, "
      "0.5]}}\n";
  const ForeignMotion frames = read_foreign_motions("file", exported(motion, "webots").bytes).front();
  const auto& list = frames.sections.front().frames;
  ASSERT_EQ(list.size(), 5u) << "the last one is the end of the pause";
  const auto knee = [&](std::size_t frame) { return *list[frame].values[0] * 180.0 / std::numbers::pi; };
  const auto elbow = [&](std::size_t frame) { return *list[frame].values[1] * 180.0 / std::numbers::pi; };
  EXPECT_EQ(list[1].move_us, 250'000);
  EXPECT_NEAR(knee(1), 0.0, 0.03);
  EXPECT_NEAR(std::abs(elbow(1)), 5.0, 0.03);
  EXPECT_EQ(list[2].move_us, 250'000);
  EXPECT_NEAR(std::abs(knee(2)), 40.0, 0.03);
  EXPECT_EQ(list[3].move_us, 500'000);
  EXPECT_NEAR(std::abs(knee(3)), 40.0, 0.03);
  EXPECT_NEAR(std::abs(elbow(3)), 20.0, 0.03);
}

// 0.4 s of a path of the zero moment point are ten key frames.
TEST_F(ExportTest, WritesThePathOfTheZeroMomentPoint) {
  const std::string motion =
      "version: 2\nrobot: koboshi\nname: a\nposes:\n"
      "  low: {others: zero, hip_pitch: -15.9, knee: 43.7, ankle_pitch: -27.8}\n"
      "  left: {from: low, com: {y_mm: 20}}\nsteps:\n  - {pose: low, time_s: 1}\n"
      "  - {pose: left, time_s: 0.4, path: zmp}\n";
  EXPECT_EQ(exported(motion, "csv").frames, 11u);
  EXPECT_NEAR(exported(motion, "csv").duration_s, 1.4, 1e-9);
}

TEST_F(ExportTest, SaysThatGainsAreLeftOut) {
  const std::string head = "version: 2\nrobot: koboshi\nname: a\nposes:\n  p: {left_knee: 10}\nsteps:\n";
  const std::string move = "  - {pose: p, time_s: 1, gain: {left_knee: 40}}\n";
  const auto says = testing::Contains(HasSubstr("gains of the position loops are left out"));
  EXPECT_THAT(exported(head + move, "csv").report, says);
  EXPECT_THAT(exported(head + "  - {gain: {legs: 40}}\n  - {pose: p, time_s: 1}\n", "csv").report, says);
  EXPECT_THAT(exported(head + "  - {pose: p, time_s: 1}\n", "csv").report, testing::Not(says));
}

// A move with a least time has in a table the time that the knee needs: 60 degrees at 428.6 degrees/s.
TEST_F(ExportTest, WritesTheTimeThatAMoveWithALeastTimeTakes) {
  const auto duration_s = [this](const std::string& least) {
    return exported(
               "version: 2\nrobot: koboshi\nname: a\nposes:\n  p: {left_knee: 0}\n  q: {left_knee: "
               "60}\nsteps:\n"
               "  - {pose: p, time_s: 1}\n  - {pose: q, at_least_s: " +
                   least + "}\n",
               "csv")
        .duration_s;
  };
  EXPECT_NEAR(duration_s("0.05"), 1.0 + 60.0 / 428.57, 1e-3);
  EXPECT_NEAR(duration_s("0.5"), 1.5, 1e-6);
}

TEST_F(ExportTest, DividesLongMotionsIntoPagesAndSlowsThem) {
  std::string motion =
      "version: 2\nrobot: koboshi\nname: long\nposes:\n  p: {left_knee: 10}\n  q: {left_knee: 20}\nsteps:\n";
  for (int i = 0; i < 9; ++i)
    motion += i % 2 == 0 ? "  - {pose: p, time_s: 4.003}\n" : "  - {pose: q, time_s: 0.8}\n";
  for (const std::string format : {"mtn", "bin"}) {
    const std::string bytes = exported(motion, format).bytes;
    const std::vector<ForeignMotion> pages = read_foreign_motions("file", bytes);
    ASSERT_EQ(pages.size(), 2u) << format;
    std::size_t frames = 0;
    std::int64_t time_us = 0;
    for (const ForeignSection& section : pages.front().sections) {
      for (const ForeignFrame& frame : section.frames) {
        ++frames;
        time_us += frame.move_us;
      }
    }
    EXPECT_EQ(frames, 9u) << format;
    EXPECT_NEAR(static_cast<double>(time_us), 23.215e6, format == "bin" ? 9 * 9e3 : 0.0) << format;
  }
  EXPECT_EQ(exported(motion, "bin").bytes.size(), 256u * 512u);
  EXPECT_THAT(exported(motion, "bin").report, testing::Contains(HasSubstr("times are rounded by up to")));
}

TEST_F(ExportTest, RefusesWhatKeyFramesCannotSay) {
  const std::string begin =
      "version: 2\nrobot: koboshi\nname: a\nposes: {p: {left_elbow: 10}}\nsteps:\n  - {pose: p, time_s: 1}\n";
  EXPECT_THROW(
      static_cast<void>(exported(begin + "  - {if: \"pitch_mdeg > 5\", then: [{wait_s: 1}]}\n", "csv")),
      InputError);
  EXPECT_THROW(static_cast<void>(exported(begin, "mtn")), InputError);  // the elbow has no number
  EXPECT_NO_THROW(static_cast<void>(
      exported(begin + "  - {expect: {pitch_deg: 0, roll_deg: 0, within_deg: 20}}\n", "csv")));
}

}  // namespace
}  // namespace koboshi::tools
