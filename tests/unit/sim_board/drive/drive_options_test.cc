#include "tests/unit/sim_board/drive/drive_bench.h"

// The option codes 0x605A to 0x605E, each on a drive in motion: what it does, how long, and where it ends.
namespace koboshi::sim_board {
namespace {

struct Stop {
  const char* name;
  std::uint16_t option_code;
  std::uint16_t option;
  std::uint16_t controlword;
  bool loses_sync;  // the cause is a fault, not the controlword
  State during;
  State after;
  int ramp_ms;  // 0: no torque at once
};

class DriveStops : public DriveTest, public testing::WithParamInterface<Stop> {
 protected:
  void move_ms(int duration_ms) {
    for (int i = 0; i < duration_ms; ++i) {
      run_ms(1);
      shaft.position_rad = drive->values().position_demand * kRadPerPositionUnit;
    }
  }
  // In the profile's cruise, at 150'000 units/s.
  void enable_and_move() {
    write({0x6081, 0}, 150'000, 4);
    write({0x6083, 0}, 3'000'000, 4);
    write({0x6084, 0}, 1'000'000, 4);  // to rest in 150 ms,
    write({0x6085, 0}, 3'000'000, 4);  // or in 50 ms
    enable();
    write({0x6060, 0}, 1, 1);
    target = 1'000'000;
    controlword = cia402::kControlEnableOperation | cia402::kNewSetPoint;
    move_ms(200);
  }
};

TEST_P(DriveStops, AsItsOptionCodeSpecifies) {
  const Stop& stop = GetParam();
  configure();
  ASSERT_EQ(abort_of({stop.option_code, 0}, stop.option, 2), 0u);
  enable_and_move();
  controlword = stop.controlword;
  syncs = !stop.loses_sync;
  const std::uint64_t asked_us = now_us;
  const auto left = [&] {
    return stop.during == State::kOperationEnabled
               ? (drive->values().statusword & cia402::kSetPointAcknowledge) == 0
               : drive->state() != State::kOperationEnabled;
  };
  while (!left() && now_us < asked_us + 100'000) move_ms(1);
  const std::uint64_t start_us = now_us;
  EXPECT_EQ(drive->state(), stop.ramp_ms == 0 ? stop.after : stop.during);
  while (drive->state() != stop.after && now_us < start_us + 1'000'000) {
    EXPECT_TRUE(drive->makes_torque());
    run_ms(1);
  }
  EXPECT_EQ(drive->state(), stop.after);
  EXPECT_FALSE(drive->makes_torque());
  const double expected_us = stop.ramp_ms == 0 ? 0.0 : 1e3 * stop.ramp_ms + Drive::kStandTime_us;
  EXPECT_NEAR(static_cast<double>(now_us - start_us), expected_us, 3'000.0);
}

using enum State;
INSTANTIATE_TEST_SUITE_P(
    OptionCode, DriveStops,
    testing::Values(Stop{"QuickStop0", 0x605A, 0, 0x02, false, kQuickStopActive, kSwitchOnDisabled, 0},
                    Stop{"QuickStop1", 0x605A, 1, 0x02, false, kQuickStopActive, kSwitchOnDisabled, 150},
                    Stop{"QuickStop2", 0x605A, 2, 0x02, false, kQuickStopActive, kSwitchOnDisabled, 50},
                    // The demand stands at once; the shaft has the time of the hold.
                    Stop{"QuickStop3", 0x605A, 3, 0x02, false, kQuickStopActive, kSwitchOnDisabled, 1},
                    Stop{"QuickStop4", 0x605A, 4, 0x02, false, kQuickStopActive, kSwitchOnDisabled, 1},
                    Stop{"Shutdown0", 0x605B, 0, 0x06, false, kOperationEnabled, kReadyToSwitchOn, 0},
                    Stop{"Shutdown1", 0x605B, 1, 0x06, false, kOperationEnabled, kReadyToSwitchOn, 150},
                    Stop{"DisableOperation0", 0x605C, 0, 0x07, false, kOperationEnabled, kSwitchedOn, 0},
                    Stop{"DisableOperation1", 0x605C, 1, 0x07, false, kOperationEnabled, kSwitchedOn, 150},
                    Stop{"FaultReaction0", 0x605E, 0, 0x0F, true, kFaultReactionActive, kFault, 0},
                    Stop{"FaultReaction1", 0x605E, 1, 0x0F, true, kFaultReactionActive, kFault, 150},
                    Stop{"FaultReaction2", 0x605E, 2, 0x0F, true, kFaultReactionActive, kFault, 50}),
    [](const auto& info) { return info.param.name; });

// Codes 5 to 8: as 1 to 4, and then the shaft is held until the controller says what follows.
class DriveStays : public DriveStops {};

TEST_P(DriveStays, InQuickStopActiveUntilCommanded) {
  const Stop& stop = GetParam();
  for (const std::uint16_t way_out : {cia402::kControlDisableVoltage, cia402::kControlEnableOperation}) {
    controlword = 0;
    run_ms(20);
    configure();
    ASSERT_EQ(abort_of({0x605A, 0}, static_cast<std::uint32_t>(stop.option), 2), 0u);
    enable_and_move();
    controlword = stop.controlword;
    while (drive->state() == State::kOperationEnabled) move_ms(1);
    move_ms(1'000);
    EXPECT_EQ(drive->state(), State::kQuickStopActive);
    EXPECT_TRUE(is_driven());
    const std::int32_t rest = drive->values().position_demand;
    for (const std::uint16_t word : {cia402::kControlShutdown, cia402::kControlSwitchOn}) {
      controlword = word;
      move_ms(50);
      EXPECT_EQ(drive->state(), State::kQuickStopActive);
      EXPECT_EQ(drive->values().position_demand, rest);
    }
    controlword = way_out;
    move_ms(50);
    const bool resumes = way_out == cia402::kControlEnableOperation;
    EXPECT_EQ(drive->state(), resumes ? State::kOperationEnabled : State::kSwitchOnDisabled);
    EXPECT_EQ(is_driven(), resumes);
    if (!resumes) continue;
    EXPECT_EQ(drive->values().position_demand, rest);  // no old set-point
  }
}

INSTANTIATE_TEST_SUITE_P(
    QuickStop, DriveStays,
    testing::Values(Stop{"SlowDownRamp", 0x605A, 5, 0x02, false, kQuickStopActive, kQuickStopActive, 150},
                    Stop{"QuickStopRamp", 0x605A, 6, 0x02, false, kQuickStopActive, kQuickStopActive, 50},
                    Stop{"CurrentLimit", 0x605A, 7, 0x02, false, kQuickStopActive, kQuickStopActive, 0},
                    Stop{"VoltageLimit", 0x605A, 8, 0x02, false, kQuickStopActive, kQuickStopActive, 0}),
    [](const auto& info) { return info.param.name; });

// In the cyclic mode the next targets then lead on from where the demand is, without a jump.
TEST_F(DriveTest, ResumesFromAQuickStopRampWithoutAJump) {
  configure();
  write({0x605A, 0}, 6, 2);
  enable();
  target = 20'000;
  run_ms(15);
  controlword = cia402::kControlQuickStop;
  run_ms(10);
  ASSERT_EQ(drive->state(), State::kQuickStopActive);
  controlword = cia402::kControlEnableOperation;
  std::int32_t before = drive->values().position_demand;
  for (int i = 0; i < 100; ++i) {
    run_ms(1);
    EXPECT_NEAR(drive->values().position_demand, before, 2'100);
    before = drive->values().position_demand;
  }
  EXPECT_EQ(drive->state(), State::kOperationEnabled);
  EXPECT_EQ(before, 20'000);
}

TEST_F(DriveTest, StaysEnabledWhenADisableIsRevokedDuringItsRamp) {
  configure();
  write({0x605C, 0}, 1, 2);
  enable();
  controlword = cia402::kControlSwitchOn;
  run_ms(40);
  EXPECT_EQ(drive->state(), State::kOperationEnabled);
  controlword = cia402::kControlEnableOperation;
  target = 5'000;
  run_ms(200);
  EXPECT_EQ(drive->state(), State::kOperationEnabled);
  EXPECT_EQ(drive->values().position_demand, 5'000);
}

TEST_F(DriveTest, DoesNotWaitForARampWhenTheLineFalls) {
  configure();
  write({0x605C, 0}, 1, 2);
  enable();
  controlword = cia402::kControlSwitchOn;
  run_ms(30);
  drive->set_enable_line(false);
  run_ms(1);
  EXPECT_EQ(drive->state(), State::kSwitchOnDisabled);
  EXPECT_FALSE(is_driven());
}

}  // namespace
}  // namespace koboshi::sim_board
