#include "firmware/motion/motion.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>

#include "tests/unit/firmware/motion/motion_builder.h"

namespace koboshi::motion {
namespace {

using enum Opcode;
using enum MotionStatus;
using test::MotionBuilder;

class MotionTest : public testing::Test {
 protected:
  MotionStatus status(const MotionBuilder& builder) { return status(builder.image()); }
  MotionStatus status(const std::vector<std::byte>& image) { return open(image).status; }
  MotionVerdict open(const std::vector<std::byte>& image) {
    Motion motion;
    const MotionVerdict verdict = Motion::open(image, model_, motion);
    EXPECT_EQ(verdict.ok(), motion.step_count() != 0);
    return verdict;
  }
  // Pose 0 bends the left knee, pose 1 turns the head.
  MotionBuilder builder() const {
    MotionBuilder builder(model_);
    builder.pose(3, 60).pose(18, 30);
    return builder;
  }
  MotionStatus of_steps(const std::vector<Step>& steps) { return verdict_of(steps).status; }
  MotionVerdict verdict_of(const std::vector<Step>& steps) {
    MotionBuilder with_steps = builder();
    with_steps.variable_count = 1;
    with_steps.steps = steps;
    return open(with_steps.image());
  }

  const robot::RobotModel model_ = test::load_test_robot();
};

constexpr Step kMoveStep{kMove, 0, 10'000};
constexpr Step kWaitStep{kWait, 0, 10'000};
constexpr Step kEndStep{kEnd, 0, 0};
constexpr Step loop(std::uint16_t times) { return {kLoopBegin, times, 0}; }
constexpr Step loop_end(std::uint16_t begin) { return {kLoopEnd, begin, 0}; }
constexpr Step jump(std::uint16_t target) { return {kJump, target, 0}; }

TEST_F(MotionTest, ReadsTheImage) {
  const std::vector<std::byte> image = builder().step(kMove, 1, 40'000).step(kEnd).image();
  Motion motion;
  ASSERT_TRUE(Motion::open(image, model_, motion).ok());
  EXPECT_EQ(motion.name(), "test");
  EXPECT_EQ(motion.image_size_bytes(), image.size());
  EXPECT_EQ(motion.joint_count(), 20u);
  EXPECT_EQ(motion.pose_count(), 2u);
  EXPECT_EQ(motion.step_count(), 2u);
  EXPECT_EQ(motion.joint_mask(0), 1u << 3);
  EXPECT_NEAR(fixed::to_double(motion.angle(0, 3)), 60 * test::kRadPerDegree, 2e-4);
  EXPECT_EQ(motion.angle(0, 4), fixed::Angle());
  EXPECT_EQ(motion.claimed_joints(), 1u << 3 | 1u << 18);
  EXPECT_EQ(motion.main_step_count(), 2u);
  EXPECT_EQ(motion.exit_step(), kNoStep);
  EXPECT_EQ(motion.step(0).opcode, kMove);
  EXPECT_EQ(motion.step(0).value, 40'000u);
  EXPECT_EQ(motion.step(99).opcode, kEnd);
}

TEST_F(MotionTest, ReopensAnImageWithTheFindingsOfItsValidation) {
  MotionBuilder calls = builder();
  calls.variable_count = 3;
  calls.pose(3, 20).step(kMove, 2, 40'000).step(kCall, 3).step(kEnd);
  calls.step(Mix{.source = MixSource::kPitch, .joint = 7, .gain = 100}.step());
  calls.step(kMove, 1, 10'000).step(kReturn);
  calls.exit_step = 2;
  const std::vector<std::byte> image = calls.image();
  Motion opened;
  ASSERT_TRUE(Motion::open(image, model_, opened).ok());
  std::vector<std::byte> moved = image;
  moved.resize(moved.size() + 5);  // bytes of a padding
  const Motion again = Motion::reopen(moved, opened.findings());
  EXPECT_EQ(again.name(), opened.name());
  EXPECT_EQ(again.image_size_bytes(), image.size());
  EXPECT_EQ(again.joint_count(), 20u);
  EXPECT_EQ(again.variable_count(), 3u);
  EXPECT_EQ(again.group_count(), 2u);
  EXPECT_EQ(again.pose_count(), 3u);
  EXPECT_EQ(again.exit_step(), 2u);
  EXPECT_EQ(again.main_step_count(), 3u);
  EXPECT_EQ(again.claimed_joints(), 1u << 3 | 1u << 7 | 1u << 18);
  ASSERT_EQ(again.step_count(), opened.step_count());
  for (std::size_t i = 0; i < opened.step_count(); ++i) {
    EXPECT_EQ(again.step(i).opcode, opened.step(i).opcode) << i;
    EXPECT_EQ(again.step(i).operand, opened.step(i).operand) << i;
    EXPECT_EQ(again.step(i).value, opened.step(i).value) << i;
  }
  for (std::size_t pose = 0; pose < opened.pose_count(); ++pose) {
    EXPECT_EQ(again.joint_mask(pose), opened.joint_mask(pose));
    for (const std::size_t joint : {3u, 18u}) EXPECT_EQ(again.angle(pose, joint), opened.angle(pose, joint));
  }
}

TEST_F(MotionTest, ClaimsTheJointsOfPosesMixesAndStiffness) {
  MotionBuilder claims = builder();
  claims.step(Stiffness{.joints = 1u << 5 | 1u << 19}.step()).step(Stiffness{.joints = 1u << 6}.step());
  claims.step(Mix{.source = MixSource::kPitch, .joint = 7, .gain = 100}.step()).step(kEnd);
  const std::vector<std::byte> image = claims.image();
  Motion motion;
  ASSERT_TRUE(Motion::open(image, model_, motion).ok());
  EXPECT_EQ(motion.claimed_joints(), 1u << 3 | 1u << 5 | 1u << 6 | 1u << 7 | 1u << 18 | 1u << 19);
}

TEST_F(MotionTest, IsEmptyUntilOpened) {
  EXPECT_EQ(Motion().name(), "");
  EXPECT_EQ(Motion().image_size_bytes(), 0u);
  EXPECT_EQ(Motion().step(0).opcode, kEnd);
}

TEST_F(MotionTest, RejectsEveryTruncatedImage) {
  const std::vector<std::byte> image = builder().step(kEnd).image();
  for (std::size_t size = 0; size < image.size(); ++size) {
    EXPECT_EQ(status({image.begin(), image.begin() + static_cast<std::ptrdiff_t>(size)}), kTruncated) << size;
  }
}

TEST_F(MotionTest, RejectsAnotherRobotOrVersion) {
  MotionBuilder other = builder().step(kEnd);
  other.model_id ^= 1;
  EXPECT_EQ(status(other), kOtherRobot);
  std::vector<std::byte> image = builder().step(kEnd).image();
  image[4] = std::byte{1};
  test::seal(image);
  EXPECT_EQ(status(image), kBadVersion);
  image[0] = std::byte{0};
  EXPECT_EQ(status(image), kBadMagic);
}

TEST_F(MotionTest, RejectsInvalidCounts) {
  EXPECT_EQ(status(builder()), kBadCount);
  MotionBuilder long_one = builder();
  long_one.steps.assign(kMaxSteps, kWaitStep);
  long_one.steps.back() = kEndStep;
  EXPECT_EQ(status(long_one), kOk);
  long_one.steps.push_back(kEndStep);
  EXPECT_EQ(status(long_one), kBadCount);
  MotionBuilder fewer = builder().step(kEnd);
  fewer.joint_count = 19;
  EXPECT_EQ(status(fewer), kBadCount);
  std::vector<std::byte> longer = builder().step(kEnd).image();
  longer.push_back(std::byte{0});
  test::seal(longer);
  EXPECT_EQ(status(longer), kBadSize);
}

TEST_F(MotionTest, RefusesBadNames) {
  for (const std::string& name : {std::string(), std::string("a\n"), std::string("a\0b", 3)}) {
    MotionBuilder named = builder().step(kEnd);
    named.name = name;
    EXPECT_EQ(status(named), kBadName);
  }
}

TEST_F(MotionTest, RejectsPosesBeyondLimits) {
  EXPECT_EQ(status(builder().pose(3, 150.1).step(kEnd)), kBeyondLimits);
  EXPECT_EQ(status(builder().pose(3, -0.1).step(kEnd)), kBeyondLimits);
  EXPECT_EQ(status(builder().pose(3, 150).step(kEnd)), kOk);
}

// An angle is rounded to 2^-14 turn, and so may lie beyond the limit by one of them.
TEST_F(MotionTest, AcceptsOneUnitBeyondALimitAndNoMore) {
  for (const std::int32_t sign : {-1, 1}) {
    const fixed::Angle limit = sign < 0 ? model_.joints[3].lower : model_.joints[3].upper;
    const std::int32_t inside = limit.raw() >> kPoseShift;
    const std::int32_t accepted = sign > 0 ? inside + 1 : inside - (limit.raw() % (1 << kPoseShift) == 0);
    EXPECT_EQ(status(builder().packed_pose(1u << 3, {accepted}).step(kEnd)), kOk);
    EXPECT_EQ(status(builder().packed_pose(1u << 3, {accepted + sign}).step(kEnd)), kBeyondLimits);
  }
}

TEST_F(MotionTest, RejectsInvalidPoseGroups) {
  const auto of_groups = [&](const std::vector<MotionBuilder::Group>& groups) {
    MotionBuilder with_groups = builder().step(kEnd);
    with_groups.groups = groups;
    return status(with_groups);
  };
  EXPECT_EQ(of_groups({{1u << 3, {{100}}}, {1u << 4, {{0}}}}), kOk);
  EXPECT_EQ(of_groups({{0, {{}}}}), kBadGroup);
  EXPECT_EQ(of_groups({{1u << 20, {{0}}}}), kBadGroup);
  EXPECT_EQ(of_groups({{1u << 3, {}}}), kBadGroup);
  EXPECT_EQ(of_groups({{1u << 3, {{100}}}, {1u << 3, {{200}}}}), kBadGroup);
  std::vector<MotionBuilder::Group> many;
  for (std::uint32_t joints = 1; many.size() < kMaxPoseGroups; ++joints)
    many.push_back({joints, {std::vector<std::int32_t>(static_cast<std::size_t>(std::popcount(joints)))}});
  EXPECT_EQ(of_groups(many), kOk);
  many.push_back({1u << 19, {{0}}});
  EXPECT_EQ(of_groups(many), kBadCount);
  std::vector<std::byte> spare = builder().step(kEnd).image();
  spare[16 + kMotionFixedSize + 2 * kPoseGroupSize + 1] |= std::byte{0x80};
  test::seal(spare);
  EXPECT_EQ(status(spare), kBadPose);
}

TEST_F(MotionTest, ReportsTheIndexOfABadPoseOrStep) {
  EXPECT_EQ(open(builder().pose(18, 179).step(kEnd).image()).index, 2);
  EXPECT_EQ(open(builder().step(kWait, 0, 1'000).step(kMove, 7, 1'000).step(kEnd).image()).index, 1);
}

// The index is that of the step that the author of the motion has to change.
TEST_F(MotionTest, ReportsTheStepThatBreaksTheFlow) {
  const auto index_of = [this](const std::vector<Step>& steps, MotionStatus expected) {
    MotionBuilder with_steps = builder();
    with_steps.steps = steps;
    const MotionVerdict verdict = open(with_steps.image());
    EXPECT_EQ(verdict.status, expected);
    return verdict.index;
  };
  const Step test = motion::Test{{Source::kTime}, Comparison::kGreater, false, 5}.step();
  EXPECT_EQ(index_of({kWaitStep, kMoveStep}, kNoEnd), 1);
  EXPECT_EQ(index_of({kWaitStep, loop(2), kWaitStep, kEndStep}, kBadLoop), 1);
  EXPECT_EQ(index_of({kWaitStep, loop(2), loop(2), kWaitStep, kEndStep}, kBadLoop), 2);
  EXPECT_EQ(index_of({kWaitStep, kWaitStep, loop_end(0), kEndStep}, kBadLoop), 2);
  EXPECT_EQ(index_of({kWaitStep, jump(9), kEndStep}, kBadJump), 1);
  EXPECT_EQ(index_of({kWaitStep, jump(1), kEndStep}, kTakesNoTime), 1);
  EXPECT_EQ(index_of({kWaitStep, test, kEndStep}, kBadTest), 1);
  EXPECT_EQ(index_of({kWaitStep, Condition{}.branch(4), kWaitStep, kEndStep, kEndStep}, kBadTest), 2);
  EXPECT_EQ(index_of({kWaitStep, {kCall, 0}, kEndStep}, kBadRoutine), 1);
  EXPECT_EQ(index_of({kWaitStep, {kReturn}, kEndStep}, kBadRoutine), 1);
  EXPECT_EQ(index_of({kWaitStep, {kCall, 3}, kEndStep, kWaitStep, kWaitStep}, kBadRoutine), 4);
}

TEST_F(MotionTest, RefusesBadSteps) {
  for (const int beyond : {1, 2, 100}) {
    const auto opcode = static_cast<Opcode>(static_cast<int>(kLastOpcode) + beyond);
    EXPECT_EQ(of_steps({{opcode, 0, 0}, kEndStep}), kBadOpcode) << beyond;
  }
  EXPECT_EQ(of_steps({{kEnd, 1, 0}}), kBadOpcode);
  EXPECT_EQ(of_steps({{kEnd, 0, 1}}), kBadOpcode);
  EXPECT_EQ(of_steps({{kMove, 2, 10'000}, kEndStep}), kNoSuchPose);
  EXPECT_EQ(of_steps({{kMove, 0, kMinStepTime_us - 1}, kEndStep}), kBadStepTime);
  EXPECT_EQ(of_steps({{kWait, 0, kMaxStepTime_us + 1}, kEndStep}), kBadStepTime);
  EXPECT_EQ(of_steps({kMoveStep}), kNoEnd);
}

TEST_F(MotionTest, RejectsAnAttitudeThatIsNoUnitVector) {
  const auto expect = [](std::int8_t x, std::int8_t y, std::int8_t z) {
    return ExpectedAttitude{.up_B = {x, y, z}, .min_cosine = 20'000}.step();
  };
  EXPECT_EQ(of_steps({expect(0, 0, 127), kEndStep}), kOk);
  EXPECT_EQ(of_steps({expect(-127, 0, 0), kEndStep}), kOk);
  EXPECT_EQ(of_steps({expect(73, -73, 73), kEndStep}), kOk);
  EXPECT_EQ(of_steps({expect(0, 0, 0), kEndStep}), kBadAttitude);
  EXPECT_EQ(of_steps({expect(0, 50, 0), kEndStep}), kBadAttitude);
  EXPECT_EQ(of_steps({expect(127, 127, 127), kEndStep}), kBadAttitude);
  EXPECT_EQ(of_steps({{kExpect, 0, 0x0100'007F}, kEndStep}), kBadAttitude);
}

TEST_F(MotionTest, RejectsImproperlyNestedLoops) {
  EXPECT_EQ(of_steps({loop(2), kWaitStep, kEndStep}), kBadLoop);
  EXPECT_EQ(of_steps({kWaitStep, loop_end(0), kEndStep}), kBadLoop);
  EXPECT_EQ(of_steps({loop(2), loop(2), kWaitStep, loop_end(0), loop_end(1), kEndStep}), kBadLoop);
  EXPECT_EQ(of_steps({loop(2), loop(2), kWaitStep, loop_end(1), loop_end(0), kEndStep}), kOk);
  std::vector<Step> deep(kMaxStackDepth + 1, loop(1));
  deep.push_back(kWaitStep);
  for (std::uint16_t depth = kMaxStackDepth + 1; depth > 0; --depth) {
    deep.push_back(loop_end(static_cast<std::uint16_t>(depth - 1)));
  }
  deep.push_back(kEndStep);
  EXPECT_EQ(of_steps(deep), kBadLoop);
}

TEST_F(MotionTest, RefusesJumpsAcrossLoops) {
  EXPECT_EQ(of_steps({jump(2), kWaitStep, kEndStep}), kOk);
  EXPECT_EQ(of_steps({kWaitStep, jump(0), kEndStep}), kOk);
  EXPECT_EQ(of_steps({jump(9), kWaitStep, kEndStep}), kBadJump);
  EXPECT_EQ(of_steps({jump(2), loop(2), kWaitStep, loop_end(1), kEndStep}), kBadJump);  // into a loop
  EXPECT_EQ(of_steps({loop(2), kWaitStep, jump(4), loop_end(0), kEndStep}), kBadJump);  // out of a loop
  EXPECT_EQ(of_steps({loop(2), kWaitStep, loop_end(0), jump(1), kEndStep}), kBadJump);  // backwards into a
                                                                                        // loop
  EXPECT_EQ(of_steps({loop(2), kWaitStep, loop_end(0), jump(2), kEndStep}), kBadJump);  // backwards to the
                                                                                        // loop's end
  EXPECT_EQ(of_steps({loop(2), kWaitStep, jump(3), loop_end(0), kEndStep}), kOk);       // within the loop to
                                                                                        // its end
  EXPECT_EQ(of_steps({loop(2), kWaitStep, loop_end(0), jump(0), kEndStep}), kOk);       // backwards over the
                                                                                        // whole loop
}

// The time to check jumps grows with their distances.
TEST_F(MotionTest, BoundsTheDistancesOfAllJumpsInSum) {
  std::vector<Step> far(kMaxSteps, jump(kMaxSteps - 1));
  far.back() = kEndStep;
  EXPECT_EQ(of_steps(far), kBadJump);
  for (std::uint16_t i = 0; i + 1u < far.size(); ++i) far[i] = jump(static_cast<std::uint16_t>(i + 1));
  EXPECT_EQ(of_steps(far), kOk);
}

// 64 times the steps of the longest motion, and one more.
TEST_F(MotionTest, AcceptsTheLargestSumOfDistances) {
  std::vector<Step> steps(kMaxSteps, kWaitStep);
  steps[0] = jump(kMaxSteps - 1);
  steps.back() = kEndStep;
  std::size_t sum = kMaxSteps - 1;
  for (std::uint16_t i = 1; sum < 64 * kMaxSteps; ++i) {
    const std::size_t distance = std::min<std::size_t>(kMaxSteps - 1u - i, 64 * kMaxSteps - sum);
    steps[i] = jump(static_cast<std::uint16_t>(i + distance));
    sum += distance;
  }
  EXPECT_EQ(of_steps(steps), kOk);
  steps[kMaxSteps - 2] = jump(kMaxSteps - 1);
  EXPECT_EQ(of_steps(steps), kBadJump);
}

TEST_F(MotionTest, RejectsCyclesOfZeroDuration) {
  EXPECT_EQ(of_steps({loop(2), loop_end(0), kEndStep}), kTakesNoTime);
  EXPECT_EQ(of_steps({jump(0), kEndStep}), kTakesNoTime);
  EXPECT_EQ(of_steps({jump(1), jump(0), kEndStep}), kTakesNoTime);
  EXPECT_EQ(of_steps({loop(0), loop(2), loop_end(1), kWaitStep, loop_end(0), kEndStep}), kTakesNoTime);
  // A jump that skips all timed steps of a loop.
  EXPECT_EQ(of_steps({loop(0), jump(3), kWaitStep, loop_end(0), kEndStep}), kTakesNoTime);
  EXPECT_EQ(of_steps({kWaitStep, jump(3), kWaitStep, jump(1), kEndStep}), kTakesNoTime);
  EXPECT_EQ(of_steps({loop(0), loop(2), kWaitStep, loop_end(1), loop_end(0), kEndStep}), kOk);
}

// Each way on from a step must come to an end or take time: of a branch, of an await, of a loop and of a
// call.
TEST_F(MotionTest, RejectsACycleOfZeroDurationOnEitherWayOfABranch) {
  const Step test = motion::Test{{Source::kTime}, Comparison::kGreater, false, 5}.step();
  const Step branch_back = Condition{}.branch(0);
  EXPECT_EQ(of_steps({branch_back, test, kEndStep}), kTakesNoTime);  // only the other way ends
  EXPECT_EQ(of_steps({Condition{}.branch(3), test, jump(0), kEndStep}), kTakesNoTime);  // only this way ends
  EXPECT_EQ(of_steps({Condition{}.branch(3), test, kEndStep, jump(3)}), kTakesNoTime);
  EXPECT_EQ(of_steps({kWaitStep, branch_back, test, kEndStep}), kOk);
  EXPECT_EQ(of_steps({Condition{}.branch(4), test, kWaitStep, jump(0), kEndStep}), kOk);
  EXPECT_EQ(of_steps({Condition{}.await(kNoStep, 30'000), test, jump(0), kEndStep}), kTakesNoTime);
  EXPECT_EQ(of_steps({Condition{}.await(0, 30'000), test, kEndStep}), kOk);  // its time-out takes time
  EXPECT_EQ(of_steps({{kCall, 3}, jump(0), kEndStep, {kReturn}}), kTakesNoTime);
  EXPECT_EQ(of_steps({{kCall, 3}, jump(0), kEndStep, kWaitStep, {kReturn}}), kOk);
}

// The steps that lead to the cycle are not to blame.
TEST_F(MotionTest, NamesTheFirstStepOfTheCycleOfZeroDuration) {
  const auto place_of = [&](const std::vector<Step>& steps) {
    const MotionVerdict verdict = verdict_of(steps);
    EXPECT_EQ(verdict.status, kTakesNoTime);
    return verdict.index;
  };
  const Step set = Assignment{}.step();
  const Step test = motion::Test{{Source::kTime}, Comparison::kGreater, false, 5}.step();
  EXPECT_EQ(place_of({jump(0), kEndStep}), 0);
  EXPECT_EQ(place_of({set, set, jump(2), kEndStep}), 2);
  EXPECT_EQ(place_of({set, kWaitStep, set, jump(4), set, jump(4), kEndStep}), 4);
  EXPECT_EQ(place_of({jump(3), set, jump(1), set, jump(1), kEndStep}), 1);
  EXPECT_EQ(place_of({set, loop(2), loop_end(1), kEndStep}), 1);
  EXPECT_EQ(place_of({set, loop(0), set, set, loop_end(1), kEndStep}), 1);
  EXPECT_EQ(place_of({loop(0), set, loop(2), set, loop_end(2), kWaitStep, loop_end(0), kEndStep}), 2);
  EXPECT_EQ(place_of({set, Condition{}.branch(5), test, kWaitStep, kEndStep, set, jump(5)}), 5);
  EXPECT_EQ(place_of({set, Condition{}.branch(4), test, jump(1), kWaitStep, kEndStep}), 1);
  EXPECT_EQ(place_of({set, Condition{}.await(kNoStep, 30'000), test, jump(1), kEndStep}), 1);
  EXPECT_EQ(place_of({set, {kCall, 6}, set, {kCall, 6}, jump(3), kEndStep, set, {kReturn}}), 3);
  EXPECT_EQ(place_of({set, {kCall, 3}, kEndStep, set, jump(4), {kReturn}}), 4);
}

}  // namespace
}  // namespace koboshi::motion
