#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <optional>
#include <random>
#include <set>
#include <string>

#include "firmware/motion/interpreter.h"
#include "firmware/storage/image.h"
#include "tests/unit/firmware/motion/motion_builder.h"

// Plays every mutated image that the validator accepts. The interpreter must not read outside the image (each
// is a separate heap block, for the address sanitizer), time must pass, every target must be within its
// joint's limits, and after a stop the motion must end within the time of all steps once.
namespace koboshi::motion {
namespace {

using enum Opcode;
using fixed::Angle;
using Random = std::mt19937;

constexpr std::uint32_t kSeed = 20080901;

// The number of images; the environment variable KOBOSHI_MUTATIONS sets another one, for runs by hand.
int image_count() {
  const char* const given = std::getenv("KOBOSHI_MUTATIONS");
  return given == nullptr ? 120'000 : std::max(1'000, std::atoi(given));
}

std::uint32_t draw(Random& random, std::uint32_t below) {
  return static_cast<std::uint32_t>(random() % below);
}

constexpr std::uint16_t kLeft = 0b11 << 2;  // two joints

// A program that uses every opcode.
std::vector<Step> every_opcode(Random& random) {
  const auto speed = std::uint32_t{1} << (10 + draw(random, 20));
  const bool by_speed = draw(random, 4) == 0;
  const std::int8_t supine = draw(random, 4) == 0 ? 127 : 0;
  return {
      Mix{MixSource::kPitch, 6, 400, Mix::kMinLimit}.step(),
      Stiffness{40, kLeft}.step(),
      {kMove, 0, 20'000},
      {kLoopBegin, 3},
      Move{Interpolation::kCubic, false, 1, 15'000}.step(),
      Move{Interpolation::kCubic, by_speed, 4, by_speed ? speed : 12'000}.step(),
      {kLoopBegin, 0},
      Move{draw(random, 2) == 0 ? Interpolation::kMinimumJerk : Interpolation::kTrapezoid, false, 2, 5'000,
           draw(random, 3) == 0}
          .step(),
      {kLoopEnd, 6},
      {kJump, draw(random, 4) == 0 ? std::uint16_t{10} : std::uint16_t{11}},
      {kFail},
      Condition{2, true, false}.branch(15),
      Test{{Source::kTime}, Comparison::kGreater, false, static_cast<std::int32_t>(draw(random, 200))}.step(),
      Test{{Source::kVariable, 1}, Comparison::kLess, true, 0}.step(),
      LeanDeclaration{1'000, -500}.step(),
      {kWait, 0, 1'000},
      Assignment{1, static_cast<Arithmetic>(draw(random, 8)), draw(random, 2) == 0, 17}.step(),
      {kLoopEnd, 3},
      ExpectedAttitude{.up_B = {supine, 0, static_cast<std::int8_t>(127 - supine)}, .min_cosine = 20'000}
          .step(),
      Condition{1, false, true}.await(draw(random, 2) == 0 ? kNoStep : std::uint16_t{21}, 30'000),
      Test{{Source::kJointError, 3}, Comparison::kNotEqual, false, 0}.step(),
      {kCall, 25},
      {kMixClear},
      {kMove, 3, 30'000},
      {kJump, 22},
      {kCall, 28},
      {kWait, 0, 2'000},
      {kReturn},
      Assignment{0, Arithmetic::kAdd, false, 1}.step(),
      Gain{150, kLeft}.step(),
      Move{.pose = 2, .value = 4'000, .windows = 2}.step(),
      Window{.start = 10, .end = 1'000, .joints = kLeft}.step(),
      Window{.start = 4'095, .end = 4'096, .joints = 1}.step(),
      {kReturn},
  };
}

// Returns a step of a random kind with fields that are valid more often than not.
Step random_step(Random& random, std::uint32_t count) {
  const auto target = static_cast<std::uint16_t>(draw(random, count + 1));
  switch (static_cast<Opcode>(draw(random, 18))) {
    case kMove:
      return Move{static_cast<Interpolation>(draw(random, 3)), draw(random, 16) == 0,
                  static_cast<std::uint16_t>(draw(random, 4)), 1'000 + draw(random, 30'000)}
          .step();
    case kJump:
      return {kJump, target};
    case kBranch:
      return Condition{1, draw(random, 2) == 0, draw(random, 2) == 0}.branch(target);
    case kAwait:
      return Condition{1, false, false}.await(target, 1'000 + draw(random, 30'000));
    case kTest:
      return Test{SourceRef::of(draw(random, 21)), static_cast<Comparison>(draw(random, 6)),
                  draw(random, 2) == 0, static_cast<std::int32_t>(draw(random, 2))}
          .step();
    case kCall:
      return {kCall, target};
    case kReturn:
      return {kReturn};
    case kSet:
      return Assignment{static_cast<std::uint16_t>(draw(random, 2)), static_cast<Arithmetic>(draw(random, 8)),
                        draw(random, 2) == 0, static_cast<std::int32_t>(draw(random, 21))}
          .step();
    case kMix:
      return Mix{static_cast<MixSource>(draw(random, 5)), static_cast<std::uint8_t>(draw(random, 20)),
                 static_cast<std::int16_t>(random()), Mix::kMaxLimit}
          .step();
    default:
      return {kWait, 0, 1'000 + draw(random, 30'000)};
  }
}

// Returns a motion that uses every feature, or a random sequence of mostly invalid steps.
test::MotionBuilder make_motion(const robot::RobotModel& model, Random& random) {
  test::MotionBuilder builder(model);
  builder.pose(3, 0).pose(3, 150).pose(18, -90).pose(18, 90).packed_pose(kLeft, {0, 100});
  builder.variable_count = 2;
  if (draw(random, 2) == 0) {
    builder.steps = every_opcode(random);
    if (draw(random, 2) == 0) builder.exit_step = static_cast<std::uint16_t>(18 + draw(random, 6));
    return builder;
  }
  const std::uint32_t count = 1 + draw(random, 10);
  std::vector<std::uint16_t> open;
  for (std::uint16_t i = 0; i < count; ++i) {
    switch (draw(random, 4)) {
      case 0:
        open.push_back(i);
        builder.step(kLoopBegin, static_cast<std::uint16_t>(draw(random, 4)));
        break;
      case 1:
        builder.step(kLoopEnd, open.empty() ? std::uint16_t{0} : open.back());
        if (!open.empty()) open.pop_back();
        break;
      default:
        builder.step(random_step(random, count));
        if (!has_condition(builder.steps.back().opcode)) break;
        builder.step(Test{{Source::kRoll}, Comparison::kLess, false, 5}.step());
        ++i;
    }
  }
  builder.step(kEnd);
  return builder;
}

// Changes bytes anywhere behind the header, fields of steps more often.
void mutate(std::vector<std::byte>& image, std::size_t steps_size, Random& random) {
  const std::uint32_t mutations = draw(random, 3);
  for (std::uint32_t i = 0; i < mutations; ++i) {
    const std::size_t range = draw(random, 4) == 0 ? image.size() - storage::kImageHeaderSize : steps_size;
    const std::size_t at = image.size() - 1 - draw(random, static_cast<std::uint32_t>(range));
    image[at] =
        draw(random, 2) == 0 ? static_cast<std::byte>(draw(random, 12)) : static_cast<std::byte>(random());
  }
  test::seal(image);
}

class MutationTest : public testing::Test {
 protected:
  static estimation::RobotState leaning() {
    estimation::RobotState state;
    state.roll = test::degrees(20);
    state.pitch = test::degrees(-40);
    state.rates_B.x = fixed::AngularRate::from_raw(1 << 24);
    return state;
  }

  void expect_within_limits(std::span<const Angle> targets) const {
    for (std::size_t i = 0; i < model_.joint_count; ++i) {
      ASSERT_GE(targets[i], model_.joints[i].lower);
      ASSERT_LE(targets[i], model_.joints[i].upper);
    }
  }

  void expect_within_limits(Interpreter& interpreter) const {
    expect_within_limits(interpreter.targets());
    std::array<Angle, 20> corrected{};
    std::ranges::copy(interpreter.targets(), corrected.begin());
    interpreter.add_corrections(corrected, state_);
    expect_within_limits(corrected);
  }

  // A motion ends at its end, or, after a stop, by a jump backwards at the end of the main program.
  static void expect_at_end(const Motion& motion, const Interpreter& interpreter) {
    const Opcode opcode = motion.opcode(interpreter.step_index());
    if (interpreter.failed()) {
      ASSERT_TRUE(opcode == kExpect || opcode == kFail || opcode == kAwait || opcode == kSet ||
                  opcode == kMix);
    } else {
      ASSERT_TRUE(opcode == kEnd ||
                  (opcode == kJump && interpreter.step_index() + 1u == motion.main_step_count()));
    }
  }

  // The longest time from a step to the end of its routine, with every step once, and those of a subroutine
  // once per call: what a motion may take after a stop. Without a value if an exit path repeats steps.
  static std::optional<std::uint64_t> time_to_end_us(const Motion& motion, std::size_t begin = 0) {
    std::set<std::size_t> routines{motion.step_count()};
    for (std::size_t i = 0; i < motion.step_count(); ++i) {
      if (motion.opcode(i) == kCall) routines.insert(motion.step(i).operand);
    }
    std::uint64_t sum_us = 0;
    for (std::size_t i = begin; i < *routines.upper_bound(begin); ++i) {
      const Step step = motion.step(i);
      const bool is_open = step.opcode == kMove && (Move::of(step).by_speed || Move::of(step).at_least);
      if (takes_time(step.opcode) || step.opcode == kAwait) sum_us += is_open ? kMaxStepTime_us : step.value;
      if (step.opcode == kLoopBegin && step.operand > 1 && motion.exit_step() != kNoStep) return {};
      if (step.opcode != kCall) continue;
      const auto callee_us = time_to_end_us(motion, step.operand);
      if (!callee_us) return {};
      sum_us += *callee_us;
    }
    return sum_us;
  }

  void play(const Motion& motion, Random& random) {
    Interpreter interpreter(model_);
    std::array<Angle, 20> pose;
    for (Angle& angle : pose) angle = Angle::from_raw(static_cast<std::int32_t>(random()));
    interpreter.start(motion, pose, inputs_);
    const std::uint32_t tick_us = draw(random, 2) == 0 ? 10'000 : 1 + draw(random, 100'000);
    for (int tick = 0; tick < 60 && interpreter.running(); ++tick) {
      interpreter.advance(tick_us, inputs_);
      expect_within_limits(interpreter);
      steps_seen_.insert(interpreter.step_index());
      opcodes_seen_.insert(motion.opcode(interpreter.step_index()));
    }
    if (!interpreter.running()) expect_at_end(motion, interpreter);
    interpreter.stop();
    // Skips long motions, which would take many ticks.
    const auto longest_us = time_to_end_us(motion);
    if (!longest_us || *longest_us > 1'000'000) return;
    std::uint64_t time_us = 0;
    while (interpreter.running()) {
      interpreter.advance(10'000, inputs_);
      expect_within_limits(interpreter);
      time_us += 10'000;
      ASSERT_LT(time_us, *longest_us + 2 * Interpreter::kMaxAdvance_us);
    }
    expect_at_end(motion, interpreter);
    ++ended_;
  }

  const robot::RobotModel model_ = test::load_test_robot();
  const estimation::RobotState state_ = leaning();
  const std::array<Angle, 20> measured_{};
  const Inputs inputs_{.robot = state_, .angles = measured_};
  std::set<std::uint16_t> steps_seen_;
  std::set<Opcode> opcodes_seen_;
  int ended_ = 0;
};

TEST_F(MutationTest, AcceptedImagesAreSafeToPlay) {
  RecordProperty("seed", static_cast<int>(kSeed));
  SCOPED_TRACE("seed " + std::to_string(kSeed));
  Random random(kSeed);
  const int images = image_count();
  int accepted = 0;
  std::set<MotionStatus> reasons;
  for (int round = 0; round < images; ++round) {
    const test::MotionBuilder builder = make_motion(model_, random);
    std::vector<std::byte> image = builder.image();
    mutate(image, builder.steps.size() * kStepSize, random);
    Motion motion;
    const MotionVerdict verdict = Motion::open(image, model_, motion);
    reasons.insert(verdict.status);
    if (!verdict.ok()) continue;
    ++accepted;
    ASSERT_NO_FATAL_FAILURE(play(motion, random)) << "image " << round;
  }
  RecordProperty("accepted", accepted);
  RecordProperty("ended", ended_);
  // The mutations must neither keep nor break all images, and must trigger every status that they can.
  EXPECT_GT(accepted, images / 10);
  EXPECT_LT(accepted, images / 10 * 9);
  EXPECT_GT(ended_, images / 20);
  for (const MotionStatus reason :
       {MotionStatus::kOtherRobot, MotionStatus::kBadCount, MotionStatus::kBadName, MotionStatus::kBadPose,
        MotionStatus::kBeyondLimits, MotionStatus::kBadOpcode, MotionStatus::kBadStepTime,
        MotionStatus::kNoSuchPose, MotionStatus::kBadLoop, MotionStatus::kBadJump, MotionStatus::kNoEnd,
        MotionStatus::kTakesNoTime, MotionStatus::kBadAttitude, MotionStatus::kBadGroup,
        MotionStatus::kBadTest, MotionStatus::kBadSource, MotionStatus::kBadRoutine, MotionStatus::kBadExit,
        MotionStatus::kBadJoint}) {
    EXPECT_TRUE(reasons.contains(reason)) << static_cast<int>(reason);
  }
  EXPECT_GE(steps_seen_.size(), 10u);
  for (const Opcode opcode : {kEnd, kMove, kWait, kJump, kExpect, kAwait, kSet, kFail})
    EXPECT_TRUE(opcodes_seen_.contains(opcode)) << static_cast<int>(opcode);
}

}  // namespace
}  // namespace koboshi::motion
