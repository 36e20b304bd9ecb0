// The numbers of docs/reference/motion-language.md.

#include <gtest/gtest.h>

#include <cstdint>

#include "firmware/motion/instructions.h"
#include "firmware/motion/motion.h"

namespace koboshi::motion {
namespace {

using enum Opcode;
using enum MotionStatus;

// Images and the answers of a robot to a transfer carry these numbers (docs/reference/motion-language.md).
TEST(MotionNumbers, AreThoseOfTheFormat) {
  int number = 0;
  for (const Opcode opcode :
       {kEnd, kMove, kWait,   kLoopBegin, kLoopEnd, kJump,     kExpect,    Opcode::kTest, kBranch, kAwait,
        kSet, kCall, kReturn, kFail,      kMix,     kMixClear, kStiffness, kLean,         kGain,   kWindow})
    EXPECT_EQ(static_cast<int>(opcode), number++);
  EXPECT_EQ(static_cast<int>(kLastOpcode) + 1, number);
  number = 0;
  for (const MotionStatus status :
       {kOk,        kTruncated,  kBadMagic, kBadVersion,   kBadSize,     kBadCrc,      kOtherRobot,
        kBadCount,  kBadName,    kBadPose,  kBeyondLimits, kBadOpcode,   kBadStepTime, kNoSuchPose,
        kBadLoop,   kBadJump,    kNoEnd,    kTakesNoTime,  kBadAttitude, kBadGroup,    kBadTest,
        kBadSource, kBadRoutine, kTooDeep,  kBadExit,      kBadJoint})
    EXPECT_EQ(static_cast<int>(status), number++);
  number = 0;
  for (const Source source :
       {Source::kVariable,  Source::kRoll,       Source::kPitch,       Source::kRollRate,
        Source::kPitchRate, Source::kYawRate,    Source::kLeftContact, Source::kRightContact,
        Source::kLeftLoad,  Source::kRightLoad,  Source::kZmpX,        Source::kZmpY,
        Source::kZmpValid,  Source::kJointAngle, Source::kJointError,  Source::kJointTorque,
        Source::kSupply,    Source::kInput,      Source::kStopping,    Source::kWalking,
        Source::kTime})
    EXPECT_EQ(static_cast<int>(source), number++);
  number = 0;
  for (const Comparison comparison :
       {Comparison::kEqual, Comparison::kNotEqual, Comparison::kLess, Comparison::kLessOrEqual,
        Comparison::kGreater, Comparison::kGreaterOrEqual})
    EXPECT_EQ(static_cast<int>(comparison), number++);
  number = 0;
  for (const Arithmetic arithmetic :
       {Arithmetic::kAssign, Arithmetic::kAdd, Arithmetic::kSubtract, Arithmetic::kMultiply,
        Arithmetic::kDivide, Arithmetic::kRemainder, Arithmetic::kMinimum, Arithmetic::kMaximum})
    EXPECT_EQ(static_cast<int>(arithmetic), number++);
  number = 0;
  for (const MixSource source : {MixSource::kRollRate, MixSource::kPitchRate, MixSource::kYawRate,
                                 MixSource::kRoll, MixSource::kPitch})
    EXPECT_EQ(static_cast<int>(source), number++);
  number = 0;
  for (const Interpolation interpolation : {Interpolation::kLinear, Interpolation::kMinimumJerk,
                                            Interpolation::kCubic, Interpolation::kTrapezoid})
    EXPECT_EQ(static_cast<int>(interpolation), number++);
  EXPECT_EQ(kMotionMagic, 0x544F'4D4Bu);
  EXPECT_EQ(kMotionVersion, 4);
  EXPECT_EQ(kOldestMotionVersion, 2);
  EXPECT_EQ(kNameSize, 24u);
  EXPECT_EQ(kMaxVariables, 16u);
  EXPECT_EQ(kMaxPoseGroups, 32u);
  EXPECT_EQ(kMaxPoses, 512u);
  EXPECT_EQ(kMaxSteps, 1024u);
  EXPECT_EQ(kMaxRoutines, 32u);
  EXPECT_EQ(kMaxStackDepth, 8u);
  EXPECT_EQ(kMaxTests, 8u);
  EXPECT_EQ(kNoStep, 0xFFFF);
  EXPECT_EQ(kMinStepTime_us, 1'000u);
  EXPECT_EQ(kMaxStepTime_us, 60'000'000u);
  EXPECT_EQ(kInputCount, 8u);
  EXPECT_EQ(Mix::kMinLimit, 182);
  EXPECT_EQ(Mix::kMaxLimit, 2731);
  EXPECT_EQ(Stiffness::kFull, 100);
  EXPECT_EQ(Gain::kFull, 100);
}

// The fields of each step lie where the format puts them.
TEST(MotionNumbers, OfTheFieldsOfEachStep) {
  const auto expect_step = [](const Step& step, Opcode opcode, unsigned mode, unsigned operand,
                              std::uint32_t value) {
    EXPECT_EQ(step.opcode, opcode);
    EXPECT_EQ(step.mode, mode);
    EXPECT_EQ(step.operand, operand);
    EXPECT_EQ(step.value, value);
  };
  expect_step(Step(), kEnd, 0, 0, 0);
  expect_step(Move().step(), kMove, 0, 0, 0);
  expect_step(Move{Interpolation::kCubic, true, 5, 77}.step(), kMove, 6, 5, 77);
  expect_step(Move{Interpolation::kTrapezoid, false, 5, 77, true}.step(), kMove, 11, 5, 77);
  expect_step(ExpectedAttitude().step(), kExpect, 0, 0, 0);
  expect_step(ExpectedAttitude{{1, -2, 3}, -4}.step(), kExpect, 0, 0xFFFC, 0x0003'FE01);
  expect_step(motion::Test().step(), Opcode::kTest, 0, 0, 0);
  expect_step(motion::Test{{Source::kInput, 7}, Comparison::kGreaterOrEqual, true, -1}.step(), Opcode::kTest,
              0x85, 0x0711, 0xFFFF'FFFF);
  expect_step(Condition().branch(9), kBranch, 1, 9, 0);
  expect_step(Condition{8, true, true}.await(9, 1'000), kAwait, 0x38, 9, 1'000);
  expect_step(Assignment().step(), kSet, 0, 0, 0);
  expect_step(Assignment{3, Arithmetic::kMaximum, true, 0x0711}.step(), kSet, 0x87, 3, 0x0711);
  expect_step(Mix().step(), kMix, 0, 0, 182u << 16);
  expect_step(Mix{MixSource::kPitch, 19, -1, 2731}.step(), kMix, 4, 19, 0x0AAB'FFFF);
  expect_step(Stiffness().step(), kStiffness, 100, 0, 0);
  expect_step(Stiffness{30, 0x80001}.step(), kStiffness, 30, 0, 0x80001);
  expect_step(Move{.pose = 2, .value = 3, .windows = 4}.step(), kMove, 0x40, 2, 3);
  expect_step(Window().step(), kWindow, 0xFF, 0xF000, 0);
  expect_step(Window{0x123, 0x457, 0x80001}.step(), kWindow, 0x45, 0x6123, 0x80001);
  for (const Window window : {Window{0, 1, 1}, Window{4'095, 4'096, 2}, Window{17, 3'000, 1u << 30}}) {
    const Window decoded = Window::of(window.step());
    EXPECT_EQ(decoded.start, window.start);
    EXPECT_EQ(decoded.end, window.end);
    EXPECT_EQ(decoded.joints, window.joints);
  }
  expect_step(Gain().step(), kGain, 100, 0, 0);
  expect_step(Gain{200, 0x80001}.step(), kGain, 200, 0, 0x80001);
  expect_step(LeanDeclaration().step(), kLean, 0, 0, 0);
  expect_step(LeanDeclaration{-1, 2}.step(), kLean, 0, 0xFFFF, 2);
  EXPECT_EQ((LeanDeclaration{-1, 2}.lean()),
            (Lean{fixed::Angle::from_raw(2 << 16), fixed::Angle::from_raw(-(1 << 16))}));
}

}  // namespace
}  // namespace koboshi::motion
