#include <algorithm>

#include "tests/unit/sim_board/drive/drive_bench.h"

// Profile position mode of the drive, CiA 402-2.
namespace koboshi::sim_board {
namespace {

constexpr std::uint16_t kEnabled = cia402::kControlEnableOperation;

// Here the shaft is where the drive asks it to be.
class ProfileDriveTest : public DriveTest {
 protected:
  void enable_profile() {
    configure();
    write({0x6060, 0}, 1, 1);
    write({0x6081, 0}, 100'000, 4);
    write({0x6083, 0}, 1'000'000, 4);
    write({0x6084, 0}, 500'000, 4);
    for (const std::uint16_t word : kWayToOperation) {
      controlword = word;
      run_ms(12);
    }
    ASSERT_EQ(drive->state(), State::kOperationEnabled);
    ASSERT_EQ(drive->values().mode_display, cia402::kProfilePosition);
  }
  void follow_ms(int duration_ms) {
    for (int i = 0; i < duration_ms; ++i) {
      run_ms(1);
      shaft.position_rad = demand() * kRadPerPositionUnit;
    }
  }
  // Gives a set-point and waits for its acknowledge.
  void give(std::int32_t position, std::uint16_t bits = 0) {
    target = position;
    controlword = static_cast<std::uint16_t>(kEnabled | cia402::kNewSetPoint | bits);
    follow_ms(12);
  }
  void release(std::uint16_t bits = 0) {
    controlword = static_cast<std::uint16_t>(kEnabled | bits);
    follow_ms(12);
  }
  bool shows(std::uint16_t bit) const { return (drive->values().statusword & bit) != 0; }
  std::int32_t demand() const { return drive->values().position_demand; }
};

// CiA 402-2 asks this of a drive with the mode.
TEST_F(ProfileDriveTest, HasAMotionProfileTypeThatIsLinear) {
  EXPECT_EQ(abort_of({0x6086, 0}, 0, 2), 0u);
  EXPECT_EQ(abort_of({0x6086, 0}, 3, 2), 0x0609'0031u);
}

TEST_F(ProfileDriveTest, ReportsItsFollowingErrorOnTheBus) {
  enable_profile();
  target = 50'000;
  controlword = static_cast<std::uint16_t>(kEnabled | cia402::kNewSetPoint);
  run_ms(200);  // the shaft stays where it is
  heard.clear();
  say({.identifier = 0x600 + kNode, .size = 8, .data = {0x40, 0xF4, 0x60, 0x00}});
  run_ms(2);
  const auto answer = std::ranges::find(heard, 0x580 + kNode, &hal::CanFrame::identifier);
  ASSERT_NE(answer, heard.end());
  EXPECT_EQ(answer->data[0], 0x43);
  EXPECT_NEAR(canopen::load_u32(&answer->data[4]), demand(), 500);
  EXPECT_GT(demand(), 5'000);
}

TEST_F(ProfileDriveTest, MovesOnTheRisingEdgeOfANewSetPointOnly) {
  enable_profile();
  target = 50'000;
  follow_ms(50);
  EXPECT_EQ(demand(), 0);
  EXPECT_TRUE(shows(cia402::kTargetReached));
  give(50'000);
  EXPECT_TRUE(shows(cia402::kSetPointAcknowledge));
  EXPECT_FALSE(shows(cia402::kTargetReached));
  follow_ms(1'000);
  EXPECT_EQ(demand(), 50'000);
  EXPECT_TRUE(shows(cia402::kTargetReached));
  EXPECT_TRUE(shows(cia402::kSetPointAcknowledge));  // for as long as bit 4 is set
  target = 10'000;
  follow_ms(50);
  EXPECT_EQ(demand(), 50'000);
  release();
  EXPECT_FALSE(shows(cia402::kSetPointAcknowledge));
}

// 0.1 s and 5'000 units up, 0.2 s and 10'000 down, 0.35 s and 35'000 at the profile's velocity.
TEST_F(ProfileDriveTest, TakesTheDurationOfItsProfile) {
  enable_profile();
  target = 50'000;
  controlword = kEnabled | cia402::kNewSetPoint;
  while (!shows(cia402::kSetPointAcknowledge) && now_us < 2'000'000) follow_ms(1);
  const std::uint64_t start_us = now_us;
  std::int32_t fastest = 0;
  while (!shows(cia402::kTargetReached) && now_us < 2'000'000) {
    const std::int32_t before = demand();
    follow_ms(1);
    fastest = std::max(fastest, demand() - before);
  }
  EXPECT_NEAR(static_cast<double>(now_us - start_us), 650'000.0, 1'000.0);
  EXPECT_EQ(fastest, 100);  // units/ms
}

TEST_F(ProfileDriveTest, FinishesASetPointBeforeTheNextOne) {
  enable_profile();
  give(50'000);
  release();
  give(20'000);
  EXPECT_TRUE(shows(cia402::kSetPointAcknowledge));
  release();
  EXPECT_TRUE(shows(cia402::kSetPointAcknowledge));  // one on its way, one waits: there is no room
  give(-70'000);                                     // too many: ignored
  release();
  std::int32_t furthest = 0;
  for (int i = 0; i < 2'000; ++i) {
    follow_ms(1);
    furthest = std::max(furthest, demand());
  }
  EXPECT_EQ(furthest, 50'000);
  EXPECT_EQ(demand(), 20'000);
  EXPECT_FALSE(shows(cia402::kSetPointAcknowledge));
}

TEST_F(ProfileDriveTest, ChangesToASetPointImmediately) {
  enable_profile();
  give(50'000);
  follow_ms(200);
  const std::int32_t turning_point = demand();
  release();
  give(0, cia402::kChangeImmediately);
  release();
  std::int32_t furthest = 0;
  for (int i = 0; i < 1'500; ++i) {
    follow_ms(1);
    furthest = std::max(furthest, demand());
  }
  EXPECT_LT(furthest, turning_point + 14'000);  // 10'000 of braking, and the hand-shake
  EXPECT_EQ(demand(), 0);
}

TEST_F(ProfileDriveTest, AddsARelativeSetPointToTheLastOneWithinItsLimits) {
  enable_profile();
  write({0x607D, 2}, 25'000, 4);
  for (const std::int32_t expected : {10'000, 20'000, 25'000}) {
    give(10'000, cia402::kRelative);
    release();
    follow_ms(500);
    EXPECT_EQ(demand(), expected);
  }
  EXPECT_EQ(drive->values().target_position, 10'000);
}

TEST_F(ProfileDriveTest, HaltsOnTheRampOfItsOptionAndContinues) {
  for (const std::uint16_t option : {std::uint16_t{1}, std::uint16_t{2}}) {
    controlword = 0;
    enable_profile();
    write({0x605D, 0}, option, 2);
    give(demand() + 50'000);
    const std::int32_t end = drive->values().target_position;
    follow_ms(200);
    const std::int32_t before = demand();
    controlword |= cia402::kHalt;
    follow_ms(300);
    const std::int32_t halted = demand();
    EXPECT_TRUE(shows(cia402::kTargetReached));  // in a halt: it stands
    EXPECT_EQ(drive->state(), State::kOperationEnabled);
    // 10'000 units of the profile's ramp; the quick stop is sixteen times as steep, and the SYNC comes late.
    EXPECT_EQ(halted - before > 5'000, option == 1);
    follow_ms(300);
    EXPECT_EQ(demand(), halted);
    release();
    EXPECT_FALSE(shows(cia402::kTargetReached));
    follow_ms(800);
    EXPECT_EQ(demand(), end);
  }
}

TEST_F(ProfileDriveTest, ReportsTargetReachedAfterTheWindowTime) {
  enable_profile();
  write({0x6067, 0}, 1'000, 4);
  write({0x6068, 0}, 40, 2);
  give(50'000);
  run_ms(1'000);  // the shaft is held
  EXPECT_EQ(demand(), 50'000);
  EXPECT_FALSE(shows(cia402::kTargetReached));
  shaft.position_rad = 49'200 * kRadPerPositionUnit;
  run_ms(35);
  EXPECT_FALSE(shows(cia402::kTargetReached));
  run_ms(10);
  EXPECT_TRUE(shows(cia402::kTargetReached));
}

TEST_F(ProfileDriveTest, ChangesItsModeInOperationOnlyAtRest) {
  enable_profile();
  give(50'000);
  follow_ms(100);
  write({0x6060, 0}, 8, 1);
  follow_ms(100);
  EXPECT_EQ(drive->values().mode, 8);
  EXPECT_EQ(drive->values().mode_display, 1);
  follow_ms(800);
  EXPECT_EQ(drive->values().mode_display, 8);
  target = 51'000;
  follow_ms(30);
  EXPECT_EQ(demand(), 51'000);
  write({0x6060, 0}, 1, 1);
  target = 0;
  follow_ms(30);
  EXPECT_EQ(drive->values().mode_display, 1);
  EXPECT_GE(demand(), 50'000);
}

TEST_F(ProfileDriveTest, RejectsUnsupportedModesAndOptions) {
  struct Refusal {
    ObjectAddress object;
    std::uint32_t value;
    std::size_t size;
  };
  for (const auto& [object, value, size] :
       {Refusal{{0x6060, 0}, 3, 1}, Refusal{{0x6060, 0}, 0xFF, 1}, Refusal{{0x605D, 0}, 3, 2},
        Refusal{{0x605A, 0}, 9, 2}, Refusal{{0x605A, 0}, 0xFFFF, 2}, Refusal{{0x605B, 0}, 2, 2},
        Refusal{{0x605C, 0}, 2, 2}, Refusal{{0x605E, 0}, 3, 2}, Refusal{{0x605E, 0}, 0xFFFF, 2}}) {
    EXPECT_EQ(abort_of(object, value, size), 0x0609'0030u) << object.index;
  }
}

}  // namespace
}  // namespace koboshi::sim_board
