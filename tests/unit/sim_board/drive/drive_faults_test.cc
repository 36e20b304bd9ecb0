#include "tests/unit/sim_board/drive/drive_bench.h"

// Faults that a drive finds in its servo, each with its emergency.
namespace koboshi::sim_board {
namespace {

TEST_F(DriveTest, MonitorsTheFollowingErrorOnlyWhenConfigured) {
  enable();
  target = 100'000;  // the shaft is held
  run_ms(2'000);
  EXPECT_EQ(drive->state(), State::kOperationEnabled);
  EXPECT_EQ(drive->values().following_error, 100'000);
  EXPECT_EQ(drive->values().statusword & cia402::kFollowingError, 0);
}

TEST_F(DriveTest, FaultsWhenItsShaftDoesNotFollowForLongerThanTheTimeOut) {
  configure();
  write({0x6065, 0}, 5'000, 4);
  write({0x6066, 0}, 50, 2);
  enable();
  target = 4'900;
  run_ms(200);
  EXPECT_EQ(drive->state(), State::kOperationEnabled);
  target = 6'000;
  run_ms(30);
  target = 4'900;  // just in time
  run_ms(100);
  EXPECT_EQ(drive->state(), State::kOperationEnabled);
  target = -6'000;
  run_ms(90);
  EXPECT_EQ(drive->state(), State::kFaultReactionActive);
  EXPECT_NE(drive->values().statusword & cia402::kFollowingError, 0);
  EXPECT_EQ(emergencies(), std::vector<std::uint16_t>{0x8611});
  EXPECT_EQ(drive->values().error_code, 0x8611);
  run_ms(200);
  EXPECT_EQ(drive->state(), State::kFault);
  EXPECT_EQ(drive->values().statusword & cia402::kFollowingError, 0);  // nothing is followed any more
  controlword = cia402::kFaultReset;
  run_ms(20);
  EXPECT_EQ(drive->state(), State::kSwitchOnDisabled);
  EXPECT_EQ(emergencies().back(), 0);
}

JointDescription joint_that_heats() {
  JointDescription joint;
  joint.servo.winding = {.thermal_resistance_K_per_W = 20.0,
                         .heat_capacity_J_per_K = 0.05,
                         .derating_C = 60.0,
                         .shutdown_C = 80.0,
                         .derated_share = 0.9};
  return joint;
}

class HotDriveTest : public DriveTest {
 protected:
  HotDriveTest() : DriveTest(joint_that_heats()) {}
};

TEST_F(HotDriveTest, ShutsDownReportsAndCanBeResetAfterCooling) {
  enable();
  target = 100'000;  // the shaft is held
  run_ms(2'000);     // time to fault, and to cool
  EXPECT_EQ(drive->state(), State::kFault);
  EXPECT_LT(drive->winding_C(), 60.0);
  EXPECT_FALSE(is_driven());
  EXPECT_EQ(emergencies(), std::vector<std::uint16_t>{0x4310});
  EXPECT_EQ(drive->values().error_code, 0x4310);
  controlword = 0x80;
  run_ms(20);
  EXPECT_EQ(drive->state(), State::kSwitchOnDisabled);
  EXPECT_EQ(emergencies().back(), 0);
  EXPECT_EQ(drive->values().error_code, 0);
}

TEST_F(HotDriveTest, IsNotResetWhileItIsHot) {
  enable();
  target = 100'000;
  while (drive->state() != State::kFault && now_us < 5'000'000) run_ms(1);
  ASSERT_GT(drive->winding_C(), 60.0);
  controlword = 0x80;
  run_ms(30);
  ASSERT_GT(drive->winding_C(), 60.0);
  EXPECT_EQ(drive->state(), State::kFault);
  EXPECT_EQ(emergencies(), std::vector<std::uint16_t>{0x4310});
  run_ms(2'000);
  ASSERT_LT(drive->winding_C(), 60.0);
  EXPECT_EQ(drive->state(), State::kFault);  // the edge came too early
  controlword = 0x00;
  run_ms(20);
  controlword = 0x80;
  run_ms(20);
  EXPECT_EQ(drive->state(), State::kSwitchOnDisabled);
}

TEST_F(DriveTest, FaultsWhenItsSupplyIsLowForLonger) {
  enable();
  supply_V = 3.7;  // half of 7.5 V is 3.75
  run_ms(8);
  supply_V = 3.8;
  run_ms(50);
  EXPECT_EQ(drive->state(), State::kOperationEnabled);
  supply_V = 3.7;
  run_ms(15);
  EXPECT_EQ(emergencies(), std::vector<std::uint16_t>{0x3220});
  run_ms(200);
  EXPECT_EQ(drive->state(), State::kFault);
  controlword = cia402::kFaultReset;
  run_ms(20);
  EXPECT_EQ(drive->state(), State::kFault);  // the supply is still low
  controlword = 0;
  supply_V = 7.5;
  run_ms(20);
  controlword = cia402::kFaultReset;
  run_ms(20);
  EXPECT_EQ(drive->state(), State::kSwitchOnDisabled);
  EXPECT_EQ(emergencies().back(), 0);
}

TEST_F(DriveTest, ToleratesALowSupplyWhileLimp) {
  configure();
  supply_V = 0.0;
  run_ms(200);
  EXPECT_EQ(drive->state(), State::kSwitchOnDisabled);
  EXPECT_TRUE(emergencies().empty());
}

// CiA 402-2: bit 4 of the statusword, voltage enabled, depends on the supply, and not on the state.
TEST_F(DriveTest, ShowsInEveryStateWhetherItsSupplyIsApplied) {
  configure();
  const auto shown = [&] { return (drive->values().statusword & cia402::kVoltageEnabled) != 0; };
  const auto expect_both = [&](State state) {
    run_ms(20);
    EXPECT_EQ(drive->state(), state);
    EXPECT_TRUE(shown()) << static_cast<int>(state);
    supply_V = 3.7;  // half of 7.5 V is 3.75
    run_ms(5);       // too short for a fault
    EXPECT_EQ(drive->state(), state);
    EXPECT_FALSE(shown()) << static_cast<int>(state);
    supply_V = 7.5;
    run_ms(5);
  };
  expect_both(State::kSwitchOnDisabled);
  controlword = cia402::kControlShutdown;
  expect_both(State::kReadyToSwitchOn);
  controlword = cia402::kControlSwitchOn;
  expect_both(State::kSwitchedOn);
  controlword = cia402::kControlEnableOperation;
  expect_both(State::kOperationEnabled);
  drive->set_enable_line(false);
  expect_both(State::kSwitchOnDisabled);
}

JointDescription with_current_limit() {
  JointDescription joint;
  joint.servo.current_limit_A = 0.5;
  return joint;
}

class LimitedDriveTest : public DriveTest {
 protected:
  LimitedDriveTest() : DriveTest(with_current_limit()) {}
};

TEST_F(LimitedDriveTest, OperatesAtItsCurrentLimitWithoutAFault) {
  enable();
  target = 500'000;  // the shaft is held
  run_ms(500);
  EXPECT_NEAR(drive->current_A(), 0.5, 1e-9);
  EXPECT_EQ(drive->state(), State::kOperationEnabled);
}

// Driven from outside at 15 rad/s it generates twice its supply, which it cannot oppose: 1.4 A.
TEST_F(LimitedDriveTest, FaultsWhenItGeneratesMoreThanItsLimit) {
  enable();
  shaft.speed_rad_per_s = 15.0;
  run_ms(15);
  shaft.speed_rad_per_s = 0.0;
  run_ms(50);
  EXPECT_EQ(drive->state(), State::kOperationEnabled);
  shaft.speed_rad_per_s = 15.0;
  run_ms(30);
  EXPECT_EQ(emergencies(), std::vector<std::uint16_t>{0x2310});
  EXPECT_EQ(drive->values().error_code, 0x2310);
}

TEST_F(DriveTest, NeverFaultsForCurrentWithoutALimit) {
  enable();
  shaft.speed_rad_per_s = 30.0;
  run_ms(200);
  EXPECT_EQ(drive->state(), State::kOperationEnabled);
}

TEST_F(DriveTest, DisablesTorqueAtOnceWhenItsEncoderFails) {
  enable();
  drive->break_encoder();
  run_ms(2);
  EXPECT_EQ(drive->state(), State::kFault);  // no ramp without a position
  EXPECT_FALSE(is_driven());
  EXPECT_EQ(emergencies(), std::vector<std::uint16_t>{0x7305});
  const std::int32_t position = drive->values().position_actual;
  shaft.position_rad = 1.0;
  run_ms(20);
  EXPECT_EQ(drive->values().position_actual, position);
  controlword = cia402::kFaultReset;
  run_ms(20);
  EXPECT_EQ(drive->state(), State::kFault);
}

TEST_F(DriveTest, DisablesTorqueWhenItsEncoderFailsDuringAQuickStop) {
  enable();
  controlword = cia402::kControlQuickStop;
  run_ms(12);
  ASSERT_EQ(drive->state(), State::kQuickStopActive);
  drive->break_encoder();
  run_ms(2);
  EXPECT_EQ(drive->state(), State::kFault);
  EXPECT_FALSE(is_driven());
}

}  // namespace
}  // namespace koboshi::sim_board
