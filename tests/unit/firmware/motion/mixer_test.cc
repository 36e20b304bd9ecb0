// Corrections that were removed fade linearly in 0.2 s, whatever happens meanwhile.

#include "firmware/motion/mixer.h"

#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "tests/unit/firmware/motion/interpreter_fixture.h"

namespace koboshi::motion {
namespace {

using enum Opcode;
using test::degrees;

constexpr std::size_t kJoints = 20;
constexpr double kTolerance_deg = 0.001;

constexpr Mix of_pitch(std::size_t joint, std::int16_t gain = 4'096) {
  return {.source = MixSource::kPitch,
          .joint = static_cast<std::uint8_t>(joint),
          .gain = gain,
          .limit = Mix::kMaxLimit};
}
constexpr Mix of_roll(std::size_t joint) {
  return {.source = MixSource::kRoll,
          .joint = static_cast<std::uint8_t>(joint),
          .gain = 4'096,
          .limit = Mix::kMaxLimit};
}
constexpr Mix without(Mix mix) {
  mix.gain = 0;
  return mix;
}

class MixerTest : public testing::Test {
 protected:
  // Passes one tick and returns the corrections of targets at `base_`.
  std::array<double, kJoints> tick() {
    mixer_.pass(kTick_us);
    std::array<fixed::Angle, kJoints> targets = base_;
    mixer_.add_to(targets, model_, state_, {});
    std::array<double, kJoints> added_deg{};
    for (std::size_t j = 0; j < kJoints; ++j)
      added_deg[j] = fixed::to_double(targets[j] - base_[j]) / test::kRadPerDegree;
    return added_deg;
  }
  void ticks(int count) {
    for (int i = 0; i < count; ++i) tick();
  }
  void lean_to(double pitch_deg, double roll_deg = 0) {
    state_.pitch = degrees(pitch_deg);
    state_.roll = degrees(roll_deg);
  }

  const robot::RobotModel model_ = test::load_test_robot();
  std::array<fixed::Angle, kJoints> base_ = [this] {
    std::array<fixed::Angle, kJoints> middle{};
    for (std::size_t j = 0; j < kJoints; ++j)
      middle[j] =
          fixed::Angle::from_raw((model_.joints[j].lower.raw() / 2) + (model_.joints[j].upper.raw() / 2));
    return middle;
  }();
  estimation::RobotState state_;
  Mixer mixer_;
};

TEST_F(MixerTest, MeasuresRollAndPitchFromTheDeclaredLean) {
  lean_to(5, 10);
  const Lean lean{.roll = degrees(4), .pitch = degrees(-3)};
  for (const auto& [source, expected_deg] : {std::pair{MixSource::kRoll, 6.0}, {MixSource::kPitch, 8.0}}) {
    mixer_.reset();
    ASSERT_TRUE(mixer_.set({.source = source, .joint = 3, .gain = 4096, .limit = Mix::kMaxLimit}));
    std::array<fixed::Angle, kJoints> targets = base_;
    mixer_.add_to(targets, model_, state_, lean);
    EXPECT_NEAR(fixed::to_double(targets[3] - base_[3]) / test::kRadPerDegree, expected_deg, 0.01);
  }
}

TEST_F(MixerTest, AddsANewCorrectionToOneThatFades) {
  lean_to(6);
  ASSERT_TRUE(mixer_.set(of_pitch(kKnee)));
  EXPECT_NEAR(tick()[kKnee], 6, kTolerance_deg);
  mixer_.clear();
  ticks(10);
  lean_to(2);
  ASSERT_TRUE(mixer_.set(of_pitch(kKnee)));
  for (int i = 1; i <= 10; ++i) EXPECT_NEAR(tick()[kKnee], 2 + 6.0 * (10 - i) / 20, kTolerance_deg) << i;
  EXPECT_FALSE(mixer_.fading());
  EXPECT_NEAR(tick()[kKnee], 2, kTolerance_deg);
}

TEST_F(MixerTest, FadesWhatIsLeftWithWhatIsRemovedAfterIt) {
  lean_to(6);
  ASSERT_TRUE(mixer_.set(of_pitch(kKnee)));
  tick();
  mixer_.clear();
  ticks(10);  // 3 degrees are left
  ASSERT_TRUE(mixer_.set(of_pitch(kKnee)));
  EXPECT_NEAR(tick()[kKnee], 2.7 + 6, kTolerance_deg);
  ASSERT_TRUE(mixer_.set(without(of_pitch(kKnee))));
  for (int i = 1; i <= 20; ++i) EXPECT_NEAR(tick()[kKnee], 8.7 * (20 - i) / 20, kTolerance_deg) << i;
  EXPECT_FALSE(mixer_.fading());
}

TEST_F(MixerTest, RemovesTwiceWithoutEffect) {
  lean_to(6);
  ASSERT_TRUE(mixer_.set(of_pitch(kKnee)));
  tick();
  ASSERT_TRUE(mixer_.set(without(of_pitch(kKnee))));
  ticks(5);
  ASSERT_TRUE(mixer_.set(without(of_pitch(kKnee))));
  mixer_.clear();
  EXPECT_NEAR(tick()[kKnee], 6.0 * 14 / 20, kTolerance_deg) << "the fade does not begin again";
}

TEST_F(MixerTest, FadesTheSourcesOfAJointTogether) {
  lean_to(6, 3);
  ASSERT_TRUE(mixer_.set(of_pitch(kKnee)));
  ASSERT_TRUE(mixer_.set(of_roll(kKnee)));
  EXPECT_NEAR(tick()[kKnee], 9, kTolerance_deg);
  ASSERT_TRUE(mixer_.set(without(of_roll(kKnee))));
  lean_to(4, 30);
  EXPECT_NEAR(tick()[kKnee], 4 + 3.0 * 19 / 20, kTolerance_deg) << "one follows, the other fades";
  mixer_.clear();
  for (int i = 1; i <= 20; ++i)
    EXPECT_NEAR(tick()[kKnee], (4 + 3.0 * 19 / 20) * (20 - i) / 20, kTolerance_deg) << i;
}

TEST_F(MixerTest, FadesManyJointsByThemselves) {
  lean_to(4);
  std::array<double, kJoints> removed_deg{};
  for (std::size_t j = 0; j < kMaxMixes; ++j) {
    const int size = 256 * (static_cast<int>(j) + 1);
    const auto gain = static_cast<std::int16_t>(j % 2 == 0 ? size : -size);
    removed_deg[j] = 4.0 * gain / 4'096;
    ASSERT_TRUE(mixer_.set(of_pitch(j, gain)));
  }
  EXPECT_FALSE(mixer_.set(of_pitch(kMaxMixes)));
  tick();
  // One joint after the other in each tick, so that each fades from another tick on.
  for (std::size_t now = 1; now <= kMaxMixes + 20; ++now) {
    if (now <= kMaxMixes) {
      ASSERT_TRUE(mixer_.set(without(of_pitch(now - 1))));
    }
    const auto added_deg = tick();
    for (std::size_t j = 0; j < kJoints; ++j) {
      const double faded = j < now ? std::min(1.0, static_cast<double>(now - j) / 20) : 0.0;
      EXPECT_NEAR(added_deg[j], removed_deg[j] * (1 - faded), kTolerance_deg)
          << "joint " << j << " in " << now;
    }
  }
  EXPECT_FALSE(mixer_.fading());
}

TEST_F(MixerTest, KeepsFadingCorrectionsWithinTheLimits) {
  lean_to(15);
  base_[kKnee] = model_.joints[kKnee].upper - degrees(5);
  ASSERT_TRUE(mixer_.set(of_pitch(kKnee)));
  EXPECT_NEAR(tick()[kKnee], 5, kTolerance_deg);
  mixer_.clear();
  for (int i = 1; i <= 20; ++i) EXPECT_NEAR(tick()[kKnee], std::min(5.0, 15.0 * (20 - i) / 20), 0.01) << i;
}

// The motion's own ends.
class FadingExit : public InterpreterTest {
 protected:
  // Plays a loop with a correction of 6 degrees, which an exit path of 0.3 s follows.
  void play(const std::vector<Step>& exit) {
    state_.pitch = degrees(6);
    test::MotionBuilder builder = knee_poses();
    builder.step(kMove, 2, 10'000).step(of_pitch(kKnee).step());
    builder.step(kLoopBegin, 0).step(kWait, 0, 100'000).step(kLoopEnd, 2).step(kEnd);
    builder.exit_step = static_cast<std::uint16_t>(builder.steps.size());
    for (const Step& step : exit) builder.step(step);
    builder.step(kWait, 0, 300'000).step(kEnd);
    start(builder);
    for (int tick = 0; tick < 10; ++tick) advance_once();
    ASSERT_NEAR(advance_once(), kFlexed_deg + 6, kTolerance_deg);
  }
  double advance_once() {
    advance(kTick_us);
    return corrected_knee_deg();
  }
  void expect_fade() {
    for (int i = 1; i <= 20; ++i) {
      EXPECT_NEAR(advance_once(), kFlexed_deg + 6.0 * (20 - i) / 20, kTolerance_deg) << i;
    }
  }
};

TEST_F(FadingExit, BeginsWhereTheExitPathRemovesTheCorrection) {
  play({{kMixClear}});
  interpreter_.stop();
  double now_deg = kFlexed_deg + 6;
  int waited = 0;
  for (; waited < 15 && now_deg > kFlexed_deg + 6 - kTolerance_deg; ++waited) now_deg = advance_once();
  ASSERT_LT(waited, 15) << "the present step of 0.1 s ends first";
  EXPECT_NEAR(now_deg, kFlexed_deg + 6.0 * 19 / 20, kTolerance_deg);
  for (int i = 1; i <= 19; ++i)
    EXPECT_NEAR(advance_once(), kFlexed_deg + 6.0 * (19 - i) / 20, kTolerance_deg) << i;
  EXPECT_TRUE(interpreter_.running());
  EXPECT_FALSE(interpreter_.fading());
}

TEST_F(FadingExit, BeginsAtTheEndOfAnExitPathThatKeepsTheCorrection) {
  play({});
  interpreter_.stop();
  double last_deg = 0;
  for (int i = 0; i < 60 && interpreter_.running(); ++i) last_deg = advance_once();
  ASSERT_FALSE(interpreter_.running());
  EXPECT_NEAR(last_deg, kFlexed_deg + 6, kTolerance_deg);
  EXPECT_TRUE(interpreter_.fading());
  expect_fade();
  EXPECT_FALSE(interpreter_.fading());
}

TEST_F(FadingExit, BeginsAfterAStopWithoutAnExitPath) {
  state_.pitch = degrees(6);
  start(knee_poses()
            .step(kMove, 2, 10'000)
            .step(of_pitch(kKnee).step())
            .step(kLoopBegin, 0)
            .step(kWait, 0, 100'000)
            .step(kLoopEnd, 2)
            .step(kEnd));
  for (int tick = 0; tick < 15; ++tick) advance_once();
  interpreter_.stop();
  for (int i = 0; i < 20 && interpreter_.running(); ++i) advance_once();
  ASSERT_FALSE(interpreter_.running());
  expect_fade();
}

// A motion that starts from the targets in force, with what still fades, continues there: the fade ends.
TEST_F(FadingExit, EndsWithTheStartOfTheNextMotion) {
  play({{kMixClear}});
  interpreter_.stop();
  for (int i = 0; i < 60 && interpreter_.running() && !interpreter_.fading(); ++i) {
    if (advance_once() < kFlexed_deg + 4) break;
  }
  const double before_deg = corrected_knee_deg();
  ASSERT_GT(before_deg, kFlexed_deg + 1);
  std::ranges::copy(interpreter_.targets(), pose_.begin());
  interpreter_.add_corrections(pose_, state_);
  start(knee_poses().step(kWait, 0, 100'000).step(kMove, 2, 100'000).step(kEnd));
  EXPECT_NEAR(corrected_knee_deg(), before_deg, kTolerance_deg);
  EXPECT_NEAR(advance_once(), before_deg, kTolerance_deg);
}

}  // namespace
}  // namespace koboshi::motion
