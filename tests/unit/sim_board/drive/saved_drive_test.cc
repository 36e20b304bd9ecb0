#include "tests/unit/sim_board/drive/drive_bench.h"

// A drive that is restored does what it did before, to the bit.
namespace koboshi::sim_board {
namespace {

JointDescription with_everything() {
  JointDescription joint;
  joint.encoder.noise_counts = 0.7;
  joint.servo.command.read_delay_ms = 3;
  joint.servo.command.write_delay_ms = 2;
  joint.servo.backlash_rad = 0.01;
  joint.servo.winding = {.thermal_resistance_K_per_W = 10.0, .heat_capacity_J_per_K = 5.0};
  joint.servo.voltmeter = {.noise = 0.1, .highest = 12.0, .resolution = 0.01};
  return joint;
}

class SavedDriveTest : public DriveTest {
 protected:
  SavedDriveTest() : DriveTest(with_everything()) {}

  struct Told {
    std::vector<hal::CanFrame> frames;
    std::vector<double> torques_Nm;
    bool operator==(const Told&) const = default;
  };
  SavedState save() {
    return StateArchive::save(bus, drive, shaft, now_us, controlword, target, heartbeats, syncs);
  }
  void restore(const SavedState& saved) {
    StateArchive::restore(saved, bus, drive, shaft, now_us, controlword, target, heartbeats, syncs);
  }
  // A shaft that follows with some lag.
  Told go_ms(int duration_ms) {
    heard.clear();
    Told told;
    for (int i = 0; i < duration_ms; ++i) {
      run_ms(1);
      shaft.position_rad +=
          0.1 * (drive->values().position_demand * kRadPerPositionUnit - shaft.position_rad);
      shaft.speed_rad_per_s = 0.5;
      shaft.servo_Nm = torque.drive_Nm;
      told.torques_Nm.insert(told.torques_Nm.end(),
                             {torque.drive_Nm, torque.damping_Nm_s, torque.friction_Nm});
    }
    told.frames = heard;
    return told;
  }
};

TEST_F(SavedDriveTest, ContinuesInTheMiddleOfAProfile) {
  configure();
  write({0x6060, 0}, 1, 1);
  write({0x6081, 0}, 100'000, 4);
  for (const std::uint16_t word : kWayToOperation) {
    controlword = word;
    run_ms(12);
  }
  target = 50'000;
  controlword = cia402::kControlEnableOperation | cia402::kNewSetPoint;
  go_ms(137);
  ASSERT_GT(drive->values().position_demand, 0);
  ASSERT_LT(drive->values().position_demand, 50'000);
  const SavedState saved = save();
  const Told first = go_ms(150);
  target = -50'000;
  controlword = cia402::kControlEnableOperation;
  go_ms(33);
  drive->overheat();
  drive->break_encoder();
  go_ms(20);
  drive->power_off();
  go_ms(5);
  drive->power_on(now_us);
  go_ms(70);
  restore(saved);
  EXPECT_EQ(go_ms(150), first);
}

TEST_F(SavedDriveTest, HearsAgainWhatItHeard) {
  enable();
  const SavedState saved = save();
  const Told first = go_ms(50);
  write({0x1400, 1}, 0x8000'0000u + 0x200 + kNode, 4);
  write({0x1016, 1}, 0, 4);
  go_ms(50);
  restore(saved);
  EXPECT_EQ(go_ms(50), first);
}

// Its parameters are in flash when it is restored to a time before they were, and again half written.
TEST_F(SavedDriveTest, ContinuesWhileStoringItsParameters) {
  const SavedState fresh = save();
  configure();
  write({0x6065, 0}, 1234, 4);
  say({.identifier = 0x600 + kNode, .size = 8, .data = {0x23, 0x10, 0x10, 0x01, 's', 'a', 'v', 'e'}});
  go_ms(11);
  const SavedState storing = save();
  const Told first = go_ms(400);
  const auto reset = [&] {
    say({.identifier = 0x000, .size = 2, .data = {0x81, kNode}});
    go_ms(100);
    return drive->values().following_window;
  };
  EXPECT_EQ(reset(), 1234u);
  restore(fresh);
  EXPECT_EQ(reset(), kWindowOff);
  restore(storing);
  EXPECT_EQ(go_ms(400), first);
  EXPECT_EQ(reset(), 1234u);
}

}  // namespace
}  // namespace koboshi::sim_board
