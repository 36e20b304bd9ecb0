#include <gtest/gtest.h>

#include <array>

#include "tests/support/controller_bench.h"
#include "tests/support/sdo_pc.h"

namespace koboshi::app {
namespace {

using canopen::AbortCode;
using test::ControllerBench;
using test::SdoPc;

constexpr canopen::ObjectAddress kLowestSupply{0x2100, 1};
constexpr canopen::ObjectAddress kRampRate{0x2100, 3};
constexpr canopen::ObjectAddress kKneeGain{0x2101, 4};

class ControllerParameters : public testing::Test {
 protected:
  void SetUp() override {
    bench.board.storage.complete_after(22);  // duration of a flash page erase
    ASSERT_TRUE(bench.run_until(State::kLimp));
  }
  void power_cycle() {
    bench.board.storage.lose_power();
    bench.restart();
    ASSERT_TRUE(bench.run_until(State::kLimp));
  }

  ControllerBench bench;
  SdoPc pc{bench};
};

TEST_F(ControllerParameters, SurviveAPowerCycleOnceTheyAreSaved) {
  ASSERT_EQ(pc.write(kLowestSupply, 6'500, 2), AbortCode::kNone);
  ASSERT_EQ(pc.write(kKneeGain, -300, 2), AbortCode::kNone);
  power_cycle();
  EXPECT_EQ(bench.values().parameters.supply_min_mV, 6'000);
  ASSERT_EQ(pc.write(kLowestSupply, 6'500, 2), AbortCode::kNone);
  ASSERT_EQ(pc.write(kKneeGain, -300, 2), AbortCode::kNone);
  ASSERT_EQ(pc.save(), AbortCode::kNone);
  EXPECT_GT(pc.answer_ms, 22);  // the answer is sent after completion
  power_cycle();
  EXPECT_EQ(bench.values().parameters.supply_min_mV, 6'500);
  EXPECT_EQ(bench.values().feedback.motion.knee, -300);
}

TEST_F(ControllerParameters, AreFactoryDefaultsAfterRestoreAndReset) {
  ASSERT_EQ(pc.write(kLowestSupply, 6'500, 2), AbortCode::kNone);
  ASSERT_EQ(pc.save(), AbortCode::kNone);
  ASSERT_EQ(pc.restore(), AbortCode::kNone);
  EXPECT_EQ(bench.values().parameters.supply_min_mV, 6'500);  // the value stays until the reset
  bench.board.can.deliver({.identifier = 0x000, .size = 2, .data = {129, 1}});
  bench.run_ms(1);
  EXPECT_EQ(bench.values().parameters.supply_min_mV, 6'000);
}

TEST_F(ControllerParameters, ResetOfTheNodeLoadsTheSavedOnes) {
  ASSERT_EQ(pc.write(kLowestSupply, 6'500, 2), AbortCode::kNone);
  ASSERT_EQ(pc.save(), AbortCode::kNone);
  ASSERT_EQ(pc.write(kLowestSupply, 7'000, 2), AbortCode::kNone);
  bench.board.can.deliver({.identifier = 0x000, .size = 2, .data = {130, 1}});  // reset communication
  bench.run_ms(1);
  EXPECT_EQ(bench.values().parameters.supply_min_mV, 7'000);
  bench.board.can.deliver({.identifier = 0x000, .size = 2, .data = {129, 1}});
  bench.run_ms(1);
  EXPECT_EQ(bench.values().parameters.supply_min_mV, 6'500);
}

TEST_F(ControllerParameters, AreWrittenOnlyWhenTheyHaveChanged) {
  ASSERT_EQ(pc.save(), AbortCode::kNone);
  EXPECT_GT(pc.answer_ms, 22);
  ASSERT_EQ(pc.save(), AbortCode::kNone);
  EXPECT_EQ(pc.answer_ms, 1);
}

TEST_F(ControllerParameters, ReportWhichGroupsAreStored) {
  for (const std::uint16_t index : {std::uint16_t{0x1010}, std::uint16_t{0x1011}}) {
    EXPECT_EQ(pc.read({index, 0}), 4u);
    for (const std::uint8_t group : std::to_array<std::uint8_t>({1, 3, 4}))
      EXPECT_EQ(pc.read({index, group}), 1u);
    EXPECT_EQ(pc.read({index, 2}), 0u);
  }
  EXPECT_EQ(pc.write({0x1010, 2}, 0x65766173, 4), AbortCode::kCannotTransfer);
  EXPECT_EQ(pc.write({0x1010, 3}, 0x65766174, 4), AbortCode::kCannotTransfer);  // wrong signature
  EXPECT_EQ(pc.write({0x1010, 3}, 0x65766173, 4), AbortCode::kNone);
}

TEST_F(ControllerParameters, AreNotSavedWhileTheRobotWalks) {
  bench.run_ms(1'200);  // of rest, for the gyro's bias
  bench.command(Command::kEnable);
  EXPECT_EQ(pc.save(), AbortCode::kDeviceState);
  ASSERT_TRUE(bench.run_until(State::kStanding));
  bench.command(Command::kWalk);
  ASSERT_EQ(bench.now().state, State::kWalking);
  EXPECT_EQ(pc.save(), AbortCode::kDeviceState);
  bench.command(Command::kStop);
  ASSERT_TRUE(bench.run_until(State::kStanding));
  bench.command(Command::kPlay, 1);
  EXPECT_EQ(pc.save(), AbortCode::kNone);
  EXPECT_EQ(bench.now().state, State::kMotion);  // it goes on
}

TEST_F(ControllerParameters, SavingReportsAFlashFailure) {
  bench.board.storage.fail_next();
  EXPECT_EQ(pc.save(), AbortCode::kHardwareError);
  EXPECT_EQ(pc.save(), AbortCode::kNone);
}

// Power fails in each millisecond of a save: afterwards both parameters are old or both are new.
TEST_F(ControllerParameters, AreNeverPartlySavedByAPowerFailure) {
  bench.board.storage.complete_after(2);
  ASSERT_EQ(pc.write(kLowestSupply, 6'100, 2), AbortCode::kNone);
  ASSERT_EQ(pc.write(kRampRate, 100, 2), AbortCode::kNone);
  ASSERT_EQ(pc.save(), AbortCode::kNone);
  const int save_ms = pc.answer_ms;
  const std::vector<std::byte> flash(bench.board.storage.contents().begin(),
                                     bench.board.storage.contents().end());
  int new_ones = 0;
  for (int time_ms = 0; time_ms <= save_ms; ++time_ms) {
    ASSERT_EQ(pc.write(kLowestSupply, 6'200, 2), AbortCode::kNone);
    ASSERT_EQ(pc.write(kRampRate, 200, 2), AbortCode::kNone);
    bench.board.can.deliver(
        {.identifier = 0x601, .size = 8, .data = {0x23, 0x10, 0x10, 1, 0x73, 0x61, 0x76, 0x65}});
    bench.run_ms(time_ms);
    power_cycle();
    const bool is_new = bench.values().parameters.ramp_rate == 200;
    new_ones += is_new ? 1 : 0;
    EXPECT_EQ(bench.values().parameters.ramp_rate, is_new ? 200 : 100) << time_ms;
    EXPECT_EQ(bench.values().parameters.supply_min_mV, is_new ? 6'200 : 6'100) << time_ms;
    bench.restart(flash);
    ASSERT_TRUE(bench.run_until(State::kLimp));
  }
  EXPECT_GE(new_ones, 1);
  EXPECT_LE(new_ones, 3);
}

}  // namespace
}  // namespace koboshi::app
