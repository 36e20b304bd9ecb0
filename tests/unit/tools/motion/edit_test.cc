#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <vector>

#include "firmware/motion/motion.h"
#include "sim_board/input/text.h"
#include "simulation/motion/compile.h"
#include "simulation/motion/joints.h"
#include "tests/unit/simulation/motion/motion_fixture.h"
#include "tools/motion/edit/format.h"
#include "tools/motion/edit/mirror.h"

namespace koboshi::tools {
namespace {

using simulation::JointNames;
using simulation::koboshi_model;

std::vector<std::filesystem::path> shipped_motions() {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(KOBOSHI_SOURCE_DIR "/robots/koboshi/motions"))
    files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

std::string text_of(const std::filesystem::path& file) { return sim::read_text_file(file, "a motion"); }

std::string mirrored(const std::string& text) {
  return mirror_motion("a.yaml", text, JointNames(koboshi_model()), {});
}

constexpr const char* kMessy = R"(# About the motion.

# And more.
version:   2
robot: koboshi   # the default
name: 'messy # no comment'
poses: {a: {knee: 5,
    # inside
    left_elbow: -15.90}, b: {from: a}}   # poses
routines:
  nod:
  - {pose: {head_tilt: 5}, time_s: 1}


steps:
# first
- pose: a
  time_s: 1.50   # seconds
- loop: {times: 2, steps: [{wait_s: 1}, {call: nod}]}
- if: "roll_mdeg > 5"
  then: [{wait_s: 1}]

  # or else
  else: [end]
- end
# last
)";

TEST(MotionFormat, LaysOutAFileAndKeepsItsCommentsAndNumbers) {
  EXPECT_EQ(format_motion("a.yaml", kMessy), R"(# About the motion.

# And more.
version: 2
robot: koboshi  # the default
name: 'messy # no comment'
poses:
  # inside
  a: {knee: 5, left_elbow: -15.90}  # poses
  b: {from: a}
routines:
  nod:
    - {pose: {head_tilt: 5}, time_s: 1}

steps:
  # first
  - {pose: a, time_s: 1.50}  # seconds
  - loop:
      times: 2
      steps:
        - {wait_s: 1}
        - {call: nod}
  - if: "roll_mdeg > 5"
    then:
      - {wait_s: 1}

    # or else
    else:
      - end
  - end
# last
)");
}

TEST(MotionFormat, ChangesNothingTheSecondTime) {
  const std::string once = format_motion("a.yaml", kMessy);
  EXPECT_EQ(format_motion("a.yaml", once), once);
  for (const std::filesystem::path& file : shipped_motions()) {
    const std::string text = text_of(file);
    EXPECT_EQ(format_motion(file, text), text) << file << " is in the canonical layout";
  }
}

TEST(MotionFormat, UpgradesToVersion2WithTheSameImage) {
  const std::string old =
      "# kept\nversion: 1  # old\nrobot: koboshi\nname: a\nposes:\n  p: {knee: 5}\n"
      "steps:\n  - {label: again}\n  - {pose: p, time_s: 1}\n  - {jump: again}\n";
  const std::string upgraded = upgrade_motion("a.yaml", old);
  EXPECT_THAT(upgraded, testing::StartsWith("# kept\nversion: 2  # old\n"));
  EXPECT_EQ(simulation::compile_text(upgraded).motion.image, simulation::compile_text(old).motion.image);
  EXPECT_EQ(upgrade_motion("a.yaml", upgraded), upgraded);
  for (const std::filesystem::path& file : shipped_motions()) {
    const std::string text = text_of(file);
    EXPECT_EQ(simulation::compile_text(upgrade_motion(file, text)).motion.image,
              simulation::compile_text(text).motion.image)
        << file;
  }
}

TEST(MotionMirror, ExchangesLeftAndRight) {
  EXPECT_EQ(
      mirrored(
          "name: turn_left\nposes:\n"
          "  a: {left_knee: 5, hip_roll: 3, head_pan: -4, right_hip_roll: 2.50, support: left, trunk: {y_mm: "
          "5, x_mm: 1}}\n"
          "  b: {from: a, left_hand: {y_mm: 90, z_mm: 0}}\n"
          "steps:\n"
          "  - {expect: {roll_deg: 9, pitch_deg: 5, within_deg: 4}}\n"
          "  - {pose: {left_elbow: -3}, time_s: 1, lean: {roll_deg: -3}, stiffness: {left_arm: 4}}\n"
          "  - {mix: {left_ankle_roll: {roll_rate: 1, pitch: 2, limit_deg: 5}}}\n"
          "  - {jump: x, if: \"left_contact and roll_mdeg - -zmp_y_um < angle_mdeg( left_hip_roll )\"}\n"),
      "name: turn_right\nposes:\n"
      "  a: {right_knee: 5, hip_roll: 3, head_pan: 4, left_hip_roll: -2.50, support: right, trunk: {y_mm: "
      "-5, x_mm: 1}}\n"
      "  b: {from: a, right_hand: {y_mm: -90, z_mm: 0}}\n"
      "steps:\n"
      "  - {expect: {roll_deg: -9, pitch_deg: 5, within_deg: 4}}\n"
      "  - {pose: {right_elbow: -3}, time_s: 1, lean: {roll_deg: 3}, stiffness: {right_arm: 4}}\n"
      "  - {mix: {right_ankle_roll: {roll_rate: 1, pitch: -2, limit_deg: 5}}}\n"
      "  - {jump: x, if: \"right_contact and -roll_mdeg - zmp_y_um < -angle_mdeg( right_hip_roll )\"}\n");
}

TEST(MotionMirror, TwiceIsTheIdentity) {
  for (const std::filesystem::path& file : shipped_motions()) {
    const std::string text = text_of(file);
    EXPECT_EQ(mirrored(mirrored(text)), text) << file;
  }
}

TEST(MotionMirror, MirrorsTheAnglesOfTheImage) {
  const JointNames joints(koboshi_model());
  for (const std::filesystem::path& file : shipped_motions()) {
    const std::vector<std::byte> image = simulation::compile_text(text_of(file)).motion.image;
    const simulation::Compiled other = simulation::compile_text(mirrored(text_of(file)));
    ASSERT_EQ(other.messages(), "") << file;
    motion::Motion first;
    motion::Motion second;
    ASSERT_TRUE(motion::Motion::open(image, koboshi_model().model, first).ok());
    ASSERT_TRUE(motion::Motion::open(other.motion.image, koboshi_model().model, second).ok());
    ASSERT_EQ(first.step_count(), second.step_count());
    for (std::size_t pose = 0; pose < other.source.poses.size(); ++pose) {
      auto angles = simulation::compile_text(text_of(file)).source.poses[pose].angles;
      for (std::size_t joint = 0; joint < angles.size(); ++joint) {
        const auto& image_angle = other.source.poses[pose].angles[joints.mirror(joint)];
        ASSERT_EQ(angles[joint].has_value(), image_angle.has_value()) << file << joint;
        if (!angles[joint]) continue;
        EXPECT_NEAR(angles[joint]->raw() * joints.mirror_sign(joint), image_angle->raw(), 1000.0) << file;
      }
    }
  }
}

}  // namespace
}  // namespace koboshi::tools
