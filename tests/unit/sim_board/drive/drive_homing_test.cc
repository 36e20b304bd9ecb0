#include <array>

#include "tests/unit/sim_board/drive/drive_bench.h"

// Homing mode of the drive, CiA 402-2, by methods 35 and 37.
namespace koboshi::sim_board {
namespace {

constexpr std::uint16_t kEnabledForHoming = cia402::kControlEnableOperation;
constexpr std::uint16_t kStartsHoming = kEnabledForHoming | cia402::kStartHoming;
constexpr std::int32_t kHomingShaft = 4'096;  // where it stands
constexpr std::uint16_t kHomingBits = cia402::kTargetReached | cia402::kHomingAttained | cia402::kHomingError;

class HomingDriveTest : public DriveTest {
 protected:
  HomingDriveTest() { shaft.position_rad = kHomingShaft * kRadPerPositionUnit; }

  void enable_homing(std::uint32_t offset, std::uint8_t method = 37) {
    configure();
    write({0x6060, 0}, 6, 1);
    write({0x6098, 0}, method, 1);
    write({0x607C, 0}, offset, 4);
    command(kWayToOperation[0]);
    command(kWayToOperation[1]);
    command(kWayToOperation[2]);
    ASSERT_EQ(drive->state(), State::kOperationEnabled);
    ASSERT_EQ(drive->values().mode_display, cia402::kHoming);
  }
  void command(std::uint16_t word) {
    controlword = word;
    run_ms(12);
  }
  std::uint16_t homing_bits() const { return drive->values().statusword & kHomingBits; }
  std::int32_t position() const { return drive->values().position_actual; }
};

TEST_F(HomingDriveTest, OffersItsMethods) {
  EXPECT_EQ(abort_of({0x6098, 0}, 35, 1), 0u);
  EXPECT_EQ(abort_of({0x6098, 0}, 37, 1), 0u);
  EXPECT_EQ(abort_of({0x6098, 0}, 1, 1), 0x0609'0030u);
  EXPECT_EQ(abort_of({0x6060, 0}, 6, 1), 0u);
}

TEST_F(HomingDriveTest, WaitsForItsStart) {
  enable_homing(1'000);
  run_ms(50);
  EXPECT_EQ(homing_bits(), cia402::kTargetReached);
  EXPECT_EQ(position(), kHomingShaft);
}

TEST_F(HomingDriveTest, MakesThePresentPositionHome) {
  for (const std::uint8_t method : std::to_array<std::uint8_t>({35, 37})) {
    enable_homing(1'000 * method, method);
    command(kStartsHoming);
    EXPECT_EQ(homing_bits(), cia402::kTargetReached | cia402::kHomingAttained);
    EXPECT_EQ(position(), 1'000 * method);
    EXPECT_EQ(drive->values().position_demand, 1'000 * method);
    command(kEnabledForHoming);
    EXPECT_EQ(homing_bits(), cia402::kTargetReached | cia402::kHomingAttained);
    command(0);
  }
}

TEST_F(HomingDriveTest, DoesNotMoveTheShaft) {
  enable_homing(500'000);
  const double before_Nm = torque.drive_Nm;
  command(kStartsHoming);
  run_ms(20);
  EXPECT_NEAR(torque.drive_Nm, before_Nm, 1e-9);
  EXPECT_EQ(drive->values().following_error, 0);
}

TEST_F(HomingDriveTest, StartsWithTheRisingEdge) {
  enable_homing(1'000);
  command(kStartsHoming);
  shaft.position_rad = 2 * kHomingShaft * kRadPerPositionUnit;
  run_ms(12);
  EXPECT_EQ(position(), 1'000 + kHomingShaft);  // the bit stays: nothing starts
  command(kEnabledForHoming);
  command(kStartsHoming);
  EXPECT_EQ(position(), 1'000);
}

TEST_F(HomingDriveTest, UsesTheHomePositionInOtherModes) {
  enable_homing(0);
  command(kStartsHoming);
  target = 0;
  command(kEnabledForHoming);
  write({0x6060, 0}, 8, 1);
  run_ms(30);
  ASSERT_EQ(drive->values().mode_display, cia402::kCyclicSynchronousPosition);
  target = 1'000;
  run_ms(30);
  EXPECT_EQ(drive->values().position_demand, 1'000);
  EXPECT_EQ(position(), 0);
  EXPECT_EQ(drive->values().following_error, 1'000);
}

TEST_F(HomingDriveTest, DoesNotRestartWhenItsModeReturns) {
  enable_homing(0);
  command(kStartsHoming);
  command(kEnabledForHoming);
  write({0x6060, 0}, 1, 1);
  run_ms(20);
  write({0x6060, 0}, 6, 1);
  run_ms(20);
  EXPECT_EQ(homing_bits(), cia402::kTargetReached);
}

TEST_F(HomingDriveTest, ClearsHomeAtReset) {
  enable_homing(0);
  command(kStartsHoming);
  ASSERT_EQ(position(), 0);
  command(0);
  heartbeats = syncs = false;
  say({.identifier = 0x000, .size = 2, .data = {0x81, kNode}});
  run_ms(5);
  EXPECT_EQ(position(), kHomingShaft);
}

}  // namespace
}  // namespace koboshi::sim_board
