#include <gtest/gtest.h>

#include "tests/support/controller_bench.h"
#include "tests/unit/firmware/motion/motion_builder.h"
#include "tests/unit/firmware/robot/test_robot.h"

namespace koboshi::app {
namespace {

using test::ControllerBench;
using test::degrees;
using test::kHeadTilt;

class ControllerMotion : public testing::Test {
 protected:
  void SetUp() override { ASSERT_TRUE(bench.run_until_standing()); }

  ControllerBench bench;
};

TEST_F(ControllerMotion, PlaysItsTargets) {
  bench.command(Command::kPlay, 1);
  ASSERT_EQ(bench.now().state, State::kMotion);
  EXPECT_EQ(bench.now().motion, 1);
  double highest_rad = 0.0;
  for (int i = 0; i < 40; ++i) {
    bench.run_ms(10);
    highest_rad = std::max(highest_rad, fixed::to_double(bench.target(kHeadTilt)));
  }
  EXPECT_NEAR(highest_rad, test::stored_deg(20) * test::kRadPerDegree, 1e-5);
}

TEST_F(ControllerMotion, EndsOnStop) {
  bench.command(Command::kPlay, 1);
  bench.run_ms(2'000);
  EXPECT_EQ(bench.now().state, State::kMotion);
  bench.command(Command::kStop);
  EXPECT_EQ(bench.now().refusal, Reason::kNone);
  ASSERT_TRUE(bench.run_until(State::kStanding, 450));  // one nod takes 400 ms
  EXPECT_EQ(bench.target(kHeadTilt), degrees(0));
}

TEST_F(ControllerMotion, StopIsRefusedWhenNothingPlays) {
  bench.command(Command::kStop);
  EXPECT_EQ(bench.now().refusal, Reason::kNotInThisState);
}

TEST_F(ControllerMotion, PlayIsRefusedWhileAnotherMovesTheJoints) {
  bench.command(Command::kPlay, 1);
  bench.run_ms(150);
  const fixed::Angle before = bench.target(kHeadTilt);
  bench.command(Command::kPlay, 0);
  EXPECT_EQ(bench.now().refusal, Reason::kJointsInUse);
  EXPECT_EQ(bench.now().motion, 1);
  bench.run_ms(10);
  EXPECT_GT(bench.target(kHeadTilt), before);  // motion continues
}

TEST_F(ControllerMotion, PlayIsRefusedWithoutSuchAMotion) {
  for (const std::int16_t number : {std::int16_t{2}, std::int16_t{31}, std::int16_t{32}, std::int16_t{-1},
                                    std::int16_t{0x7FFF}, std::int16_t{-0x8000}}) {
    bench.command(Command::kPlay, number);
    EXPECT_EQ(bench.now().refusal, Reason::kNoSuchMotion) << number;
    EXPECT_EQ(bench.now().state, State::kStanding);
  }
}

// A motion is validated at boot, and not again when it starts.
TEST_F(ControllerMotion, PlayIsRefusedWhenTheBootFindsTheMotionsBytesDamaged) {
  auto storage = bench.board.storage.contents();
  std::vector<std::byte> damaged(storage.begin(), storage.end());
  const auto last = std::ranges::find_if(damaged.rbegin(), damaged.rend(),
                                         [](std::byte b) { return b != std::byte{0xFF}; });
  *(last + 4) ^= std::byte{1};
  bench.restart(damaged);
  ASSERT_TRUE(bench.run_until_standing());
  bench.command(Command::kPlay, 1);
  EXPECT_EQ(bench.now().refusal, Reason::kNoSuchMotion);
  EXPECT_EQ(bench.now().state, State::kStanding);
}

TEST_F(ControllerMotion, LimpEndsTheMotionAndTheTorque) {
  bench.command(Command::kPlay, 1);
  bench.run_ms(100);
  bench.command(Command::kLimp);
  EXPECT_EQ(bench.now().state, State::kLimp);
  EXPECT_FALSE(bench.board.drive_enable.enabled());
}

TEST_F(ControllerMotion, ContinuesWhereItWasAfterAGapInTime) {
  bench.command(Command::kPlay, 1);
  bench.run_ms(100);
  const double before_rad = fixed::to_double(bench.target(kHeadTilt));
  bench.skip_ms(40);
  bench.run_ms(10);
  const double step_rad = fixed::to_double(bench.target(kHeadTilt)) - before_rad;
  EXPECT_NEAR(step_rad, 1.0 * test::kRadPerDegree, 0.01 * test::kRadPerDegree);  // the change of one tick, no
                                                                                 // jump
}

TEST_F(ControllerMotion, KeepsTargetsWithinTheLimits) {
  const auto& tilt = bench.model().joints[kHeadTilt];
  bench.command(Command::kPlay, 1);
  for (int i = 0; i < 100; ++i) {
    bench.run_ms(10);
    EXPECT_GE(bench.target(kHeadTilt), tilt.lower);
    EXPECT_LE(bench.target(kHeadTilt), tilt.upper);
  }
}

TEST_F(ControllerMotion, UnknownCommandsAreRefusedAndChangeNothing) {
  for (int code = 11; code < 256; ++code) {
    bench.command(static_cast<Command>(code));
    EXPECT_EQ(bench.now().refusal, Reason::kUnknownCommand);
    EXPECT_EQ(bench.now().state, State::kStanding);
  }
  bench.board.can.deliver({.identifier = 0x601, .size = 8, .data = {0x2F, 0x00, 0x20, 0x01, 11}});
  bench.run_ms(1);
  const hal::CanFrame invalid_value{
      .identifier = 0x581, .size = 8, .data = {0x80, 0x00, 0x20, 0x01, 0x30, 0x00, 0x09, 0x06}};
  EXPECT_EQ(bench.last_sent(0x581), invalid_value);
}

}  // namespace
}  // namespace koboshi::app
