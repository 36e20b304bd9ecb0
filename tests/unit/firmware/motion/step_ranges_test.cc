// The validator accepts the ends of each field's range (docs/reference/motion-language.md) and nothing
// beyond.

#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <vector>

#include "firmware/motion/instructions.h"
#include "firmware/motion/motion.h"
#include "tests/unit/firmware/motion/motion_builder.h"

namespace koboshi::motion {
namespace {

using enum Opcode;
using enum MotionStatus;
using test::MotionBuilder;

constexpr std::uint16_t kJointCount = 20;
constexpr std::uint16_t kVariableCount = 3;
constexpr std::uint16_t kPoseCount = 2;

class StepRanges : public testing::Test {
 protected:
  MotionBuilder builder() const {
    MotionBuilder builder(model_);
    builder.variable_count = kVariableCount;
    return builder.pose(3, 60).pose(18, 30);
  }
  MotionStatus status(const MotionBuilder& builder) const {
    Motion motion;
    return Motion::open(builder.image(), model_, motion).status;
  }
  MotionStatus of(const std::vector<Step>& steps) const {
    MotionBuilder with_steps = builder();
    with_steps.steps = steps;
    with_steps.step(kEnd);
    return status(with_steps);
  }
  MotionStatus of(const Step& step) const { return of(std::vector{step}); }
  // The status of a condition with one test.
  MotionStatus of_test(const Step& test) const { return of({Condition{}.branch(2), test}); }
  MotionStatus of_source(Source source, unsigned index) const {
    const SourceRef ref{source, static_cast<std::uint8_t>(index)};
    const MotionStatus tested = of_test(motion::Test{.left = ref}.step());
    const Assignment assignment{.from_source = true, .right = ref.packed()};
    EXPECT_EQ(of(assignment.step()), tested);
    return tested;
  }
  // The step with these bits of its mode set.
  static Step with_mode(Step step, unsigned mode) {
    step.mode = static_cast<std::uint8_t>(step.mode | mode);
    return step;
  }

  const robot::RobotModel model_ = test::load_test_robot();
};

constexpr motion::Test kTimeTest{.left = {Source::kTime}, .comparison = Comparison::kGreater, .right = 5};

TEST_F(StepRanges, OfMoves) {
  const auto of_move = [this](const Move& move) { return of(move.step()); };
  EXPECT_EQ(of_move({.interpolation = kLastInterpolation, .value = kMinStepTime_us}), kOk);
  EXPECT_EQ(of_move({.value = kMinStepTime_us - 1}), kBadStepTime);
  EXPECT_EQ(of_move({.value = kMaxStepTime_us}), kOk);
  EXPECT_EQ(of_move({.value = kMaxStepTime_us + 1}), kBadStepTime);
  EXPECT_EQ(of_move({.by_speed = true, .value = 0}), kBadStepTime);
  EXPECT_EQ(of_move({.by_speed = true, .value = 1}), kOk);
  EXPECT_EQ(of_move({.by_speed = true, .value = kMaxStepTime_us + 1}), kOk);
  EXPECT_EQ(of_move({.pose = kPoseCount - 1, .value = kMinStepTime_us}), kOk);
  EXPECT_EQ(of_move({.pose = kPoseCount, .value = kMinStepTime_us}), kNoSuchPose);
  EXPECT_EQ(of(with_mode(Move{.value = kMinStepTime_us}.step(), 128)), kBadOpcode);
  EXPECT_EQ(of_move({.value = kMinStepTime_us, .at_least = true}), kOk);
  EXPECT_EQ(of_move({.value = kMinStepTime_us - 1, .at_least = true}), kBadStepTime);
  EXPECT_EQ(of_move({.by_speed = true, .value = kMinStepTime_us, .at_least = true}), kBadOpcode);
  EXPECT_EQ(of_move({.interpolation = Interpolation::kCubic, .value = kMinStepTime_us, .at_least = true}),
            kBadOpcode);
  EXPECT_EQ(of_move({.interpolation = Interpolation::kTrapezoid, .value = kMinStepTime_us, .at_least = true}),
            kOk);
}

// An image of version 2 plays as before; what version 3 added it has not. Others are refused by their
// version.
TEST_F(StepRanges, OfTheVersionOfTheImage) {
  const auto of_version = [this](unsigned version, const Move& move) {
    MotionBuilder builder(model_);
    builder.pose(3, 10).version = static_cast<std::uint16_t>(version);
    const std::vector<std::byte> image = builder.step(move.step()).step(kEnd).image();
    Motion opened;
    const MotionStatus status = Motion::open(image, model_, opened).status;
    EXPECT_EQ(opened.version(), status == kOk ? version : 0u);
    if (status == kOk) {
      EXPECT_EQ(Motion::reopen(image, opened.findings()).version(), version);
    }
    return status;
  };
  const Move plain{.interpolation = Interpolation::kCubic, .value = kMinStepTime_us};
  const Move least{.value = kMinStepTime_us, .at_least = true};
  const Move trapezoid{.interpolation = Interpolation::kTrapezoid, .value = kMinStepTime_us};
  EXPECT_EQ(of_version(2, plain), kOk);
  EXPECT_EQ(of_version(2, least), kBadOpcode);
  EXPECT_EQ(of_version(2, trapezoid), kBadOpcode);
  EXPECT_EQ(of_version(3, plain), kOk);
  EXPECT_EQ(of_version(3, least), kOk);
  EXPECT_EQ(of_version(3, trapezoid), kOk);
  for (const unsigned version : {0u, 1u, 5u, 258u})
    EXPECT_EQ(of_version(version, plain), MotionStatus::kBadVersion);
}

TEST_F(StepRanges, OfWaits) {
  EXPECT_EQ(of(Step{kWait, 0, kMinStepTime_us}), kOk);
  EXPECT_EQ(of(Step{kWait, 0, kMinStepTime_us - 1}), kBadStepTime);
  EXPECT_EQ(of(Step{kWait, 0, kMaxStepTime_us}), kOk);
  EXPECT_EQ(of(Step{kWait, 0, kMaxStepTime_us + 1}), kBadStepTime);
  EXPECT_EQ(of(Step{kWait, 1, kMinStepTime_us}), kBadOpcode);
  EXPECT_EQ(of(with_mode({kWait, 0, kMinStepTime_us}, 1)), kBadOpcode);
}

// Fields that an opcode does not use are zero.
TEST_F(StepRanges, OfUnusedFields) {
  for (const Opcode opcode : {kFail, kMixClear}) {
    EXPECT_EQ(of(Step{opcode, 0, 0}), kOk);
    EXPECT_EQ(of(Step{opcode, 1, 0}), kBadOpcode);
    EXPECT_EQ(of(Step{opcode, 0, 1}), kBadOpcode);
    EXPECT_EQ(of(Step{opcode, 0, 0, 1}), kBadOpcode);
  }
  const Step wait{kWait, 0, kMinStepTime_us};
  for (const Step& unused : {Step{.value = 1}, Step{.mode = 1}}) {
    EXPECT_EQ(of({{kLoopBegin, 2, unused.value, unused.mode}, wait, {kLoopEnd, 0}}), kBadOpcode);
    EXPECT_EQ(of({{kLoopBegin, 2}, wait, {kLoopEnd, 0, unused.value, unused.mode}}), kBadOpcode);
    EXPECT_EQ(of(Step{kJump, 1, unused.value, unused.mode}), kBadOpcode);
    EXPECT_EQ(of(Step{kCall, 1, unused.value, unused.mode}), kBadOpcode);
  }
  EXPECT_EQ(of({Condition{}.branch(2), kTimeTest.step()}), kOk);
  EXPECT_EQ(of({{kBranch, 2, 1, Condition{}.mode()}, kTimeTest.step()}), kBadOpcode);
}

TEST_F(StepRanges, OfConditions) {
  const auto of_count = [this](std::size_t count) {
    std::vector<Step> steps{Condition{.count = static_cast<std::uint8_t>(count)}.branch(1)};
    steps[0].operand = static_cast<std::uint16_t>(count + 1);
    steps.insert(steps.end(), count, kTimeTest.step());
    return of(steps);
  };
  EXPECT_EQ(of_count(0), kBadTest);
  EXPECT_EQ(of_count(1), kOk);
  EXPECT_EQ(of_count(kMaxTests), kOk);
  EXPECT_EQ(of_count(kMaxTests + 1), kBadTest);
  const auto of_await = [this](std::uint32_t timeout_us) {
    return of({Condition{}.await(kNoStep, timeout_us), kTimeTest.step()});
  };
  EXPECT_EQ(of_await(kMinStepTime_us - 1), kBadStepTime);
  EXPECT_EQ(of_await(kMinStepTime_us), kOk);
  EXPECT_EQ(of_await(kMaxStepTime_us), kOk);
  EXPECT_EQ(of_await(kMaxStepTime_us + 1), kBadStepTime);
  EXPECT_EQ(of({with_mode(Condition{.any = true, .negated = true}.branch(2), 64), kTimeTest.step()}),
            kBadOpcode);
  EXPECT_EQ(of({Condition{}.branch(2), kTimeTest.step(), kTimeTest.step()}), kBadTest);  // one too many
}

TEST_F(StepRanges, OfTests) {
  EXPECT_EQ(of_test(motion::Test{.left = {Source::kTime}, .comparison = kLastComparison}.step()), kOk);
  EXPECT_EQ(of_test(motion::Test{.left = {Source::kTime}, .comparison = static_cast<Comparison>(6)}.step()),
            kBadOpcode);
  EXPECT_EQ(of_test(with_mode(kTimeTest.step(), 8)), kBadOpcode);
  motion::Test with_variable{.left = {Source::kTime}, .with_variable = true, .right = kVariableCount - 1};
  EXPECT_EQ(of_test(with_variable.step()), kOk);
  with_variable.right = kVariableCount;
  EXPECT_EQ(of_test(with_variable.step()), kBadSource);
}

TEST_F(StepRanges, OfSources) {
  EXPECT_EQ(of_source(Source::kVariable, kVariableCount - 1), kOk);
  EXPECT_EQ(of_source(Source::kVariable, kVariableCount), kBadSource);
  for (const Source source : {Source::kJointAngle, Source::kJointError, Source::kJointTorque}) {
    EXPECT_EQ(of_source(source, kJointCount - 1), kOk);
    EXPECT_EQ(of_source(source, kJointCount), kBadSource);
  }
  EXPECT_EQ(of_source(Source::kInput, kInputCount - 1), kOk);
  EXPECT_EQ(of_source(Source::kInput, kInputCount), kBadSource);
  for (const Source source : {Source::kRoll, Source::kZmpValid, Source::kSupply, kLastSource}) {
    EXPECT_EQ(of_source(source, 0), kOk);
    EXPECT_EQ(of_source(source, 1), kBadSource);
  }
  EXPECT_EQ(of_source(static_cast<Source>(static_cast<int>(kLastSource) + 1), 0), kBadSource);
}

TEST_F(StepRanges, OfAssignments) {
  EXPECT_EQ(of(Assignment{.variable = kVariableCount - 1, .right = -1}.step()), kOk);
  EXPECT_EQ(of(Assignment{.variable = kVariableCount}.step()), kBadSource);
  EXPECT_EQ(of(Assignment{.operation = Arithmetic::kMaximum}.step()), kOk);
  EXPECT_EQ(of(with_mode(Assignment{}.step(), 8)), kBadOpcode);
  const std::int32_t time = SourceRef{Source::kTime}.packed();
  EXPECT_EQ(of(Assignment{.from_source = true, .right = time}.step()), kOk);
  EXPECT_EQ(of(Assignment{.from_source = true, .right = time | 1 << 16}.step()), kBadSource);
}

TEST_F(StepRanges, OfMixes) {
  const Mix mix{.source = kLastMixSource, .joint = kJointCount - 1, .gain = 1};
  const auto with_limit = [mix](std::int16_t gain, std::uint16_t limit) {
    Mix changed = mix;
    changed.gain = gain;
    changed.limit = limit;
    return changed.step();
  };
  EXPECT_EQ(of(with_limit(1, Mix::kMinLimit)), kOk);
  EXPECT_EQ(of(with_limit(1, Mix::kMinLimit - 1)), kBadJoint);
  EXPECT_EQ(of(with_limit(1, Mix::kMaxLimit)), kOk);
  EXPECT_EQ(of(with_limit(1, Mix::kMaxLimit + 1)), kBadJoint);
  EXPECT_EQ(of(with_limit(0, 0)), kOk);
  EXPECT_EQ(of(with_limit(1, 0)), kBadJoint);
  EXPECT_EQ(of(with_limit(0, 1)), kBadJoint);
  Step step = mix.step();
  step.operand = kJointCount;
  EXPECT_EQ(of(step), kBadJoint);
  step = mix.step();
  ++step.mode;
  EXPECT_EQ(of(step), kBadOpcode);
}

TEST_F(StepRanges, OfStiffness) {
  EXPECT_EQ(of(Stiffness{.percent = 0, .joints = 1u << (kJointCount - 1)}.step()), kOk);
  EXPECT_EQ(of(Stiffness{.percent = 100, .joints = 1}.step()), kOk);
  EXPECT_EQ(of(Stiffness{.percent = 101, .joints = 1}.step()), kBadJoint);
  EXPECT_EQ(of(Stiffness{.percent = 100, .joints = 0}.step()), kBadJoint);
  EXPECT_EQ(of(Stiffness{.percent = 100, .joints = 1u << kJointCount}.step()), kBadJoint);
  Step step = Stiffness{.joints = 1}.step();
  step.operand = 1;
  EXPECT_EQ(of(step), kBadOpcode);
}

TEST_F(StepRanges, OfGains) {
  EXPECT_EQ(of(Gain{.percent = 1, .joints = 1u << (kJointCount - 1)}.step()), kOk);
  EXPECT_EQ(of(Gain{.percent = 200, .joints = 1}.step()), kOk);
  EXPECT_EQ(of(Gain{.percent = 0, .joints = 1}.step()), kBadJoint);
  EXPECT_EQ(of(Gain{.percent = 201, .joints = 1}.step()), kBadJoint);
  EXPECT_EQ(of(Gain{.percent = 100, .joints = 0}.step()), kBadJoint);
  EXPECT_EQ(of(Gain{.percent = 100, .joints = 1u << kJointCount}.step()), kBadJoint);
  Step step = Gain{.joints = 1}.step();
  step.operand = 1;
  EXPECT_EQ(of(step), kBadOpcode);
}

TEST_F(StepRanges, GainsAndWindowsBeginWithVersion4) {
  for (const std::uint16_t version : {std::uint16_t{2}, std::uint16_t{3}, std::uint16_t{4}}) {
    const auto status_of = [&](const std::vector<Step>& steps) {
      MotionBuilder builder(model_);
      builder.pose(3, 10).version = version;
      for (const Step& step : steps) builder.step(step);
      Motion opened;
      return Motion::open(builder.step(kEnd).image(), model_, opened).status;
    };
    const MotionStatus expected = version < 4 ? kBadOpcode : kOk;
    EXPECT_EQ(status_of({Gain{.joints = 1}.step(), {kMove, 0, 10'000}}), expected) << version;
    EXPECT_EQ(status_of({Move{.value = 10'000, .windows = 1}.step(), Window{.joints = 1}.step()}), expected);
  }
}

TEST_F(StepRanges, OfWindows) {
  const auto of_windows = [this](const Move& move, const std::vector<Step>& windows) {
    MotionBuilder builder(model_);
    builder.pose(3, 10).step(move.step());
    for (const Step& window : windows) builder.step(window);
    Motion opened;
    return Motion::open(builder.step(kEnd).image(), model_, opened).status;
  };
  const Move one{.value = 10'000, .windows = 1};
  const Step good = Window{.start = 1, .end = 2, .joints = 1u << (kJointCount - 1)}.step();
  EXPECT_EQ(of_windows(one, {good}), kOk);
  EXPECT_EQ(of_windows(one, {Window{.start = 2, .end = 2, .joints = 1}.step()}), kBadStepTime);
  EXPECT_EQ(of_windows(one, {Window{.joints = 0}.step()}), kBadJoint);
  EXPECT_EQ(of_windows(one, {Window{.joints = 1u << kJointCount}.step()}), kBadJoint);
  EXPECT_EQ(of_windows(one, {}), kBadTest) << "a window is missing";
  EXPECT_EQ(of_windows(one, {good, good}), kBadTest) << "one too many";
  EXPECT_EQ(of_windows(one, {motion::Test{{Source::kTime}}.step()}), kBadTest) << "a test is no window";
  Move move{.value = 10'000, .windows = Move::kMaxWindows};
  EXPECT_EQ(of_windows(move, {good, good, good, good}), kOk);
  ++move.windows;
  EXPECT_EQ(of_windows(move, {good, good, good, good, good}), kBadTest);
  Move other = one;
  other.interpolation = Interpolation::kCubic;
  EXPECT_EQ(of_windows(other, {good}), kBadOpcode);
  other = one;
  other.at_least = true;
  EXPECT_EQ(of_windows(other, {good}), kBadOpcode);
  other = one;
  other.by_speed = true;
  EXPECT_EQ(of_windows(other, {good}), kBadOpcode);
}

// A condition cannot have a window for a test, and nothing leads to a window.
TEST_F(StepRanges, OfWayToWindows) {
  const auto status_of = [this](const std::vector<Step>& steps) {
    MotionBuilder builder(model_);
    builder.pose(3, 10);
    for (const Step& step : steps) builder.step(step);
    Motion opened;
    return Motion::open(builder.step(kEnd).image(), model_, opened).status;
  };
  const Step move = Move{.value = 10'000, .windows = 1}.step();
  const Step window = Window{.joints = 1}.step();
  EXPECT_EQ(status_of({move, window, {kJump, 0}}), kOk);
  EXPECT_EQ(status_of({move, window, {kJump, 1}}), kBadJump);
  EXPECT_EQ(status_of({Condition{}.branch(2), window, move, window}), kBadTest);
}

TEST_F(StepRanges, OfLeans) {
  EXPECT_EQ(of(LeanDeclaration{.pitch = -1, .roll = -1}.step()), kOk);
  EXPECT_EQ(of(with_mode(LeanDeclaration{}.step(), 1)), kBadOpcode);
  Step step = LeanDeclaration{}.step();
  step.value = 1u << 16;
  EXPECT_EQ(of(step), kBadOpcode);
}

// The squares of the length are 100^2 to 154^2.
TEST_F(StepRanges, OfAttitudes) {
  const auto of_up = [this](std::int8_t x, std::int8_t y, std::int8_t z) {
    return of(ExpectedAttitude{.up_B = {x, y, z}}.step());
  };
  EXPECT_EQ(of_up(100, 0, 0), kOk);
  EXPECT_EQ(of_up(0, -98, 19), kBadAttitude);    // 9965
  EXPECT_EQ(of_up(99, 14, 1), kBadAttitude);     // 9998
  EXPECT_EQ(of_up(126, 84, 28), kOk);            // 23716
  EXPECT_EQ(of_up(126, -79, 40), kBadAttitude);  // 23717
  EXPECT_EQ(of(with_mode(ExpectedAttitude{.up_B = {0, 0, 127}}.step(), 1)), kBadAttitude);
}

TEST_F(StepRanges, OfExits) {
  const auto of_exit = [this](int exit) {
    MotionBuilder exits = builder();
    exits.step(kWait, 0, kMinStepTime_us).step(Condition{}.branch(3)).step(kTimeTest.step());
    exits.step(kWait, 0, kMinStepTime_us).step(kLoopBegin, 2).step(kWait, 0, kMinStepTime_us);
    exits.step(kLoopEnd, 4).step(kCall, 9).step(kEnd).step(kReturn);
    exits.exit_step = static_cast<std::uint16_t>(exit);
    return status(exits);
  };
  for (const int good : {0, 1, 3, 4, 7, 8}) EXPECT_EQ(of_exit(good), kOk) << good;
  for (const int bad : {2, 5, 6, 9, 10}) EXPECT_EQ(of_exit(bad), kBadExit) << bad;
}

TEST_F(StepRanges, OfTargets) {
  const auto of_await = [this](std::uint16_t target) {
    return of({Condition{}.await(target, kMinStepTime_us), kTimeTest.step()});
  };
  EXPECT_EQ(of_await(kNoStep), kOk);  // the time-out fails the motion
  EXPECT_EQ(of_await(2), kOk);
  EXPECT_EQ(of_await(1), kBadJump);  // a test
  EXPECT_EQ(of_await(3), kBadJump);  // past the end
  EXPECT_EQ(of({Condition{}.branch(kNoStep), kTimeTest.step()}), kBadJump);
  EXPECT_EQ(of(Step{kJump, kNoStep}), kBadJump);
}

// The index of a bad exit is the exit itself, or 0 if there is no such step.
TEST_F(StepRanges, ReportTheExit) {
  for (const std::uint16_t exit : {std::uint16_t{2}, std::uint16_t{9}}) {
    MotionBuilder exits = builder();
    exits.step(kWait, 0, kMinStepTime_us).step(kLoopBegin, 2).step(kWait, 0, kMinStepTime_us);
    exits.step(kLoopEnd, 1).step(kEnd);
    exits.exit_step = exit;
    Motion motion;
    const std::vector<std::byte> image = exits.image();
    const MotionVerdict verdict = Motion::open(image, model_, motion);
    EXPECT_EQ(verdict.status, kBadExit);
    EXPECT_EQ(verdict.index, exit == 2 ? 2 : 0);
  }
}

TEST_F(StepRanges, OfNames) {
  const auto named = [this](const std::string& name) {
    MotionBuilder builder = this->builder().step(kEnd);
    builder.name = name;
    return status(builder);
  };
  EXPECT_EQ(named(" ~"), kOk);
  EXPECT_EQ(named("\x1F"), kBadName);
  EXPECT_EQ(named("\x7F"), kBadName);
  EXPECT_EQ(named(std::string(kNameSize, 'n')), kOk);
}

TEST_F(StepRanges, OfCounts) {
  EXPECT_EQ(status(MotionBuilder(model_)), kBadCount);  // the smallest image that has all counts
  MotionBuilder variables = builder().step(kEnd);
  variables.variable_count = kMaxVariables;
  EXPECT_EQ(status(variables), kOk);
  ++variables.variable_count;
  EXPECT_EQ(status(variables), kBadCount);
  MotionBuilder poses(model_);
  poses.step(kEnd);
  poses.groups = {{1u << 3, std::vector<std::vector<std::int32_t>>(kMaxPoses, {100})}};
  EXPECT_EQ(status(poses), kOk);
  poses.groups[0].poses.push_back({100});
  EXPECT_EQ(status(poses), kBadCount);
}

// Calls of up to kMaxRoutines subroutines, each of which only returns.
TEST_F(StepRanges, OfSubroutines) {
  const auto of_routines = [this](std::uint16_t count) {
    std::vector<Step> steps;
    for (std::uint16_t i = 0; i < count; ++i)
      steps.push_back({kCall, static_cast<std::uint16_t>(count + 1 + i)});
    steps.push_back({kEnd});
    steps.insert(steps.end(), count, Step{kReturn});
    MotionBuilder calls = builder();
    calls.steps = steps;
    return status(calls);
  };
  EXPECT_EQ(of_routines(kMaxRoutines), kOk);
  EXPECT_EQ(of_routines(kMaxRoutines + 1), kBadRoutine);
  EXPECT_EQ(of(Step{kCall, 9}), kBadRoutine);                             // past the end
  EXPECT_EQ(of(Step{kCall, 2}), kBadRoutine);                             // at the end
  EXPECT_EQ(of({{kWait, 0, kMinStepTime_us}, {kCall, 0}}), kBadRoutine);  // backwards
  EXPECT_EQ(of(Step{kCall, 0}), kBadRoutine);                             // itself
  EXPECT_EQ(of(Step{kReturn}), kBadRoutine);                              // from the main program
}

// Each of `count` subroutines calls the next one: the stack holds one return for each.
TEST_F(StepRanges, OfTheStack) {
  const auto of_calls = [this](std::uint16_t loops, std::uint16_t calls) {
    MotionBuilder chain = builder();
    for (std::uint16_t i = 0; i < loops; ++i) chain.step(kLoopBegin, 2);
    chain.step(kWait, 0, kMinStepTime_us);
    const auto first = static_cast<std::uint16_t>(2 * loops + 3);
    chain.step(kCall, first);
    for (std::uint16_t i = loops; i-- > 0;) chain.step(kLoopEnd, i);
    chain.step(kEnd);
    for (std::uint16_t i = 1; i < calls; ++i)
      chain.step(kCall, static_cast<std::uint16_t>(first + 2 * i)).step(kReturn);
    chain.step(kReturn);
    return status(chain);
  };
  EXPECT_EQ(of_calls(0, kMaxStackDepth), kOk);
  EXPECT_EQ(of_calls(0, kMaxStackDepth + 1), kTooDeep);
  EXPECT_EQ(of_calls(3, kMaxStackDepth - 3), kOk);
  EXPECT_EQ(of_calls(3, kMaxStackDepth - 2), kTooDeep);
  EXPECT_EQ(of_calls(kMaxStackDepth, 1), kTooDeep);
}

// The loops of a subroutine are on the stack together with those of its caller.
TEST_F(StepRanges, OfTheStackInASubroutine) {
  const auto of_loops = [this](std::uint16_t loops) {
    MotionBuilder chain = builder();
    chain.step(kCall, 2).step(kEnd);
    for (std::uint16_t i = 0; i < loops; ++i) chain.step(kLoopBegin, 2);
    chain.step(kWait, 0, kMinStepTime_us);
    for (std::uint16_t i = loops; i-- > 0;) chain.step(kLoopEnd, static_cast<std::uint16_t>(2 + i));
    chain.step(kReturn);
    return status(chain);
  };
  EXPECT_EQ(of_loops(kMaxStackDepth - 1), kOk);
  EXPECT_EQ(of_loops(kMaxStackDepth), kTooDeep);
}

// A subroutine whose steps all lead to its return takes no time, whatever kind of step it has.
TEST_F(StepRanges, OfTimeInSubroutines) {
  const auto of_routine = [this](const std::vector<Step>& routine) {
    MotionBuilder calls = builder();
    calls.steps = {{kCall, 3}, {kJump, 0}, {kEnd}};
    calls.steps.insert(calls.steps.end(), routine.begin(), routine.end());
    return status(calls);
  };
  EXPECT_EQ(of_routine({{kJump, 4}, {kReturn}}), kTakesNoTime);
  EXPECT_EQ(of_routine({{kMixClear}, {kReturn}}), kTakesNoTime);
  EXPECT_EQ(of_routine({Condition{}.branch(6), kTimeTest.step(), {kWait, 0, kMinStepTime_us}, {kReturn}}),
            kTakesNoTime);
  EXPECT_EQ(of_routine({{kWait, 0, kMinStepTime_us}, {kReturn}}), kOk);
  EXPECT_EQ(of_routine({{kFail}, {kReturn}}), kOk);
}

}  // namespace
}  // namespace koboshi::motion
