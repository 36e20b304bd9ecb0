// Each opcode of docs/reference/motion-language.md, played.

#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/firmware/motion/interpreter_fixture.h"

namespace koboshi::motion {
namespace {

using enum Opcode;
using fixed::Angle;
using test::degrees;
using test::MotionBuilder;
using test::stored;

class OpcodeTest : public InterpreterTest {
 protected:
  std::int32_t variable(std::size_t index) const { return interpreter_.variables()[index]; }
  // Two variables besides the poses of the knee.
  MotionBuilder with_variables() const {
    MotionBuilder builder = knee_poses();
    builder.variable_count = 2;
    return builder;
  }
  static Step set(std::uint16_t variable, Arithmetic operation, std::int32_t right) {
    return Assignment{.variable = variable, .operation = operation, .right = right}.step();
  }
  static motion::Test input_exceeds(std::int32_t limit) {
    return {{Source::kInput, 0}, Comparison::kGreater, false, limit};
  }
  void lean_to(double pitch_deg) { state_.pitch = degrees(pitch_deg); }
};

TEST_F(OpcodeTest, EndEndsTheMotionWithoutAFailure) {
  start(knee_poses().step(kMove, 1, 10'000).step(kEnd).step(kMove, 2, 10'000).step(kEnd));
  EXPECT_EQ(time_to_end_us(), 10'000u);
  EXPECT_FALSE(interpreter_.failed());
  EXPECT_EQ(interpreter_.targets()[kKnee], stored(60));
  EXPECT_EQ(interpreter_.step_index(), 1);
}

TEST_F(OpcodeTest, MoveTakesItsTimeOrThatOfItsSpeed) {
  const std::uint32_t speed = 1u << 24;  // 360 degrees/s
  const Step by_speed = Move{.by_speed = true, .pose = 1, .value = speed}.step();
  start(knee_poses().step(kMove, 2, 30'000).step(by_speed).step(kEnd));
  const double way_deg = kBent_deg - kFlexed_deg;
  EXPECT_EQ(time_to_end_us(), 30'000 + static_cast<std::uint32_t>(std::ceil(way_deg / 0.36)) * 1'000);
}

// Two joints move at once: the knee by half its way in the same time as the ankle, and the slower one, for
// its way, decides. What the pose leaves alone, or where a joint is already, takes no time.
TEST_F(OpcodeTest, MoveOfALeastTimeTakesWhatTheSlowestJointNeeds) {
  const double limit_deg_per_s = fixed::to_double(model_.joints[kKnee].max_speed) / test::kRadPerDegree;
  for (const auto& [interpolation, ratio] : {std::pair{Interpolation::kLinear, 1.0},
                                             {Interpolation::kMinimumJerk, 15.0 / 8.0},
                                             {Interpolation::kTrapezoid, 1.5}}) {
    const Step least =
        Move{.interpolation = interpolation, .pose = 1, .value = 20'000, .at_least = true}.step();
    start(knee_poses().step(kMove, 2, 30'000).step(least).step(kEnd));
    const double way_deg = kBent_deg - kFlexed_deg;
    const double needed_us = 1e6 * ratio * way_deg / limit_deg_per_s;
    ASSERT_GT(needed_us, 20'000.0);
    EXPECT_NEAR(time_to_end_us(), 30'000 + needed_us, 1'000.0);
    start(knee_poses().step(kMove, 1, 30'000).step(least).step(kEnd));
    EXPECT_EQ(time_to_end_us(), 50'000u) << "at the pose already";
  }
}

// The work of a call: a cubic move by speed, which reads three poses, is alone in it. What follows is late by
// a tick, but takes its time from the next ones.
TEST_F(OpcodeTest, MoveBySpeedLeavesASecondOneToTheNextCall) {
  const auto hop = [](std::uint16_t pose) {
    return Move{.interpolation = Interpolation::kCubic, .by_speed = true, .pose = pose, .value = 1u << 24}
        .step();
  };
  MotionBuilder builder(model_);
  builder.pose(kKnee, 0.4).pose(kKnee, 0.8);  // 1.65 ms each
  start(builder.step(kWait, 0, 5'000).step(hop(0)).step(hop(1)).step(kWait, 0, 30'000).step(kEnd));
  advance(10'000);
  EXPECT_EQ(interpreter_.targets()[kKnee], stored(0.4));
  advance(10'000);
  EXPECT_EQ(interpreter_.targets()[kKnee], stored(0.8));
  EXPECT_EQ(time_to_end_us(), 19'000u);
}

TEST_F(OpcodeTest, WaitHoldsTheTargets) {
  start(knee_poses().step(kMove, 1, 10'000).step(kWait, 0, 500'000).step(kEnd));
  advance(300'000);
  EXPECT_TRUE(interpreter_.running());
  EXPECT_EQ(interpreter_.targets()[kKnee], stored(60));
  EXPECT_EQ(time_to_end_us(), 210'000u);
}

TEST_F(OpcodeTest, LoopBeginAndEndRepeatTheirBody) {
  start(with_variables()
            .step(kLoopBegin, 5)
            .step(set(0, Arithmetic::kAdd, 1))
            .step(kWait, 0, 2'000)
            .step(kLoopEnd, 0)
            .step(kEnd));
  EXPECT_EQ(time_to_end_us(), 10'000u);
  EXPECT_EQ(variable(0), 5);
}

TEST_F(OpcodeTest, JumpLeavesOutSteps) {
  start(knee_poses().step(kMove, 1, 10'000).step(kJump, 3).step(kMove, 2, 50'000).step(kEnd));
  EXPECT_EQ(time_to_end_us(), 10'000u);
  EXPECT_EQ(interpreter_.targets()[kKnee], stored(60));
}

TEST_F(OpcodeTest, ExpectFailsInAnotherAttitude) {
  const Step supine = ExpectedAttitude{.up_B = {127, 0, 0}, .min_cosine = 28'378}.step();
  const auto builder = knee_poses().step(kWait, 0, 10'000).step(supine).step(kEnd);
  state_.up_B = robot::kAxisX;
  start(builder);
  advance(20'000);
  EXPECT_FALSE(interpreter_.failed());
  state_.up_B = robot::kAxisZ;
  start(builder);
  advance(20'000);
  EXPECT_TRUE(interpreter_.failed());
}

TEST_F(OpcodeTest, TestComparesANumberOrAVariable) {
  struct Case {
    Comparison comparison;
    bool less, equal, greater;
  };
  for (const Case& expected :
       {Case{Comparison::kEqual, false, true, false}, Case{Comparison::kNotEqual, true, false, true},
        Case{Comparison::kLess, true, false, false}, Case{Comparison::kLessOrEqual, true, true, false},
        Case{Comparison::kGreater, false, false, true},
        Case{Comparison::kGreaterOrEqual, false, true, true}}) {
    for (const bool with_variable : {false, true}) {
      for (std::int16_t left = 6; left <= 8; ++left) {
        values_[0] = left;
        start(with_variables()
                  .step(set(1, Arithmetic::kAssign, 7))
                  .step(Condition{}.branch(4))
                  .step(motion::Test{
                      {Source::kInput, 0}, expected.comparison, with_variable, with_variable ? 1 : 7}
                            .step())
                  .step(kEnd)
                  .step(set(0, Arithmetic::kAssign, 1))
                  .step(kEnd));
        const bool holds = left < 7 ? expected.less : left > 7 ? expected.greater : expected.equal;
        EXPECT_EQ(variable(0), holds ? 1 : 0)
            << int{static_cast<std::uint8_t>(expected.comparison)} << " of " << left;
      }
    }
  }
}

TEST_F(OpcodeTest, BranchCombinesItsTests) {
  for (const bool any : {false, true}) {
    for (const bool negated : {false, true}) {
      for (int held = 0; held < 4; ++held) {
        values_[0] = (held & 1) != 0 ? 1 : 0;
        values_[1] = (held & 2) != 0 ? 1 : 0;
        start(with_variables()
                  .step(Condition{.count = 2, .any = any, .negated = negated}.branch(4))
                  .step(motion::Test{{Source::kInput, 0}, Comparison::kEqual, false, 1}.step())
                  .step(motion::Test{{Source::kInput, 1}, Comparison::kEqual, false, 1}.step())
                  .step(kEnd)
                  .step(set(0, Arithmetic::kAssign, 1))
                  .step(kEnd));
        const bool holds = any ? held != 0 : held == 3;
        EXPECT_EQ(variable(0), holds != negated ? 1 : 0) << any << negated << held;
      }
    }
  }
}

TEST_F(OpcodeTest, AwaitEndsWithItsConditionOrItsTime) {
  const auto builder = with_variables()
                           .step(Condition{}.await(4, 100'000))
                           .step(input_exceeds(5).step())
                           .step(set(0, Arithmetic::kAssign, 1))
                           .step(kEnd)
                           .step(set(0, Arithmetic::kAssign, 2))
                           .step(kEnd);
  start(builder);
  advance(50'000);
  EXPECT_TRUE(interpreter_.running());
  values_[0] = 6;
  advance(10'000);
  EXPECT_FALSE(interpreter_.running());
  EXPECT_EQ(variable(0), 1);
  values_[0] = 0;
  start(builder);
  EXPECT_EQ(time_to_end_us(), 100'000u);
  EXPECT_EQ(variable(0), 2);
  EXPECT_FALSE(interpreter_.failed());
  start(knee_poses().step(Condition{}.await(kNoStep, 100'000)).step(input_exceeds(5).step()).step(kEnd));
  EXPECT_EQ(time_to_end_us(), 100'000u);
  EXPECT_TRUE(interpreter_.failed());
}

TEST_F(OpcodeTest, SetComputesAndSaturates) {
  struct Case {
    Arithmetic operation;
    std::int32_t left, right, result;
  };
  constexpr std::int32_t kHighest = 0x7FFF'FFFF;
  constexpr std::int32_t kLowest = -kHighest - 1;
  for (const Case& expected :
       {Case{Arithmetic::kAssign, 3, -9, -9}, Case{Arithmetic::kAdd, 3, 4, 7},
        Case{Arithmetic::kAdd, kHighest, 1, kHighest}, Case{Arithmetic::kSubtract, 3, 4, -1},
        Case{Arithmetic::kSubtract, kLowest, 1, kLowest}, Case{Arithmetic::kMultiply, -3, 4, -12},
        Case{Arithmetic::kMultiply, 65'536, 65'536, kHighest}, Case{Arithmetic::kDivide, -7, 2, -3},
        Case{Arithmetic::kDivide, kLowest, -1, kHighest}, Case{Arithmetic::kRemainder, -7, 2, -1},
        Case{Arithmetic::kRemainder, kLowest, -1, 0}, Case{Arithmetic::kMinimum, 3, 4, 3},
        Case{Arithmetic::kMaximum, 3, 4, 4}}) {
    start(with_variables()
              .step(set(0, Arithmetic::kAssign, expected.left))
              .step(set(0, expected.operation, expected.right))
              .step(kEnd));
    EXPECT_EQ(variable(0), expected.result) << int{static_cast<std::uint8_t>(expected.operation)};
    EXPECT_FALSE(interpreter_.failed());
  }
  values_[3] = 77;
  const SourceRef input{Source::kInput, 3};
  start(with_variables()
            .step(Assignment{.variable = 1, .from_source = true, .right = input.packed()}.step())
            .step(kEnd));
  EXPECT_EQ(variable(1), 77);
  start(with_variables().step(set(0, Arithmetic::kDivide, 0)).step(kEnd));
  EXPECT_TRUE(interpreter_.failed());
}

TEST_F(OpcodeTest, CallRunsASubroutineAndReturnGoesOnBehindIt) {
  start(with_variables()
            .step(kCall, 4)
            .step(kCall, 4)
            .step(set(1, Arithmetic::kAssign, 9))
            .step(kEnd)
            .step(set(0, Arithmetic::kAdd, 1))
            .step(kWait, 0, 5'000)
            .step(kReturn));
  EXPECT_EQ(time_to_end_us(), 10'000u);
  EXPECT_EQ(variable(0), 2);
  EXPECT_EQ(variable(1), 9);
}

TEST_F(OpcodeTest, FailEndsTheMotionAsFailed) {
  start(knee_poses().step(kWait, 0, 10'000).step(kFail).step(kEnd));
  EXPECT_EQ(time_to_end_us(), 10'000u);
  EXPECT_TRUE(interpreter_.failed());
}

TEST_F(OpcodeTest, MixAddsItsGainTimesTheSourceUpToItsLimit) {
  const Mix half{.source = MixSource::kPitch, .joint = kKnee, .gain = 2'048, .limit = Mix::kMaxLimit};
  start(knee_poses().step(kMove, 2, 10'000).step(half.step()).step(kWait, 0, 1'000'000).step(kEnd));
  advance(20'000);
  lean_to(6);
  EXPECT_NEAR(corrected_knee_deg(), kFlexed_deg + 3, 0.001);
  EXPECT_NEAR(knee_deg(), kFlexed_deg, 1e-6) << "the trajectory itself is not corrected";
  lean_to(80);
  EXPECT_NEAR(corrected_knee_deg(), kFlexed_deg + 15, 0.01);
  lean_to(-80);
  EXPECT_NEAR(corrected_knee_deg(), kFlexed_deg - 15, 0.01);
}

// The correction that falls away is 6 degrees; it fades by 0.3 degrees in a tick, in 0.2 s.
class FadingMix : public OpcodeTest {
 protected:
  void play_to_removal(const Step& removal) {
    const Mix full{.source = MixSource::kPitch, .joint = kKnee, .gain = 4'096, .limit = Mix::kMaxLimit};
    lean_to(6);
    start(knee_poses()
              .step(kMove, 2, 10'000)
              .step(full.step())
              .step(kWait, 0, 100'000)
              .step(removal)
              .step(kWait, 0, 1'000'000)
              .step(kEnd));
    for (int tick = 0; tick < 10; ++tick) {
      interpreter_.advance(kTick_us, inputs_);
      static_cast<void>(corrected_knee_deg());
    }
    ASSERT_NEAR(corrected_knee_deg(), kFlexed_deg + 6, 0.001);
  }
  void expect_fades() {
    lean_to(-30);  // what was removed no longer follows the trunk
    for (int tick = 0; tick <= 20; ++tick) {
      interpreter_.advance(kTick_us, inputs_);
      EXPECT_NEAR(corrected_knee_deg(), kFlexed_deg + 6.0 * (20 - tick) / 20, 0.001) << tick;
    }
    EXPECT_FALSE(interpreter_.fading());
    interpreter_.advance(kTick_us, inputs_);
    EXPECT_NEAR(corrected_knee_deg(), kFlexed_deg, 1e-6);
  }
};

TEST_F(FadingMix, FollowsMixClear) {
  play_to_removal({kMixClear});
  expect_fades();
  EXPECT_TRUE(interpreter_.running());
}

TEST_F(FadingMix, FollowsAGainOfZero) {
  play_to_removal(Mix{.source = MixSource::kPitch, .joint = kKnee, .gain = 0}.step());
  expect_fades();
}

TEST_F(FadingMix, FollowsTheEndOfTheMotion) {
  play_to_removal({kEnd});
  expect_fades();
  EXPECT_FALSE(interpreter_.running());
}

TEST_F(FadingMix, FollowsAFailure) {
  play_to_removal({kFail});
  expect_fades();
  EXPECT_TRUE(interpreter_.failed());
}

TEST_F(FadingMix, EndsWithAnAbort) {
  play_to_removal({kEnd});
  interpreter_.advance(kTick_us, inputs_);
  EXPECT_TRUE(interpreter_.fading());
  interpreter_.abort();
  EXPECT_FALSE(interpreter_.fading());
  EXPECT_NEAR(corrected_knee_deg(), kFlexed_deg, 1e-6);
}

TEST_F(OpcodeTest, StiffnessLastsUntilTheEndOfTheMotion) {
  const Step soft = Stiffness{.percent = 40, .joints = 1u << kKnee | 1u << kPan}.step();
  const Step full = Stiffness{.percent = 100, .joints = 1u << kPan}.step();
  start(knee_poses().step(soft).step(kWait, 0, 10'000).step(full).step(kWait, 0, 10'000).step(kEnd));
  EXPECT_EQ(interpreter_.stiffness_percent(kKnee), 40);
  EXPECT_EQ(interpreter_.softened(), 1u << kKnee | 1u << kPan);
  advance(15'000, 5'000);
  EXPECT_EQ(interpreter_.stiffness_percent(kKnee), 40);
  EXPECT_EQ(interpreter_.stiffness_percent(kPan), 100);
  EXPECT_EQ(interpreter_.softened(), 1u << kKnee);
  advance(10'000);
  EXPECT_EQ(interpreter_.stiffness_percent(kKnee), 100);
  EXPECT_EQ(interpreter_.softened(), 0u);
}

// The knee turns in the middle half of its move, the head in all of it.
TEST_F(OpcodeTest, AWindowIsThePartOfAMoveInWhichAJointTurns) {
  for (const Interpolation interpolation :
       {Interpolation::kLinear, Interpolation::kMinimumJerk, Interpolation::kTrapezoid}) {
    test::MotionBuilder builder = knee_and_pan(40, 20);
    start(builder.step(Move{.interpolation = interpolation, .value = 400'000, .windows = 1}.step())
              .step(Window{.start = 1'024, .end = 3'072, .joints = 1u << kKnee}.step())
              .step(kWait, 0, 100'000)
              .step(kEnd));
    const double from_deg = knee_deg();
    const double pan_from_deg = pan_deg();
    // A move of the same shape over the part's time, and one over the whole.
    const auto share = [&](double s) {
      if (interpolation == Interpolation::kLinear) return s;
      if (interpolation == Interpolation::kMinimumJerk) return s * s * s * (10 + s * (6 * s - 15));
      return s < 1.0 / 3 ? 2.25 * s * s : s < 2.0 / 3 ? 1.5 * s - 0.25 : 1 - 2.25 * (1 - s) * (1 - s);
    };
    for (int tick = 1; tick <= 40; ++tick) {
      advance(10'000);
      const double s = std::clamp((tick / 40.0 - 0.25) / 0.5, 0.0, 1.0);
      EXPECT_NEAR(knee_deg(), std::lerp(from_deg, test::stored_deg(40), share(s)), 2e-3) << tick;
      EXPECT_NEAR(pan_deg(), std::lerp(pan_from_deg, test::stored_deg(20), share(tick / 40.0)), 2e-3) << tick;
    }
    EXPECT_TRUE(interpreter_.running()) << "the step after the window is played";
    advance(100'000);
    EXPECT_FALSE(interpreter_.running());
  }
}

// Each window has joints of its own, and the next move has none of them.
TEST_F(OpcodeTest, WindowsAreThoseOfOneMove) {
  test::MotionBuilder builder = knee_and_pan(40, 20);
  builder.packed_pose(1u << kKnee | 1u << kPan, {0, 0});
  start(builder.step(Move{.value = 100'000, .windows = 2}.step())
            .step(Window{.start = 0, .end = 2'048, .joints = 1u << kKnee | 1u << kPan}.step())
            .step(Window{.start = 2'048, .end = 4'096, .joints = 1u << kPan}.step())
            .step(Move{.pose = 1, .value = 100'000}.step())
            .step(kEnd));
  advance(50'000);
  EXPECT_NEAR(knee_deg(), test::stored_deg(40), 2e-3);
  EXPECT_NEAR(pan_deg(), test::stored_deg(20), 2e-3) << "the first window counts";
  advance(100'000);
  EXPECT_NEAR(knee_deg(), test::stored_deg(40) / 2, 2e-3);
  EXPECT_NEAR(pan_deg(), test::stored_deg(20) / 2, 2e-3);
}

TEST_F(OpcodeTest, GainLastsUntilTheEndOfTheMotion) {
  const Step changed = Gain{.percent = 40, .joints = 1u << kKnee | 1u << kPan}.step();
  const Step stiffer = Gain{.percent = 150, .joints = 1u << kKnee}.step();
  const Step own = Gain{.percent = 100, .joints = 1u << kPan}.step();
  start(knee_poses()
            .step(changed)
            .step(kWait, 0, 10'000)
            .step(stiffer)
            .step(own)
            .step(kWait, 0, 10'000)
            .step(kEnd));
  EXPECT_EQ(interpreter_.gain_percent(kKnee), 40);
  EXPECT_EQ(interpreter_.regained(), 1u << kKnee | 1u << kPan);
  EXPECT_EQ(interpreter_.softened(), 0u) << "the torque is another setting";
  advance(15'000, 5'000);
  EXPECT_EQ(interpreter_.gain_percent(kKnee), 150);
  EXPECT_EQ(interpreter_.gain_percent(kPan), 100);
  EXPECT_EQ(interpreter_.regained(), 1u << kKnee);
  advance(10'000);
  EXPECT_EQ(interpreter_.gain_percent(kKnee), 100);
  EXPECT_EQ(interpreter_.regained(), 0u);
}

TEST_F(OpcodeTest, StiffnessOfZeroLetsTheTargetFollowTheJoint) {
  const auto stiffness = [](std::uint8_t percent) {
    return Stiffness{.percent = percent, .joints = 1u << kKnee}.step();
  };
  start(knee_poses()
            .step(stiffness(0))
            .step(kMove, 1, 100'000)
            .step(stiffness(100))
            .step(kMove, 2, 100'000)
            .step(kEnd));
  for (int tick = 1; tick <= 9; ++tick) {
    measured_[kKnee] = degrees(4 * tick);
    interpreter_.advance(kTick_us, inputs_);
    EXPECT_NEAR(knee_deg(), 4 * tick, 1e-6) << "a move of a joint without torque moves nothing";
  }
  measured_[kKnee] = degrees(40);
  interpreter_.advance(kTick_us, inputs_);
  EXPECT_NEAR(knee_deg(), 40, 1e-6);
  measured_[kKnee] = degrees(50);  // not followed any more
  for (int tick = 1; tick <= 10; ++tick) {
    interpreter_.advance(kTick_us, inputs_);
    EXPECT_NEAR(knee_deg(), 40 + (kFlexed_deg - 40) * tick / 10, 1e-6);
  }
}

TEST_F(OpcodeTest, LeanIsReachedWithTheNextStepThatTakesTime) {
  const Step bow = LeanDeclaration{.pitch = 3'641, .roll = -1'820}.step();  // 20 and -10 degrees
  start(knee_poses()
            .step(kWait, 0, 50'000)
            .step(bow)
            .step(kMove, 1, 100'000)
            .step(kWait, 0, 100'000)
            .step(kEnd));
  advance(50'000);
  EXPECT_EQ(interpreter_.lean(), Lean());
  advance(50'000);
  EXPECT_NEAR(fixed::to_double(interpreter_.lean().pitch) / test::kRadPerDegree, 10, 0.01);
  EXPECT_NEAR(fixed::to_double(interpreter_.lean().roll) / test::kRadPerDegree, -5, 0.01);
  advance(100'000);
  EXPECT_NEAR(fixed::to_double(interpreter_.lean().pitch) / test::kRadPerDegree, 20, 0.01);
  advance(50'000);
  EXPECT_EQ(interpreter_.lean(), Lean());
}

}  // namespace
}  // namespace koboshi::motion
