// A robot with the motion sit whose supply becomes low, without physics: only its drives' readings and its
// inertial unit say what happens.

#include <gtest/gtest.h>

#include "firmware/canopen/emergency.h"
#include "firmware/canopen/frame.h"
#include "tests/support/controller_bench.h"
#include "tests/unit/firmware/app/recovery_fixture.h"

namespace koboshi::app {
namespace {

constexpr std::uint16_t kSupplyEmergency = 0x081;
constexpr int kUntilLow_ms = 2'300;  // two seconds, with the pending request

class LowSupply : public RecoveryTest {
 protected:
  void supply(std::uint32_t supply_mV) {
    for (auto& drive : bench.drives) drive.set_object(0x6079, 0, supply_mV);
  }
  std::uint16_t last_emergency() const {
    const auto sent = bench.last_sent(kSupplyEmergency);
    return sent ? canopen::load_u16(&sent->data[0]) : 0;
  }
};

TEST_F(LowSupply, SitsDownAndGoesLimp) {
  stand();
  supply(6'200);
  bench.run_ms(1'600);
  EXPECT_EQ(bench.now().state, State::kStanding);
  ASSERT_TRUE(bench.run_until(State::kSittingDown, kUntilLow_ms - 1'600));
  expect_state(State::kSittingDown, Reason::kSupplyLow);
  bench.run_ms(20);
  EXPECT_EQ(bench.now().motion, number_of(Role::kSit));
  EXPECT_EQ(last_emergency(), 0x3220);
  ASSERT_TRUE(bench.run_until(State::kLimp, 400));
  expect_state(State::kLimp, Reason::kSupplyLow);
  EXPECT_FALSE(bench.board.drive_enable.enabled());
  EXPECT_EQ(last_emergency(), 0x3220);  // until the supply has recovered
}

TEST_F(LowSupply, RefusesToMoveUntilTheSupplyHasRecovered) {
  stand();
  supply(6'200);
  ASSERT_TRUE(bench.run_until(State::kSittingDown, kUntilLow_ms));
  for (const Command command : {Command::kWalk, Command::kPlay}) {
    bench.command(command);
    EXPECT_EQ(bench.now().refusal, Reason::kSupplyLow);
  }
  bench.command(Command::kStop);
  EXPECT_EQ(bench.now().refusal, Reason::kNotInThisState);
  ASSERT_TRUE(bench.run_until(State::kLimp, 400));
  for (const Command command : {Command::kEnable, Command::kGetUp}) {
    bench.command(command);
    expect_state(State::kLimp, Reason::kSupplyLow);
    EXPECT_EQ(bench.now().refusal, Reason::kSupplyLow);
  }
  supply(6'400);  // within the hysteresis
  bench.run_ms(3'000);
  bench.command(Command::kEnable);
  EXPECT_EQ(bench.now().refusal, Reason::kSupplyLow);
  supply(7'400);
  bench.run_ms(kUntilLow_ms);
  EXPECT_EQ(last_emergency(), 0);
  stand();
}

TEST_F(LowSupply, EndsAWalkByItsStepsAndForgetsItsVelocity) {
  stand();
  hal::CanFrame velocity{.identifier = test::kVelocityIdentifier, .size = 6};
  canopen::store_u16(&velocity.data[0], 200);
  bench.board.can.deliver(velocity);
  bench.command(Command::kWalk);
  bench.run_ms(1'000);
  ASSERT_EQ(bench.now().state, State::kWalking);
  supply(6'200);
  ASSERT_TRUE(bench.run_until(State::kSittingDown, kUntilLow_ms));
  EXPECT_EQ(bench.values().velocity, walk::Velocity());
  // It slows down from 0.2 m/s with 0.3 m/s^2, closes its feet and settles, and sits down only then.
  bench.run_ms(1'500);
  EXPECT_EQ(bench.now().state, State::kSittingDown);
  EXPECT_NE(bench.now().motion, number_of(Role::kSit));
  bench.board.can.deliver(velocity);
  bench.run_ms(1);
  EXPECT_EQ(bench.values().velocity, walk::Velocity());
  EXPECT_EQ(bench.now().refusal, Reason::kSupplyLow);
  bench.command(Command::kWalk);
  ASSERT_TRUE(bench.run_until(State::kLimp, 5'000));
  EXPECT_EQ(bench.now().motion, number_of(Role::kSit));
  EXPECT_EQ(bench.now().faults, 0);
}

TEST_F(LowSupply, EndsAMotionFirst) {
  stand();
  bench.command(Command::kPlay, 1);  // nods until stopped
  supply(6'200);
  ASSERT_TRUE(bench.run_until(State::kSittingDown, kUntilLow_ms));
  EXPECT_EQ(bench.now().motion, 1);
  ASSERT_TRUE(bench.run_until(State::kLimp, 3'000));
  EXPECT_EQ(bench.now().motion, number_of(Role::kSit));
}

TEST_F(LowSupply, KeepsItsTorqueIfItDoesNotSit) {
  give(Role::kSit, {{Opcode::kFail}});
  stand();
  supply(6'200);
  ASSERT_TRUE(bench.run_until(State::kSittingDown, kUntilLow_ms));
  ASSERT_TRUE(bench.run_until(State::kLowBattery, 400));
  EXPECT_TRUE(bench.board.drive_enable.enabled());
  EXPECT_EQ(bench.now().reason, Reason::kSupplyLow);
  bench.run_ms(1'000);
  EXPECT_EQ(bench.now().state, State::kLowBattery);
}

TEST_F(LowSupply, StaysDownAfterAFallWhileSittingDown) {
  stand();
  supply(6'200);
  ASSERT_TRUE(bench.run_until(State::kSittingDown, kUntilLow_ms));
  turn_to(0, 90);
  EXPECT_EQ(bench.now().state, State::kFallen);
  EXPECT_EQ(last_emergency(), 0x3220);
  ASSERT_TRUE(bench.run_until(State::kLimp, 5'000));
  EXPECT_EQ(bench.now().reason, Reason::kSupplyLow);
  EXPECT_EQ(bench.now().attempts, 0);
  EXPECT_EQ(bench.values().diagnosis.falls, 1);
}

TEST_F(LowSupply, CommandsAndFaultsActAtOnceWhileSittingDown) {
  stand();
  supply(6'200);
  ASSERT_TRUE(bench.run_until(State::kSittingDown, kUntilLow_ms));
  bench.command(Command::kLimp);
  expect_state(State::kLimp, Reason::kCommand);
  bench.run_ms(20);
  EXPECT_EQ(last_emergency(), 0);  // as a robot that stands with a low supply
}

// The drives' own protection: a supply that collapses is a fault, whatever the controller has planned.
TEST_F(LowSupply, ABrownOutIsAFaultAtOnce) {
  stand();
  supply(6'200);
  ASSERT_TRUE(bench.run_until(State::kSittingDown, kUntilLow_ms));
  bench.board.can.deliver(bench.drives[4].emergency(canopen::cia402::kErrorUnderVoltage));
  bench.drives[4].state = test::DriveStub::State::kFault;
  bench.run_ms(30);
  expect_state(State::kFault, Reason::kDriveFault);
  EXPECT_EQ(bench.now().drive_error_code, canopen::cia402::kErrorUnderVoltage);
}

}  // namespace
}  // namespace koboshi::app
