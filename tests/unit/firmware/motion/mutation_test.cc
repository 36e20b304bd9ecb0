#include <gtest/gtest.h>

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
constexpr int kImages = 120'000;

std::uint32_t draw(Random& random, std::uint32_t below) {
  return static_cast<std::uint32_t>(random() % below);
}

// Returns a motion that uses every feature, or a random sequence of mostly invalid steps.
test::MotionBuilder make_motion(const robot::RobotModel& model, Random& random) {
  test::MotionBuilder builder(model);
  builder.pose(3, 0).pose(3, 150).pose(18, -90).pose(18, 90);
  if (draw(random, 2) == 0) {
    builder.steps = {{kMove, 0, 20'000}, {kLoopBegin, 3, 0}, {kMove, 1, 15'000}, {kLoopBegin, 0, 0},
                     {kMove, 2, 5'000},  {kLoopEnd, 3, 0},   {kJump, 8, 0},      {kWait, 0, 1'000},
                     {kLoopEnd, 1, 0},   {kMove, 3, 30'000}, {kJump, 9, 0},      {kEnd, 0, 0}};
    return builder;
  }
  const std::uint32_t count = 1 + draw(random, 10);
  std::vector<std::uint16_t> open;
  for (std::uint16_t i = 0; i < count; ++i) {
    const auto opcode = static_cast<Opcode>(draw(random, 6));
    auto operand = static_cast<std::uint16_t>(draw(random, 4));
    if (opcode == kJump) operand = static_cast<std::uint16_t>(draw(random, count + 1));
    if (opcode == kLoopBegin) open.push_back(i);
    if (opcode == kLoopEnd && !open.empty()) {
      operand = open.back();
      open.pop_back();
    }
    if (opcode == kEnd || opcode == kWait) operand = 0;
    builder.step(opcode, operand, takes_time(opcode) ? 1'000 + draw(random, 30'000) : 0);
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
  void expect_within_limits(const Interpreter& interpreter) const {
    for (std::size_t i = 0; i < model_.joint_count; ++i) {
      ASSERT_GE(interpreter.targets()[i], model_.joints[i].lower);
      ASSERT_LE(interpreter.targets()[i], model_.joints[i].upper);
    }
  }

  // On a cycle without time the interpreter stops at another step.
  static void expect_at_end(const Motion& motion, const Interpreter& interpreter) {
    ASSERT_EQ(motion.step(interpreter.step_index()).opcode, interpreter.failed() ? kExpect : kEnd);
  }

  static std::uint64_t time_of_all_steps_us(const Motion& motion) {
    std::uint64_t sum_us = 0;
    for (std::size_t i = 0; i < motion.step_count(); ++i) {
      if (takes_time(motion.step(i).opcode)) sum_us += motion.step(i).time_us;
    }
    return sum_us;
  }

  void play(const Motion& motion, Random& random) {
    Interpreter interpreter(model_, robot::kAxisZ);
    std::array<Angle, 20> pose;
    for (Angle& angle : pose) angle = Angle::from_raw(static_cast<std::int32_t>(random()));
    interpreter.start(motion, pose);
    const std::uint32_t tick_us = draw(random, 2) == 0 ? 10'000 : 1 + draw(random, 100'000);
    for (int tick = 0; tick < 60 && interpreter.running(); ++tick) {
      interpreter.advance(tick_us);
      expect_within_limits(interpreter);
      steps_seen_.insert(interpreter.step_index());
    }
    if (!interpreter.running()) expect_at_end(motion, interpreter);
    interpreter.stop();
    // Skips long motions, which would take many ticks.
    if (time_of_all_steps_us(motion) > 1'000'000) return;
    std::uint64_t time_us = 0;
    while (interpreter.running()) {
      interpreter.advance(Interpreter::kMaxAdvance_us);
      expect_within_limits(interpreter);
      time_us += Interpreter::kMaxAdvance_us;
      ASSERT_LT(time_us, time_of_all_steps_us(motion) + 2 * Interpreter::kMaxAdvance_us);
    }
    expect_at_end(motion, interpreter);
    ++ended_;
  }

  const robot::RobotModel model_ = test::load_test_robot();
  std::set<std::uint16_t> steps_seen_;
  int ended_ = 0;
};

TEST_F(MutationTest, AcceptedImagesAreSafeToPlay) {
  RecordProperty("seed", static_cast<int>(kSeed));
  SCOPED_TRACE("seed " + std::to_string(kSeed));
  Random random(kSeed);
  int accepted = 0;
  std::set<MotionStatus> reasons;
  for (int round = 0; round < kImages; ++round) {
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
  EXPECT_GT(accepted, kImages / 10);
  EXPECT_LT(accepted, kImages * 9 / 10);
  EXPECT_GT(ended_, kImages / 20);
  for (const MotionStatus reason :
       {MotionStatus::kOtherRobot, MotionStatus::kBadCount, MotionStatus::kBadName, MotionStatus::kBadPose,
        MotionStatus::kBeyondLimits, MotionStatus::kBadOpcode, MotionStatus::kBadStepTime,
        MotionStatus::kNoSuchPose, MotionStatus::kBadLoop, MotionStatus::kBadJump, MotionStatus::kNoEnd,
        MotionStatus::kTakesNoTime}) {
    EXPECT_TRUE(reasons.contains(reason)) << static_cast<int>(reason);
  }
  EXPECT_GE(steps_seen_.size(), 10u);
}

}  // namespace
}  // namespace koboshi::motion
