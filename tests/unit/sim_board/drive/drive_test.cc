#include "tests/unit/sim_board/drive/drive_bench.h"

namespace koboshi::sim_board {
namespace {

TEST_F(DriveTest, SendsBootUpAndIsLimp) {
  ASSERT_FALSE(heard.empty());
  EXPECT_EQ(heard[0], (hal::CanFrame{.identifier = 0x700 + kNode, .size = 1, .data = {0}}));
  EXPECT_EQ(drive->state(), State::kSwitchOnDisabled);
  EXPECT_FALSE(is_driven());
  EXPECT_EQ(torque.drive_Nm, 0.0);
}

TEST_F(DriveTest, IsEnabledByControlwordsAtSync) {
  enable();
  EXPECT_TRUE(is_driven());
  EXPECT_EQ(drive->values().statusword & 0x6F, 0x27);
}

TEST_F(DriveTest, StartsFromTheShaftsPositionEvenWhenEnabledWithoutSync) {
  shaft.position_rad = 1.0;
  run_ms(2);
  configure();
  syncs = false;
  for (const std::uint16_t word : kWayToOperation) write({0x6040, 0}, word, 2);
  ASSERT_EQ(drive->state(), State::kOperationEnabled);
  EXPECT_NEAR(torque.drive_Nm, 0.0, 1e-9);
}

TEST_F(DriveTest, InterpolatesItsTargetsOverACycle) {
  enable();
  target = 1'000;
  run_ms(10);
  std::vector<double> torques;
  for (int i = 0; i < 10; ++i) {
    run_ms(1);
    torques.push_back(torque.drive_Nm);
  }
  // The shaft is held, so that the torque shows the demand.
  for (std::size_t i = 1; i < torques.size(); ++i) EXPECT_GE(torques[i], torques[i - 1]);
  EXPECT_GT(torques.back(), 0.0);
}

TEST_F(DriveTest, KeepsTargetsWithinItsPositionLimits) {
  configure();
  write({0x607D, 1}, static_cast<std::uint32_t>(-500), 4);
  write({0x607D, 2}, 500, 4);
  enable();
  target = 100'000;
  run_ms(40);
  const double limited_Nm = torque.drive_Nm;
  target = 500;
  run_ms(40);
  EXPECT_GT(limited_Nm, 0.0);
  EXPECT_EQ(torque.drive_Nm, limited_Nm);
}

TEST_F(DriveTest, MakesNoTorqueInAnyStateWhileTheLineIsLow) {
  for (const std::uint16_t word : {cia402::kControlEnableOperation, cia402::kControlQuickStop}) {
    controlword = 0;
    drive->set_enable_line(true);
    enable();
    controlword = word;
    run_ms(10);
    drive->set_enable_line(false);
    EXPECT_FALSE(drive->makes_torque());
    run_ms(1);
    EXPECT_FALSE(is_driven());
    EXPECT_EQ(drive->state(), State::kSwitchOnDisabled);
  }
}

TEST_F(DriveTest, CannotBeEnabledWhileTheLineIsLow) {
  configure();
  drive->set_enable_line(false);
  for (const std::uint16_t word : kWayToOperation) {
    controlword = word;
    run_ms(20);
    EXPECT_EQ(drive->state(), State::kSwitchOnDisabled);
    EXPECT_FALSE(is_driven());
  }
  EXPECT_NE(drive->values().statusword & cia402::kTorqueOff, 0);
}

TEST_F(DriveTest, PerformsAQuickStopHoldsAndDisables) {
  enable();
  target = 12'000;  // in a cycle of 10 ms: 7.2 rad/s, of 7.48
  run_ms(15);
  controlword = 0x02;
  run_ms(10);
  ASSERT_EQ(drive->state(), State::kQuickStopActive);
  EXPECT_TRUE(is_driven());
  const std::uint64_t start_us = now_us;
  while (drive->state() == State::kQuickStopActive && now_us < start_us + 1'000'000) run_ms(1);
  EXPECT_EQ(drive->state(), State::kSwitchOnDisabled);
  EXPECT_FALSE(is_driven());
  EXPECT_GE(now_us - start_us, 90'000u);   // it holds for 100 ms
  EXPECT_LE(now_us - start_us, 155'000u);  // after 50 ms of ramp at most
  EXPECT_TRUE(emergencies().empty());
}

// --- Losing the controller

struct Loss {
  const char* name;
  std::uint16_t code;
  int within_ms;
  void (*cause)(bool& heartbeats, bool& syncs);
};
class DriveLoses : public DriveTest, public testing::WithParamInterface<Loss> {};

TEST_P(DriveLoses, PerformsAQuickStopReportsAndCutsItsTorque) {
  enable();
  while (now_us % 20'000 != 1'000) run_ms(1);  // both have just been
  GetParam().cause(heartbeats, syncs);
  run_ms(GetParam().within_ms - 2);
  EXPECT_EQ(drive->state(), State::kOperationEnabled);
  run_ms(4);
  EXPECT_EQ(drive->state(), State::kFaultReactionActive);
  EXPECT_TRUE(is_driven());
  EXPECT_EQ(emergencies(), std::vector{GetParam().code});
  EXPECT_EQ(drive->values().error_code, GetParam().code);
  run_ms(155);
  EXPECT_EQ(drive->state(), State::kFault);
  EXPECT_FALSE(is_driven());

  // Nothing but a fault reset leads out.
  heartbeats = syncs = true;
  controlword = 0x0F;
  run_ms(50);
  EXPECT_EQ(drive->state(), State::kFault);
  controlword = 0x80;
  run_ms(20);
  EXPECT_EQ(drive->state(), State::kSwitchOnDisabled);
  EXPECT_EQ(emergencies().back(), 0);
}

INSTANTIATE_TEST_SUITE_P(TheController, DriveLoses,
                         testing::Values(Loss{"Heartbeat", 0x8130, 60,
                                              [](bool& heartbeats, bool&) { heartbeats = false; }},
                                         Loss{"Sync", 0x8700, 50, [](bool&, bool& syncs) { syncs = false; }}),
                         [](const auto& info) { return info.param.name; });

TEST_F(DriveTest, StopsWhenItsControllerRestartsAndThenIsSilent) {
  enable();
  heartbeats = false;
  say({.identifier = 0x701, .size = 1, .data = {0}});
  run_ms(58);
  EXPECT_EQ(drive->state(), State::kOperationEnabled);
  run_ms(6);
  EXPECT_EQ(drive->state(), State::kFaultReactionActive);
  EXPECT_EQ(emergencies(), std::vector<std::uint16_t>{0x8130});
}

TEST_F(DriveTest, ToleratesMissingSyncWhileLimp) {
  configure();
  syncs = false;
  run_ms(200);
  EXPECT_EQ(drive->state(), State::kSwitchOnDisabled);
  EXPECT_TRUE(emergencies().empty());
}

TEST_F(DriveTest, StopsWhenItIsTakenOutOfOperational) {
  enable();
  say({.identifier = 0x000, .size = 2, .data = {128, kNode}});
  run_ms(3);
  EXPECT_EQ(drive->state(), State::kFaultReactionActive);
  EXPECT_EQ(emergencies(), std::vector<std::uint16_t>{0x8100});
  run_ms(160);
  EXPECT_FALSE(is_driven());
}

TEST_F(DriveTest, IsLimpAfterReset) {
  enable();
  say({.identifier = 0x000, .size = 2, .data = {129, 0}});
  run_ms(3);
  EXPECT_EQ(drive->state(), State::kSwitchOnDisabled);
  EXPECT_FALSE(is_driven());
}

// --- Measurements of its servo

TEST_F(DriveTest, ShowsItsPresentSupply) {
  enable();
  EXPECT_EQ(drive->values().supply_mV, 7500u);
  supply_V = 6.9;
  run_ms(20);
  EXPECT_EQ(drive->values().supply_mV, 6900u);
}

TEST_F(DriveTest, ShowsItsVelocityAndCurrent) {
  enable();
  EXPECT_EQ(drive->values().velocity_actual, 0);
  EXPECT_EQ(drive->values().rated_current_mA, 1369u);  // 7.5 V / 5.477 ohm
  for (int i = 0; i < 40; ++i) {
    shaft.position_rad -= 0.001;
    run_ms(1);
  }
  // 1 rad/s is 166'886 units/s; a count in 8 ms is 32'000.
  EXPECT_NEAR(drive->values().velocity_actual, -166'886, 32'000);
  target = 100'000;  // far enough for the whole supply, once the demand is on its way there
  run_ms(160);
  EXPECT_NEAR(drive->values().current_actual_permille, 1e6 * drive->current_A() / 1369.0, 1.0);
  EXPECT_NEAR(drive->values().current_actual_permille, 1'000, 2);
}

JointDescription with_meters() {
  JointDescription joint;
  joint.servo.voltmeter = {.highest = 15.0, .resolution = 0.1};
  joint.servo.thermometer = {.lowest = -40.0, .highest = 125.0, .resolution = 0.5, .sample_period_s = 0.1};
  joint.servo.winding = {.thermal_resistance_K_per_W = 15.0,
                         .heat_capacity_J_per_K = 0.5,
                         .ambient_C = 25.2,
                         .derating_C = 200.0,
                         .shutdown_C = 250.0};
  return joint;
}

class MeasuringDriveTest : public DriveTest {
 protected:
  MeasuringDriveTest() : DriveTest(with_meters()) {}
};

TEST_F(MeasuringDriveTest, ReportsTheReadingsOfItsMeters) {
  EXPECT_EQ(drive->values().winding_dC, 250);
  enable();
  supply_V = 6.96;
  run_ms(20);
  EXPECT_EQ(drive->values().supply_mV, 7000u);
  target = 100'000;  // against a shaft that does not turn
  run_ms(3'000);
  EXPECT_GT(drive->winding_C(), 60.0);
  EXPECT_NEAR(0.1 * drive->values().winding_dC, drive->winding_C(), 2.0);  // a tenth of a second old
  EXPECT_EQ(drive->values().winding_dC % 5, 0);
}

TEST_F(MeasuringDriveTest, ReportsItsTemperatureOnTheBus) {
  hal::CanFrame question{.identifier = 0x600 + kNode, .size = 8, .data = {0x40, 0x00, 0x20, 0x00}};
  heard.clear();
  say(question);
  run_ms(5);
  ASSERT_EQ(heard.size(), 1u);
  EXPECT_EQ(heard[0].data, (std::array<std::uint8_t, 8>{0x4B, 0x00, 0x20, 0x00, 250, 0, 0, 0}));
}

// --- Faults of its hardware

TEST_F(DriveTest, KeepsItsMotorTorqueWhileHungUntilTheLineFalls) {
  enable();
  target = 5'000;
  run_ms(40);
  const double torque_Nm = torque.drive_Nm;
  ASSERT_GT(torque_Nm, 0.0);
  drive->hang();
  heard.clear();
  target = -5'000;
  run_ms(500);
  EXPECT_EQ(torque.drive_Nm, torque_Nm);
  EXPECT_TRUE(heard.empty());
  drive->set_enable_line(false);
  run_ms(1);
  EXPECT_FALSE(is_driven());
}

TEST_F(DriveTest, IsSilentAndLimpWithoutPowerAndBootsWhenItReturns) {
  enable();
  drive->power_off();
  heard.clear();
  run_ms(100);
  EXPECT_FALSE(is_driven());
  EXPECT_TRUE(heard.empty());
  drive->power_on(now_us);
  controlword = 0;
  run_ms(60);
  ASSERT_FALSE(heard.empty());
  EXPECT_EQ(heard[0].identifier, 0x700 + kNode);
  EXPECT_EQ(drive->state(), State::kSwitchOnDisabled);
}

}  // namespace
}  // namespace koboshi::sim_board
