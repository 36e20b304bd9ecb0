#include "simulation/motion_language/compile/compile.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <numbers>

#include "base/text/error.h"
#include "base/text/text.h"
#include "firmware/fixed/host/convert.h"
#include "sim_board/description/load.h"
#include "tests/support/temporary_folder.h"

namespace koboshi::simulation {
namespace {

using motion::Opcode;
using testing::EndsWith;
using testing::HasSubstr;

constexpr double kRadPerDegree = std::numbers::pi / 180.0;

// An image stores angles in units of 2^-14 turn.
constexpr double kPoseTolerance_deg = 0.5 * 360 / (1 << motion::kPoseBits);

class MotionCompileTest : public testing::Test {
 protected:
  static const NamedModel& koboshi() {
    static const NamedModel named =
        load_named_model(sim_board::load_robot(KOBOSHI_SOURCE_DIR "/robots/koboshi/robot.sdf"));
    return named;
  }

  // Lines 1 to 5 of the file: the required keys and two poses.
  static constexpr const char* kHead =
      "version: 1\nrobot: koboshi\nname: test\n"
      "poses: {bend: {knee: 60}, straight: {others: zero},\n  roll: {hip_roll: 10, head_pan: 20}}\n";

  std::filesystem::path write(const std::string& text) {
    koboshi::test::write_file(folder_.path / "motion.yaml", text);
    return folder_.path / "motion.yaml";
  }

  // Compiles and opens the motion. Its image lives as long as the test.
  motion::Motion compile(const std::string& steps) {
    image_ = compile_motion(write(kHead + steps), koboshi());
    motion::Motion motion;
    EXPECT_TRUE(motion::Motion::open(image_, koboshi().model, motion).ok());
    return motion;
  }

  // Returns the error message, from the line number on.
  std::string refusal(const std::string& text) {
    const std::filesystem::path file = write(text);
    try {
      static_cast<void>(compile_motion(file, koboshi()));
    } catch (const InputError& error) {
      const std::string message = error.what();
      EXPECT_TRUE(message.starts_with(file.string())) << message;
      return message.substr(file.string().size());
    }
    return "accepted";
  }
  std::string refusal_of_steps(const std::string& steps) { return refusal(kHead + steps); }
  std::string refusal_of_pose(const std::string& pose) {
    return refusal("version: 1\nrobot: koboshi\nname: test\nposes:\n  one: " + pose + "\nsteps: [end]\n");
  }

  double angle_deg(const motion::Motion& motion, std::size_t pose, const std::string& joint) {
    const auto found = std::find(koboshi().joint_names.begin(), koboshi().joint_names.end(), joint);
    const auto index = static_cast<std::size_t>(found - koboshi().joint_names.begin());
    EXPECT_TRUE(motion.joint_mask(pose) >> index & 1u) << joint;
    return fixed::to_double(motion.angle(pose, index)) / kRadPerDegree;
  }

  const koboshi::test::TemporaryFolder folder_;
  std::vector<std::byte> image_;
};

TEST_F(MotionCompileTest, MirrorsAnglesGivenForBothSides) {
  const motion::Motion motion = compile("steps: [end]\n");
  EXPECT_NEAR(angle_deg(motion, 0, "left_knee"), 60, kPoseTolerance_deg);
  EXPECT_NEAR(angle_deg(motion, 0, "right_knee"), 60, kPoseTolerance_deg);
  EXPECT_NEAR(angle_deg(motion, 2, "left_hip_roll"), 10, kPoseTolerance_deg);
  EXPECT_NEAR(angle_deg(motion, 2, "right_hip_roll"), -10, kPoseTolerance_deg);
  EXPECT_NEAR(angle_deg(motion, 2, "head_pan"), 20, kPoseTolerance_deg);
}

TEST_F(MotionCompileTest, OmitsJointsUnlessOthersAreZero) {
  const motion::Motion motion = compile("steps: [end]\n");
  EXPECT_EQ(std::popcount(motion.joint_mask(0)), 2);
  EXPECT_EQ(motion.joint_mask(1), (1u << 20) - 1);
  EXPECT_EQ(motion.name(), "test");
}

TEST_F(MotionCompileTest, WritesEveryKindOfStep) {
  const motion::Motion motion = compile(
      "steps:\n"
      "  - {label: again}\n"
      "  - {pose: bend, time_s: 0.0400001}\n"
      "  - loop: {times: 7, steps: [{wait_s: 0.02}, {loop: {until: stopped, steps: [{pose: straight, time_s: "
      "1}]}}]}\n"
      "  - {jump: again}\n");
  const std::vector<motion::Step> expected{
      {Opcode::kMove, 0, 40'000}, {Opcode::kLoopBegin, 7, 0},    {Opcode::kWait, 0, 20'000},
      {Opcode::kLoopBegin, 0, 0}, {Opcode::kMove, 1, 1'000'000}, {Opcode::kLoopEnd, 3, 0},
      {Opcode::kLoopEnd, 1, 0},   {Opcode::kJump, 0, 0},         {Opcode::kEnd, 0, 0}};
  ASSERT_EQ(motion.step_count(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_EQ(motion.step(i).opcode, expected[i].opcode) << i;
    EXPECT_EQ(motion.step(i).operand, expected[i].operand) << i;
    EXPECT_EQ(motion.step(i).value, expected[i].value) << i;
  }
}

TEST_F(MotionCompileTest, WritesAnAttitudeAsADirection) {
  const motion::Motion motion = compile(
      "steps:\n"
      "  - {expect: {pitch_deg: 90, within_deg: 60}}\n"
      "  - {expect: {roll_deg: -90, within_deg: 120}}\n");
  const auto prone = motion::ExpectedAttitude::of(motion.step(0));
  EXPECT_THAT(prone.up_B, testing::ElementsAre(-127, 0, 0));
  EXPECT_NEAR(prone.min_cosine, 16'384, 1);
  const auto on_left_side = motion::ExpectedAttitude::of(motion.step(1));
  EXPECT_THAT(on_left_side.up_B, testing::ElementsAre(0, -127, 0));
  EXPECT_NEAR(on_left_side.min_cosine, -16'384, 1);
}

TEST_F(MotionCompileTest, LetsALabelStandAtTheEnd) {
  const motion::Motion motion = compile("steps: [{jump: out}, {wait_s: 1}, end, {label: out}]\n");
  EXPECT_EQ(motion.step_count(), 4u);
  EXPECT_EQ(motion.step(0).operand, 3);
}

TEST_F(MotionCompileTest, CompilesTheExamplesOfTheReference) {
  const std::string page =
      read_text_file(KOBOSHI_SOURCE_DIR "/docs/reference/motion-language.md", "the reference");
  const std::string opening = "```yaml\n";
  int examples = 0;
  for (std::size_t at = page.find(opening); at != std::string::npos; at = page.find(opening, at)) {
    at += opening.size();
    EXPECT_EQ(refusal(page.substr(at, page.find("```", at) - at)), "accepted");
    ++examples;
  }
  EXPECT_EQ(examples, 3);
}

TEST_F(MotionCompileTest, CompilesTheMotionsOfTheRobot) {
  for (const auto& entry :
       std::filesystem::directory_iterator(KOBOSHI_SOURCE_DIR "/robots/koboshi/motions")) {
    EXPECT_NO_THROW(static_cast<void>(compile_motion(entry.path(), koboshi())));
  }
}

TEST_F(MotionCompileTest, IsReproducibleToTheByte) {
  compile("steps: [{pose: bend, time_s: 0.5}]\n");
  const std::vector<std::byte> first = image_;
  compile("steps: [{pose: bend, time_s: 0.5}]\n");
  EXPECT_EQ(image_, first);
}

TEST_F(MotionCompileTest, AcceptsALimitGivenInRadians) {
  EXPECT_EQ(refusal_of_pose("{knee: 150, hip_roll: 90, ankle_pitch: 75}"), "accepted");
}

TEST_F(MotionCompileTest, RefusesBadPosesWithTheirLine) {
  EXPECT_THAT(refusal_of_pose("{nose: 1}"),
              HasSubstr(":5: found the joint 'nose', expected a joint of koboshi"));
  EXPECT_THAT(refusal_of_pose("{knee: 151}"),
              HasSubstr(":5: found 151 degrees for left_knee, expected 0 to 150"));
  EXPECT_THAT(refusal_of_pose("{right_hip_roll: 41}"), HasSubstr("for right_hip_roll, expected -90 to 40"));
  EXPECT_THAT(refusal_of_pose("{knee: 1, left_knee: 2}"),
              HasSubstr(":5: found a second angle for left_knee"));
  EXPECT_THAT(refusal_of_pose("{knee: 1, knee: 2}"), HasSubstr(":5: found"));
  EXPECT_THAT(refusal_of_pose("{knee: bent}"), HasSubstr(":5: found"));
  EXPECT_THAT(refusal_of_pose("{others: high}"), HasSubstr("hold or zero"));
}

TEST_F(MotionCompileTest, RefusesBadStepsWithTheirLine) {
  EXPECT_THAT(refusal_of_steps("steps:\n  - {pose: bent, time_s: 1}\n"),
              HasSubstr(":7: found the pose 'bent'"));
  EXPECT_THAT(refusal_of_steps("steps:\n  - {pose: bend}\n"), HasSubstr(":7: found"));
  EXPECT_THAT(refusal_of_steps("steps:\n  - {pose: bend, time_s: 0}\n"),
              HasSubstr("a number from 0.001 to 60"));
  EXPECT_THAT(refusal_of_steps("steps:\n  - {pose: bend, time_s: 1, speed: 2}\n"), HasSubstr(":7: found"));
  EXPECT_THAT(refusal_of_steps("steps:\n  - halt\n"), HasSubstr("expected a step: a map, or the word end"));
  EXPECT_THAT(refusal_of_steps("steps:\n  - {}\n"), HasSubstr("found a step of another kind"));
  EXPECT_THAT(refusal_of_steps("steps:\n  - {loop: {times: 0, steps: [end]}}\n"), HasSubstr(":7: found"));
  EXPECT_THAT(refusal_of_steps("steps:\n  - {expect: {pitch_deg: 91, within_deg: 10}}\n"),
              HasSubstr("a number from -90 to 90"));
  EXPECT_THAT(refusal_of_steps("steps:\n  - {expect: {pitch_deg: 9}}\n"), HasSubstr(":7: found"));
  EXPECT_THAT(refusal_of_steps("steps:\n  - {jump: there}\n"), HasSubstr(":7: found a jump to 'there'"));
  EXPECT_THAT(refusal_of_steps("steps:\n  - {label: a}\n  - {label: a}\n"),
              HasSubstr(":8: found a second label 'a'"));
}

TEST_F(MotionCompileTest, RejectsWhatTheFirmwareWouldWithItsLine) {
  EXPECT_THAT(refusal_of_steps("steps:\n  - {wait_s: 1}\n  - {loop: {times: 2, steps: []}}\n"),
              HasSubstr(":8: found a loop or a chain of jumps in which no time passes"));
  EXPECT_THAT(refusal_of_steps("steps:\n  - {label: a}\n  - {jump: a}\n"),
              HasSubstr(":8: found a loop or a chain"));
  EXPECT_THAT(
      refusal_of_steps("steps:\n  - {wait_s: 1}\n  - {loop: {times: 2, steps: [{wait_s: 1}, {jump: a}]}}\n"
                       "  - {label: a}\n"),
      HasSubstr(":8: found a jump out of its loop"));
}

TEST_F(MotionCompileTest, RefusesMovesThatAreTooFast) {
  // 60 degrees at 428 degrees/s would take 0.14 s.
  EXPECT_EQ(refusal_of_steps("steps: [{pose: bend, time_s: 0.001}]\n"), "accepted")
      << "from an unknown angle";
  EXPECT_EQ(refusal_of_steps("steps: [{pose: straight, time_s: 1}, {pose: bend, time_s: 0.141}]\n"),
            "accepted");
  EXPECT_THAT(refusal_of_steps("steps:\n  - {pose: straight, time_s: 1}\n  - {pose: bend, time_s: 0.139}\n"),
              EndsWith(":8: found a move of left_knee at 432 degrees/s, expected at most 429"));
  EXPECT_THAT(refusal_of_steps(
                  "steps:\n  - loop:\n      times: 2\n      steps:\n        - {pose: straight, time_s: 0.1}\n"
                  "        - {pose: bend, time_s: 0.2}\n"),
              HasSubstr(":10: found a move of left_knee at 600 degrees/s"));
}

TEST_F(MotionCompileTest, RefusesFilesForOtherRobotsAndVersions) {
  EXPECT_THAT(refusal("version: 3\nrobot: koboshi\nname: a\nsteps: [end]\n"), HasSubstr(":1: found"));
  EXPECT_THAT(refusal("version: 1\nrobot: nao\nname: a\nsteps: [end]\n"),
              HasSubstr(":2: found the robot 'nao'"));
  EXPECT_THAT(refusal("version: 1\nrobot: koboshi\nname: 'a name of more than 24 letters'\nsteps: [end]\n"),
              HasSubstr(":3: found the name"));
  EXPECT_THAT(refusal("version: 1\nrobot: koboshi\nname: a\nsteps: [end]\nmore: 1\n"),
              HasSubstr(":5: found"));
  EXPECT_THAT(refusal("version: 1\nrobot: koboshi\nname: a\n"), HasSubstr("steps"));
}

}  // namespace
}  // namespace koboshi::simulation
