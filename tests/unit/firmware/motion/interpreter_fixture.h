#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "firmware/motion/interpreter.h"
#include "tests/unit/firmware/motion/motion_builder.h"

namespace koboshi::motion {

inline constexpr std::size_t kKnee = 3;
inline constexpr std::size_t kPan = 18;
inline constexpr std::uint32_t kTick_us = 10'000;

inline const double kBent_deg = test::stored_deg(60);
inline const double kFlexed_deg = test::stored_deg(20);

class InterpreterTest : public testing::Test {
 protected:
  // Poses 0, 1, 2: left knee at 0, 60, 20 degrees.
  test::MotionBuilder knee_poses() const {
    test::MotionBuilder builder(model_);
    builder.pose(kKnee, 0).pose(kKnee, 60).pose(kKnee, 20);
    return builder;
  }
  // Pose 0: left knee and head at these angles.
  test::MotionBuilder knee_and_pan(double knee_deg, double pan_deg) const {
    test::MotionBuilder builder(model_);
    builder.packed_pose(1u << kKnee | 1u << kPan,
                        {pose_number(test::degrees(knee_deg)), pose_number(test::degrees(pan_deg))});
    return builder;
  }
  void start(const test::MotionBuilder& builder) {
    image_ = builder.image();
    Motion motion;
    const MotionVerdict verdict = Motion::open(image_, model_, motion);
    ASSERT_TRUE(verdict.ok()) << int{static_cast<std::uint8_t>(verdict.status)} << " at " << verdict.index;
    interpreter_.start(motion, pose_, inputs_);
  }
  double knee_deg() const { return fixed::to_double(interpreter_.targets()[kKnee]) / test::kRadPerDegree; }
  double pan_deg() const { return fixed::to_double(interpreter_.targets()[kPan]) / test::kRadPerDegree; }
  // The knee's target with corrections.
  double corrected_knee_deg() {
    std::array<fixed::Angle, 20> targets{};
    std::ranges::copy(interpreter_.targets(), targets.begin());
    interpreter_.add_corrections(targets, state_);
    return fixed::to_double(targets[kKnee]) / test::kRadPerDegree;
  }
  void advance(std::uint32_t total_us, std::uint32_t tick_us = kTick_us) {
    for (std::uint32_t time_us = 0; time_us < total_us; time_us += tick_us)
      interpreter_.advance(tick_us, inputs_);
  }
  // Returns the remaining time of the motion, at most 60 s.
  std::uint32_t time_to_end_us(std::uint32_t tick_us = 1'000) {
    std::uint32_t time_us = 0;
    for (; interpreter_.running() && time_us < 60'000'000; time_us += tick_us)
      interpreter_.advance(tick_us, inputs_);
    return time_us;
  }

  const robot::RobotModel model_ = test::load_test_robot();
  estimation::RobotState state_;
  std::array<fixed::Angle, 20> measured_{};
  std::array<std::int16_t, 20> torques_{};
  std::array<std::int16_t, kInputCount> values_{};
  Inputs inputs_{.robot = state_, .angles = measured_, .torques_permille = torques_, .values = values_};
  Interpreter interpreter_{model_};
  std::vector<std::byte> image_;
  std::array<fixed::Angle, 20> pose_{};
};

}  // namespace koboshi::motion
