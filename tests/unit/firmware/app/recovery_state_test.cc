#include "tests/unit/firmware/app/recovery_fixture.h"

namespace koboshi::app {
namespace {

// Each fault and command in each state of a fall and of standing up.
class RecoveryState : public RecoveryTest, public testing::WithParamInterface<State> {
 protected:
  void SetUp() override {
    RecoveryTest::SetUp();
    give(Role::kRiseProne, {{Opcode::kWait, 0, 300'000}});
    stand();
    const State wanted = GetParam();
    if (wanted == State::kRolling) {
      turn_to(-90, 0);
    } else {
      turn_to(0, 40);
      if (wanted != State::kFalling) turn_to(0, 90, 100);
    }
    if (wanted == State::kSteadying) {
      ASSERT_TRUE(bench.run_until(State::kRising, 1'000));
      turn_to(0, 0, 300);
    }
    ASSERT_TRUE(bench.run_until(wanted, 1'000));
  }
  void expect_limp(State state) {
    bench.run_ms(320);
    EXPECT_EQ(bench.now().state, state);
    EXPECT_FALSE(bench.board.drive_enable.enabled());
    bench.run_ms(1'000);
    EXPECT_EQ(bench.now().state, state);
  }
};

TEST_P(RecoveryState, EndsInFaultWhenADriveIsLost) {
  bench.drives[5].hangs = true;
  ASSERT_TRUE(bench.run_until(State::kFault, 400));
  EXPECT_EQ(bench.now().reason, Reason::kDriveFault);
  expect_limp(State::kFault);
}

TEST_P(RecoveryState, EndsInFaultWhenADriveFails) {
  bench.board.can.deliver(bench.drives[0].emergency(0xFF01));
  ASSERT_TRUE(bench.run_until(State::kFault, 20));
  expect_limp(State::kFault);
}

TEST_P(RecoveryState, EndsInFaultWithoutABus) {
  bench.board.can.set_error_state(hal::CanErrorState::kBusOff);
  ASSERT_TRUE(bench.run_until(State::kFault, 20));
  EXPECT_EQ(bench.now().reason, Reason::kBusOff);
}

TEST_P(RecoveryState, EndsInFaultWithoutTheInertialUnit) {
  bench.imu_speaks = false;
  ASSERT_TRUE(bench.run_until(State::kFault, 100));
  EXPECT_EQ(bench.now().reason, Reason::kImuSilent);
  expect_limp(State::kFault);
}

TEST_P(RecoveryState, EndsInFaultWithoutAnAnkleSensor) {
  bench.ankle_speaks[1] = false;
  ASSERT_TRUE(bench.run_until(State::kFault, 100));
  EXPECT_EQ(bench.now().reason, Reason::kAnkleSilent);
  expect_limp(State::kFault);
}

TEST_P(RecoveryState, EndsInFaultWhenAnotherMasterStopsTheController) {
  bench.board.can.deliver({.identifier = 0x000, .size = 2, .data = {128, 1}});  // enter pre-operational
  ASSERT_TRUE(bench.run_until(State::kFault, 20));
  EXPECT_EQ(bench.now().reason, Reason::kNotOperational);
}

TEST_P(RecoveryState, BootsWhenAnotherMasterResetsTheController) {
  bench.board.can.deliver({.identifier = 0x000, .size = 2, .data = {129, 1}});
  bench.run_ms(1);
  EXPECT_EQ(bench.now().state, State::kBoot);
  EXPECT_FALSE(bench.board.drive_enable.enabled());
  ASSERT_TRUE(bench.run_until(State::kLimp, 700));
  EXPECT_FALSE(bench.board.drive_enable.enabled());
}

TEST_P(RecoveryState, StopsInAnEmergency) {
  bench.command(Command::kEmergencyStop);
  EXPECT_FALSE(bench.board.drive_enable.enabled());
  expect_limp(State::kEmergencyStop);
}

TEST_P(RecoveryState, GoesLimpByCommand) {
  bench.command(Command::kLimp);
  expect_limp(State::kLimp);
}

TEST_P(RecoveryState, RefusesOtherCommands) {
  for (const Command command :
       {Command::kEnable, Command::kPlay, Command::kWalk, Command::kGetUp, Command::kReset}) {
    bench.command(command);
    EXPECT_EQ(bench.now().refusal, Reason::kNotInThisState);
  }
}

INSTANTIATE_TEST_SUITE_P(EveryState, RecoveryState,
                         testing::Values(State::kFalling, State::kFallen, State::kRighting, State::kRolling,
                                         State::kRising, State::kSteadying),
                         [](const auto& info) {
                           return "State" + std::to_string(static_cast<int>(info.param));
                         });

}  // namespace
}  // namespace koboshi::app
