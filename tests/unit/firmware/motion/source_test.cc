// Each measurement that a motion can read.

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <span>

#include "tests/unit/firmware/motion/interpreter_fixture.h"

namespace koboshi::motion {
namespace {

using enum Opcode;
using test::degrees;
using test::MotionBuilder;

class SourceTest : public InterpreterTest {
 protected:
  // The number that a program reads into a variable, after a wait: the first steps are executed by the start.
  std::int32_t read(const Inputs& inputs, Source source, std::uint8_t index = 0) {
    const Assignment assignment{.from_source = true, .right = SourceRef{source, index}.packed()};
    MotionBuilder builder(model_);
    builder.variable_count = 1;
    start(builder.step(kWait, 0, kTick_us).step(assignment.step()).step(kEnd));
    interpreter_.advance(kTick_us, inputs);
    return interpreter_.variables()[0];
  }
  std::int32_t read(Source source, std::uint8_t index = 0) { return read(inputs_, source, index); }
};

// Each source reads the measurement of its own, in the unit of instructions.h; an index beyond what was
// measured reads as 0.
TEST_F(SourceTest, ReadsEachSource) {
  state_.roll = degrees(10);
  state_.pitch = degrees(-20);
  const auto rate = [](std::int32_t turns) { return fixed::AngularRate::from_raw(turns * (1 << 24)); };
  state_.rates_B = {rate(1), rate(-2), rate(3)};
  state_.feet[0].contact = true;
  state_.feet[0].load = fixed::Force::from_raw(5 << fixed::Force::kFractionBits);
  state_.feet[1].load = fixed::Force::from_raw(7 << fixed::Force::kFractionBits);
  state_.zmp.valid = true;
  state_.zmp.x = fixed::Length::from_raw(1 << (fixed::Length::kFractionBits - 3));
  state_.zmp.y = fixed::Length::from_raw(-(1 << (fixed::Length::kFractionBits - 4)));
  measured_[0] = degrees(45);
  measured_[19] = degrees(90);
  torques_[0] = 11;
  torques_[19] = -12;
  values_[0] = 13;
  values_[kInputCount - 1] = -14;
  inputs_.supply_mV = 11'100;
  EXPECT_NEAR(read(Source::kRoll), 10'000, 1);
  EXPECT_NEAR(read(Source::kPitch), -20'000, 1);
  EXPECT_EQ(read(Source::kRollRate), 360'000);
  EXPECT_EQ(read(Source::kPitchRate), -720'000);
  EXPECT_EQ(read(Source::kYawRate), 1'080'000);
  EXPECT_EQ(read(Source::kLeftContact), 1);
  EXPECT_EQ(read(Source::kRightContact), 0);
  EXPECT_EQ(read(Source::kLeftLoad), 5'000);
  EXPECT_EQ(read(Source::kRightLoad), 7'000);
  EXPECT_EQ(read(Source::kZmpX), 125'000);
  EXPECT_EQ(read(Source::kZmpY), -62'500);
  EXPECT_EQ(read(Source::kZmpValid), 1);
  EXPECT_NEAR(read(Source::kJointAngle, 0), 45'000, 1);
  EXPECT_NEAR(read(Source::kJointAngle, 19), 90'000, 1);
  EXPECT_NEAR(read(Source::kJointError, 19), -90'000, 1);
  EXPECT_EQ(read(Source::kJointTorque, 0), 11);
  EXPECT_EQ(read(Source::kJointTorque, 19), -12);
  EXPECT_EQ(read(Source::kSupply), 11'100);
  EXPECT_EQ(read(Source::kInput, 0), 13);
  EXPECT_EQ(read(Source::kInput, kInputCount - 1), -14);
  EXPECT_EQ(read(Source::kStopping), 0);
  EXPECT_EQ(read(Source::kWalking), 0);
  EXPECT_EQ(read(Source::kTime), 10);  // ms, after the wait
  state_.feet = {};
  state_.feet[1].contact = true;
  state_.zmp.valid = false;
  inputs_.walking = true;
  inputs_.supply_mV = 0xFFFF'FFFF;
  EXPECT_EQ(read(Source::kLeftContact), 0);
  EXPECT_EQ(read(Source::kRightContact), 1);
  EXPECT_EQ(read(Source::kZmpX), 0);
  EXPECT_EQ(read(Source::kZmpY), 0);
  EXPECT_EQ(read(Source::kZmpValid), 0);
  EXPECT_EQ(read(Source::kWalking), 1);
  EXPECT_EQ(read(Source::kSupply), 0x7FFF'FFFF);
}

TEST_F(SourceTest, ReadsZeroBeyondWhatWasMeasured) {
  const estimation::RobotState at_rest;
  const std::array<fixed::Angle, 4> angles{{{}, {}, {}, degrees(45)}};
  const std::array<std::int16_t, 4> numbers{0, 0, 0, 77};
  const Inputs shorter{.robot = at_rest,
                       .angles = std::span(angles).first(3),
                       .torques_permille = std::span(numbers).first(3),
                       .values = std::span(numbers).first(3)};
  for (const Source source : {Source::kJointAngle, Source::kJointTorque, Source::kInput}) {
    EXPECT_EQ(read(shorter, source, 3), 0);
    EXPECT_EQ(read({.robot = at_rest}, source, 0), 0);
  }
  for (const Source source : {Source::kSupply, Source::kWalking})
    EXPECT_EQ(read({.robot = at_rest}, source, 0), 0);
}

}  // namespace
}  // namespace koboshi::motion
