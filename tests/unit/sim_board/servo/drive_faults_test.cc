#include "tests/unit/sim_board/servo/drive_bench.h"

// Faults that a drive finds in its servo, each with its emergency.
namespace koboshi::sim {
namespace {

TEST_F(DriveTest, WatchesNoFollowingErrorUnlessItIsToldTo) {
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

}  // namespace
}  // namespace koboshi::sim
