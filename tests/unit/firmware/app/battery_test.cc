#include <gtest/gtest.h>

#include "tests/support/controller_bench.h"

namespace koboshi::app {
namespace {

using test::ControllerBench;

constexpr std::uint16_t kEmergency = 0x081;
constexpr int kTwoSeconds_ms = 2'300;  // including the pending request

class ControllerBattery : public testing::Test {
 protected:
  void SetUp() override { ASSERT_TRUE(bench.run_until_ready_to_walk()); }
  void supply(std::uint32_t supply_mV) {
    for (auto& drive : bench.drives) drive.set_object(0x6079, 0, supply_mV);
  }

  ControllerBench bench;
};

TEST_F(ControllerBattery, IsLowAfterTwoSeconds) {
  supply(6'200);
  bench.run_ms(1'600);
  EXPECT_EQ(bench.now().state, State::kStanding);
  bench.run_ms(kTwoSeconds_ms - 1'600);
  EXPECT_EQ(bench.now().state, State::kLowBattery);
  EXPECT_EQ(bench.now().reason, Reason::kSupplyLow);
  const auto emergency = bench.last_sent(kEmergency);
  ASSERT_TRUE(emergency.has_value());
  EXPECT_EQ(emergency->data[0] | emergency->data[1] << 8, 0x3220);
}

TEST_F(ControllerBattery, IsNotLowAtItsLimit) {
  const std::uint32_t limit_mV = bench.values().parameters.supply_low_mV;
  supply(limit_mV);
  bench.run_ms(2 * kTwoSeconds_ms);
  EXPECT_EQ(bench.now().state, State::kStanding);
  supply(limit_mV - 1);
  bench.run_ms(2 * kTwoSeconds_ms);
  EXPECT_EQ(bench.now().state, State::kLowBattery);
}

TEST_F(ControllerBattery, IsNotLowForOneDropUnderLoad) {
  for (int i = 0; i < 5; ++i) {
    supply(6'000);
    bench.run_ms(1'000);
    supply(7'000);
    bench.run_ms(500);
  }
  EXPECT_EQ(bench.now().state, State::kStanding);
}

TEST_F(ControllerBattery, LowRefusesAllCommandsButLimp) {
  supply(6'200);
  bench.run_ms(kTwoSeconds_ms);
  for (const Command command : {Command::kWalk, Command::kPlay}) {
    bench.command(command);
    EXPECT_EQ(bench.now().state, State::kLowBattery);
    EXPECT_EQ(bench.now().refusal, Reason::kSupplyLow);
  }
  bench.command(Command::kEnable);
  EXPECT_EQ(bench.now().state, State::kLowBattery);
  EXPECT_EQ(bench.now().refusal, Reason::kNotInThisState);
  supply(7'400);  // the voltage of an unloaded battery
  bench.run_ms(3'000);
  EXPECT_EQ(bench.now().state, State::kLowBattery);
  bench.sent.clear();
  bench.command(Command::kLimp);
  bench.run_ms(20);
  EXPECT_EQ(bench.now().state, State::kLimp);
  EXPECT_EQ(bench.last_sent(kEmergency)->data[0], 0);  // error reset
  EXPECT_TRUE(bench.run_until_standing());
}

TEST_F(ControllerBattery, LowEndsAMotionFirst) {
  bench.command(Command::kPlay, 1);  // nods until stopped
  supply(6'200);
  bench.run_ms(kTwoSeconds_ms);
  EXPECT_TRUE(bench.run_until(State::kLowBattery, 3'000));
}

TEST_F(ControllerBattery, LowEndsAWalkFirstAndNoCommandRevokesThat) {
  bench.command(Command::kWalk);
  supply(6'200);
  bench.run_ms(kTwoSeconds_ms);
  EXPECT_EQ(bench.now().state, State::kWalking);
  bench.command(Command::kWalk);
  EXPECT_EQ(bench.now().refusal, Reason::kSupplyLow);
  EXPECT_TRUE(bench.run_until(State::kLowBattery, 5'000));
}

TEST_F(ControllerBattery, IgnoresADriveThatDoesNotAnswer) {
  bench.drives[4].answers_sdo = false;
  supply(6'200);
  EXPECT_TRUE(bench.run_until(State::kLowBattery, kTwoSeconds_ms + 500));
}

}  // namespace
}  // namespace koboshi::app
