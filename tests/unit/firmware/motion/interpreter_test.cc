#include "firmware/motion/interpreter.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "tests/unit/firmware/motion/interpreter_fixture.h"

namespace koboshi::motion {
namespace {

using enum Opcode;
using fixed::Angle;
using test::degrees;
using test::MotionBuilder;
using test::stored;
using test::stored_deg;

TEST_F(InterpreterTest, IsAtTheFirstStepBeforeTheFirstMotion) {
  const Interpreter interpreter(model_);
  EXPECT_FALSE(interpreter.running());
  EXPECT_EQ(interpreter.step_index(), 0);
}

TEST_F(InterpreterTest, InterpolatesLinearlyBetweenPoses) {
  start(knee_poses().step(kMove, 1, 600'000).step(kMove, 2, 400'000).step(kEnd));
  for (int tick = 1; tick <= 60; ++tick) {
    interpreter_.advance(kTick_us, inputs_);
    EXPECT_NEAR(knee_deg(), kBent_deg * tick / 60, 1e-6);
  }
  for (int tick = 1; tick <= 40; ++tick) {
    interpreter_.advance(kTick_us, inputs_);
    EXPECT_NEAR(knee_deg(), kBent_deg + (kFlexed_deg - kBent_deg) * tick / 40, 1e-6);
  }
  EXPECT_FALSE(interpreter_.running());
  EXPECT_EQ(interpreter_.targets()[kKnee], stored(20));
}

// Each window is a step's work: one more than fits leaves the move to the next call.
TEST_F(InterpreterTest, LeavesAMoveWhoseWindowsAreTooMuchWorkToTheNextCall) {
  constexpr int kWindows = 3;
  constexpr int kFits = Interpreter::kMaxWork - Interpreter::kMoveWork - kWindows;
  const auto angle_after_a_call = [this](int steps_without_time) {
    MotionBuilder builder = knee_poses();
    builder.step(kWait, 0, kTick_us / 2);
    for (int i = 1; i <= steps_without_time; ++i) builder.step(kJump, static_cast<std::uint16_t>(i + 1));
    builder.step(Move{.pose = 1, .value = 4 * kTick_us, .windows = kWindows}.step());
    for (int i = 0; i < kWindows; ++i) builder.step(Window{.joints = 1u << (kPan + 1)}.step());
    start(builder.step(kEnd));
    interpreter_.advance(kTick_us, inputs_);
    return knee_deg();
  };
  EXPECT_NEAR(angle_after_a_call(kFits), kBent_deg / 8, 1e-6);
  EXPECT_NEAR(angle_after_a_call(kFits + 1), 0.0, 1e-6);
}

TEST_F(InterpreterTest, FailsIfTheTrunkIsNotAsExpected) {
  const Step upright = ExpectedAttitude{.up_B = {0, 0, 127}, .min_cosine = 28'378}.step();  // 30 degrees
  const auto builder = knee_poses()
                           .step(kMove, 1, 300'000)
                           .step(kExpect, upright.operand, upright.value)
                           .step(kMove, 2, 300'000)
                           .step(kEnd);
  start(builder);
  advance(600'000);
  EXPECT_FALSE(interpreter_.running());
  EXPECT_FALSE(interpreter_.failed());
  EXPECT_EQ(interpreter_.targets()[kKnee], stored(20));
  start(builder);
  advance(150'000);
  state_.up_B = robot::kAxisX;  // supine, but the step checks the attitude only at its own time
  EXPECT_TRUE(interpreter_.running());
  advance(150'000);
  EXPECT_FALSE(interpreter_.running());
  EXPECT_TRUE(interpreter_.failed());
  EXPECT_NEAR(knee_deg(), kBent_deg, 1e-6);
  start(knee_poses().step(kMove, 1, 300'000).step(kEnd));
  EXPECT_FALSE(interpreter_.failed());
}

TEST_F(InterpreterTest, StartsFromThePresentPoseAndKeepsOtherJoints) {
  pose_[kKnee] = degrees(30);
  pose_[kPan] = degrees(-45);
  start(knee_poses().step(kMove, 1, 300'000).step(kEnd));
  EXPECT_EQ(interpreter_.targets()[kKnee], degrees(30));
  advance(150'000);
  EXPECT_NEAR(knee_deg(), (30 + kBent_deg) / 2, 1e-6);
  advance(500'000);
  EXPECT_EQ(interpreter_.targets()[kPan], degrees(-45));
}

TEST_F(InterpreterTest, ClampsItsStartToTheLimits) {
  pose_[kKnee] = degrees(-3);
  start(knee_poses().step(kMove, 1, 300'000).step(kEnd));
  EXPECT_EQ(interpreter_.targets()[kKnee], degrees(0));
}

TEST_F(InterpreterTest, MovesThroughZeroInsteadOfThroughTheStop) {
  constexpr std::size_t kShoulder = 12;
  pose_[kShoulder] = degrees(-170);
  MotionBuilder builder(model_);
  start(builder.pose(kShoulder, 170).step(kMove, 0, 1'000'000).step(kEnd));
  advance(500'000);
  EXPECT_NEAR(fixed::to_double(interpreter_.targets()[kShoulder]),
              (stored_deg(170) - 170) / 2 * test::kRadPerDegree, 1e-6);
}

TEST_F(InterpreterTest, LastsTheSumOfItsStepsForAnyTicks) {
  for (const std::uint32_t tick_us : {1'000u, 7'001u, 10'000u, 65'432u}) {
    MotionBuilder builder = knee_poses();
    for (int i = 0; i < 100; ++i) builder.step(kMove, static_cast<std::uint16_t>(i % 3), 33'333);
    start(builder.step(kEnd));
    EXPECT_EQ(time_to_end_us(tick_us), (100 * 33'333 + tick_us - 1) / tick_us * tick_us);
  }
}

TEST_F(InterpreterTest, PlaysSeveralStepsInOneTick) {
  start(knee_poses()
            .step(kMove, 1, 2'000)
            .step(kMove, 2, 2'000)
            .step(kWait, 0, 2'000)
            .step(kMove, 0, 8'000)
            .step(kEnd));
  interpreter_.advance(kTick_us, inputs_);
  EXPECT_NEAR(knee_deg(), kFlexed_deg / 2, 1e-6);
}

TEST_F(InterpreterTest, LeavesWorkBeyondACallToTheNextOne) {
  start(knee_poses()
            .step(kMove, 1, 1'000)
            .step(kMove, 2, 1'000)
            .step(kMove, 1, 1'000)
            .step(kMove, 0, 20'000)
            .step(kEnd));
  // Two moves begin in this call. The last one follows in the next call, with the 7 ms that are left.
  interpreter_.advance(kTick_us, inputs_);
  EXPECT_NEAR(knee_deg(), kBent_deg, 1e-6);
  interpreter_.advance(kTick_us, inputs_);
  EXPECT_NEAR(knee_deg(), kBent_deg * 3 / 20, 1e-6);
}

TEST_F(InterpreterTest, RepeatsCubicMovesBySpeedWithoutDelay) {
  MotionBuilder builder = knee_poses();
  constexpr int kMoves = 40;
  const Move there{
      .interpolation = Interpolation::kCubic, .by_speed = true, .pose = 1, .value = (1 << 24) / 2};
  Move back = there;
  back.pose = 2;
  builder.step(kMove, 2, 20'000);
  for (int i = 0; i < kMoves; ++i) builder.step((i % 2 == 0 ? there : back).step());
  start(builder.step(kEnd));
  const std::uint32_t move_us = Trajectory::duration_us(
      Interpolation::kCubic,
      static_cast<std::uint32_t>(std::lround((kBent_deg - kFlexed_deg) / 360 * 4294967296.0)), there.value);
  EXPECT_NEAR(time_to_end_us(), 20'000 + kMoves * move_us, 2'000);
}

TEST_F(InterpreterTest, DoesNotJumpAfterAGap) {
  start(knee_poses().step(kMove, 1, 600'000).step(kEnd));
  interpreter_.advance(5'000'000, inputs_);
  EXPECT_NEAR(knee_deg(), kBent_deg / 6, 1e-6);
}

TEST_F(InterpreterTest, CountsLoops) {
  // 3 * (2 * 10 + 5) ms
  start(knee_poses()
            .step(kLoopBegin, 3)
            .step(kLoopBegin, 2)
            .step(kMove, 1, 10'000)
            .step(kLoopEnd, 1)
            .step(kWait, 0, 5'000)
            .step(kLoopEnd, 0)
            .step(kEnd));
  EXPECT_EQ(time_to_end_us(), 75'000u);
}

TEST_F(InterpreterTest, LoopsUntilStoppedAndThenEndsTheRound) {
  start(knee_poses()
            .step(kLoopBegin, 0)
            .step(kMove, 1, 100'000)
            .step(kMove, 0, 100'000)
            .step(kLoopEnd, 0)
            .step(kMove, 2, 50'000)
            .step(kEnd));
  advance(20'000'000);
  EXPECT_TRUE(interpreter_.running());
  advance(30'000);
  interpreter_.stop();
  EXPECT_EQ(time_to_end_us(), 170'000u + 50'000u);
  EXPECT_EQ(interpreter_.targets()[kKnee], stored(20));
}

TEST_F(InterpreterTest, JumpsUntilStopped) {
  start(knee_poses()
            .step(kMove, 1, 10'000)
            .step(kJump, 3)
            .step(kMove, 2, 10'000)
            .step(kWait, 0, 10'000)
            .step(kJump, 0)
            .step(kEnd));
  advance(5'000'000);
  EXPECT_TRUE(interpreter_.running());
  EXPECT_NEAR(knee_deg(), kBent_deg, 1e-6) << "the step to 20 degrees is jumped over";
  interpreter_.stop();
  EXPECT_LE(time_to_end_us(), 20'000u);
}

// The work of one call is that of 14 steps without time; the start is a call.
TEST_F(InterpreterTest, DoesExactlyTheWorkOfOneCall) {
  for (const int sets : {13, 14, 15, 28}) {
    MotionBuilder counts = knee_poses();
    counts.variable_count = 1;
    for (int i = 0; i < sets; ++i) counts.step(Assignment{.operation = Arithmetic::kAdd, .right = 1}.step());
    start(counts.step(kWait, 0, 100'000).step(kEnd));
    EXPECT_EQ(interpreter_.variables()[0], std::min(sets, 14));
    advance(kTick_us);
    EXPECT_EQ(interpreter_.variables()[0], sets);
  }
}

TEST_F(InterpreterTest, LeavesAnAwaitAtOnceForItsExit) {
  MotionBuilder awaits = knee_poses();
  awaits.step(Condition{}.await(kNoStep, kMaxStepTime_us));
  awaits.step(motion::Test{{Source::kInput, 0}, Comparison::kGreater, false, 5}.step());
  awaits.step(kWait, 0, 10'000).step(kJump, 0).step(kMove, 1, 10'000).step(kEnd);
  awaits.exit_step = 4;
  start(awaits);
  advance(50'000);
  EXPECT_EQ(interpreter_.step_index(), 0);
  interpreter_.stop();
  EXPECT_LE(time_to_end_us(10'000), 30'000u);
  EXPECT_FALSE(interpreter_.failed());
  EXPECT_NEAR(knee_deg(), kBent_deg, 1e-3);
}

TEST_F(InterpreterTest, StaysWhereItIsWhenAborted) {
  start(knee_poses().step(kMove, 1, 600'000).step(kEnd));
  advance(300'000);
  interpreter_.abort();
  advance(1'000'000);
  EXPECT_FALSE(interpreter_.running());
  EXPECT_NEAR(knee_deg(), kBent_deg / 2, 1e-6);
}

TEST_F(InterpreterTest, HoldsTheZeroPoseBeforeAnyMotion) {
  interpreter_.advance(kTick_us, inputs_);
  EXPECT_FALSE(interpreter_.running());
  for (const Angle target : interpreter_.targets()) EXPECT_EQ(target, Angle());
}

TEST_F(InterpreterTest, EndsAnEmptyMotionAtOnce) {
  interpreter_.start(Motion(), pose_, inputs_);
  EXPECT_FALSE(interpreter_.running());
}

}  // namespace
}  // namespace koboshi::motion
