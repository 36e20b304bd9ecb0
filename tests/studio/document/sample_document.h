#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "base/text/error.h"
#include "studio/document/motion_document.h"

namespace koboshi::studio {

// The default robot, read once per program.
inline std::shared_ptr<const MotionRobot> sample_robot() {
  static const auto robot = load_motion_robot(KOBOSHI_SOURCE_DIR "/robots/koboshi/robot.sdf");
  return robot;
}

inline std::size_t joint_of(const std::string& name) {
  const auto& names = sample_robot()->model.joint_names;
  return static_cast<std::size_t>(std::ranges::find(names, name) - names.begin());
}

inline constexpr double kDegree = 0.017453292519943295;

// A motion with comments, in which rows 0 to 9 are the program and 10, 11 a routine.
inline const std::string kSample = R"(# A sample.
version: 2
robot: koboshi   # the default
name: sample
poses:
  # feet together
  stand: {others: zero, hip_pitch: -15.90, knee: 43.72, ankle_pitch: -27.82}
  wave: {from: stand, right_elbow: -45}   # derived
  low: {from: stand, com: {x_mm: 12, z_mm: 140}}
routines:
  nod:
    - {pose: {head_tilt: 20}, time_s: 0.5}
    - {pose: {head_tilt: 0}, time_s: 0.25}
steps:
  # get ready
  - {pose: stand, time_s: 1.5}   # slowly
  - {wait_s: 0.5}
  - loop:
      times: 3
      steps:
        # out
        - {pose: wave, speed_deg_per_s: 90, interpolation: minimum_jerk}
        - {pose: stand, time_s: 0.3, pause_s: 0.1}
  - if: roll_mdeg > 4000
    then:
      - {pose: low, time_s: 1}
    else:
      - {call: nod}
  # the end
  - {jump: done}
  - {label: done}
)";

// The text with one place changed.
inline std::string with(const std::string& before, const std::string& after, std::string text = kSample) {
  const std::size_t at = text.find(before);
  EXPECT_NE(at, std::string::npos) << before;
  EXPECT_EQ(text.find(before, at + 1), std::string::npos) << before;
  return text.replace(std::min(at, text.size()), before.size(), after);
}

// A document with a text that no file has.
inline std::unique_ptr<MotionDocument> document_of(const std::string& text = kSample) {
  return MotionDocument::restore(sample_robot(), {.recovery_file = {}, .original = {}, .text = text});
}

// Checks an edit: the text after it, and that undo and redo lead back and forth.
inline void expect_edit(const MotionDocument& document, const std::string& expected,
                        const std::string& before = kSample) {
  EXPECT_EQ(document.text(), expected);
  EXPECT_EQ(document.history().undo_count(), 1U);
  auto& edited = const_cast<MotionDocument&>(document);
  const std::string text = document.text();
  EXPECT_TRUE(edited.undo());
  EXPECT_EQ(document.text(), before);
  EXPECT_TRUE(edited.redo());
  EXPECT_EQ(document.text(), text);
}

}  // namespace koboshi::studio
