#include "tests/unit/sim_board/drive/drive_bench.h"

// The torque limit of a drive, 0x6072, and the gain of its position loop, 0x60FB:1.
namespace koboshi::sim_board {
namespace {

constexpr std::int32_t kFarAway = 500'000;  // from there the position loop asks for the whole supply

class DriveTorque : public DriveTest {
 protected:
  void SetUp() override {
    enable();
    target = kFarAway;  // the shaft is held
    run_ms(500);
  }
  double stall_Nm() const {
    const ServoDescription& servo = joint.servo;
    return servo.torque_constant_Nm_per_A * servo.supply_V / servo.resistance_ohm;
  }
};

TEST_F(DriveTorque, IsFullByDefault) {
  EXPECT_EQ(drive->values().max_torque_permille, 1'000);
  const double full_Nm = torque.drive_Nm;
  EXPECT_GT(full_Nm, 0.9 * stall_Nm());
  write({0x6072, 0}, 1'000, 2);
  run_ms(5);
  EXPECT_EQ(torque.drive_Nm, full_Nm);
}

TEST_F(DriveTorque, IsLimitedToAShareOfTheRatedTorque) {
  for (const std::uint32_t permille : {500u, 100u, 1u}) {
    write({0x6072, 0}, permille, 2);
    run_ms(5);
    EXPECT_NEAR(torque.drive_Nm, stall_Nm() * permille / 1'000, 1e-9);
    EXPECT_NEAR(drive->values().torque_actual_permille, permille, 1);
  }
  EXPECT_EQ(drive->state(), State::kOperationEnabled);
  EXPECT_EQ(torque.damping_Nm_s > 0.1, true) << "still driven";
}

TEST_F(DriveTorque, OfZeroLetsTheShaftTurnFreelyWithoutAFault) {
  write({0x6072, 0}, 0, 2);
  run_ms(5);
  EXPECT_FALSE(is_driven());
  write({0x6065, 0}, 1'000, 4);  // the following error is watched
  write({0x6066, 0}, 10, 2);
  shaft.position_rad = -0.5;
  run_ms(500);
  EXPECT_FALSE(is_driven());
  EXPECT_EQ(torque.drive_Nm, 0.0);
  EXPECT_EQ(drive->state(), State::kOperationEnabled);
  EXPECT_TRUE(cia402::follows_command(drive->values().statusword));
  EXPECT_EQ(emergencies(), std::vector<std::uint16_t>{}) << "neither blocked nor lagging";
  EXPECT_EQ(drive->values().following_error, 0);
  target = drive->values().position_actual;
  run_ms(2'000);  // the demand, which had gone far away, comes back by its profile
  write({0x6072, 0}, 1'000, 2);
  run_ms(20);
  EXPECT_TRUE(is_driven());
  EXPECT_NEAR(torque.drive_Nm, 0.0, 0.01 * stall_Nm()) << "no jerk from where the shaft is";
}

TEST_F(DriveTorque, RefusesWhatIsOutOfRange) {
  EXPECT_EQ(abort_of({0x6072, 0}, 1'001, 2), 0x0609'0031u);
  EXPECT_EQ(abort_of({0x6072, 0}, 500, 4), 0x0607'0012u);
  EXPECT_EQ(abort_of({0x6072, 0}, 5, 1), 0x0607'0013u);
  EXPECT_EQ(abort_of({0x6072, 1}, 500, 2), 0x0609'0011u);
  EXPECT_EQ(drive->values().max_torque_permille, 1'000);
}

// The torque at the start of a motor that is held a little away from its target.
TEST_F(DriveTorque, GrowsWithTheGainOfThePositionLoop) {
  constexpr std::int32_t kNear = 5'000;  // 1.7 degrees
  target = kNear;
  run_ms(2'000);
  const double own_Nm = torque.drive_Nm;
  ASSERT_GT(own_Nm, 0.02 * stall_Nm());
  ASSERT_LT(own_Nm, 0.4 * stall_Nm());
  for (const std::uint32_t permille : {2'000u, 500u, 100u, 1u}) {
    write({0x60FB, 1}, permille, 2);
    run_ms(5);
    EXPECT_NEAR(torque.drive_Nm, own_Nm * permille / 1'000, 1e-9) << permille;
  }
  write({0x60FB, 1}, 500, 2);
  target = kFarAway;
  run_ms(2'000);
  EXPECT_GT(torque.drive_Nm, 0.9 * stall_Nm()) << "the gain is no limit of the torque";
}

TEST_F(DriveTorque, GainRefusesWhatIsOutOfRangeAndIsItsOwnAfterAReset) {
  EXPECT_EQ(drive->values().position_gain_permille, 1'000);
  EXPECT_EQ(abort_of({0x60FB, 1}, 0, 2), 0x0609'0032u);
  EXPECT_EQ(abort_of({0x60FB, 1}, 2'001, 2), 0x0609'0031u);
  EXPECT_EQ(abort_of({0x60FB, 1}, 500, 4), 0x0607'0012u);
  write({0x60FB, 1}, 200, 2);
  EXPECT_EQ(drive->values().position_gain_permille, 200);
  say({.identifier = 0x000, .size = 2, .data = {0x81, kNode}});
  run_ms(5);
  EXPECT_EQ(drive->values().position_gain_permille, 1'000);
}

TEST_F(DriveTorque, IsFullAgainAfterAReset) {
  write({0x6072, 0}, 200, 2);
  EXPECT_EQ(drive->values().max_torque_permille, 200);
  say({.identifier = 0x000, .size = 2, .data = {0x81, kNode}});
  run_ms(5);
  EXPECT_EQ(drive->values().max_torque_permille, 1'000);
}

}  // namespace
}  // namespace koboshi::sim_board
