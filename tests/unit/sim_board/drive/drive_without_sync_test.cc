#include "tests/unit/sim_board/drive/drive_bench.h"

// A master that sends no SYNC, or seldom: the drive obeys it and tells the truth nevertheless.
namespace koboshi::sim_board {
namespace {

class DriveWithoutSync : public DriveTest {
 protected:
  void start() { say({.identifier = 0x000, .size = 2, .data = {1, kNode}}); }
  // By RPDO 1 as it is after a reset: a controlword, event-driven.
  void tell(std::uint16_t word) {
    hal::CanFrame frame{.identifier = 0x200 + kNode, .size = 2};
    canopen::store_u16(frame.data.data(), word);
    say(frame);
    run_ms(2);
  }
  State shown() const { return cia402::state_of(drive->values().statusword); }
};

TEST_F(DriveWithoutSync, ShowsTheEffectOfAControlwordBySdoAtOnceInPreOperational) {
  EXPECT_EQ(shown(), State::kSwitchOnDisabled);
  for (const State state : {State::kReadyToSwitchOn, State::kSwitchedOn, State::kOperationEnabled}) {
    write({0x6040, 0}, kWayToOperation[static_cast<int>(state) - 2], 2);
    EXPECT_EQ(drive->state(), state);
    EXPECT_EQ(shown(), state);
  }
  EXPECT_NE(drive->values().statusword & cia402::kVoltageEnabled, 0);
  write({0x6040, 0}, cia402::kControlDisableVoltage, 2);
  EXPECT_EQ(shown(), State::kSwitchOnDisabled);
}

TEST_F(DriveWithoutSync, ShowsThatAFaultIsReset) {
  enable();
  syncs = false;
  run_ms(300);
  ASSERT_EQ(shown(), State::kFault);
  say({.identifier = 0x000, .size = 2, .data = {128, kNode}});
  run_ms(2);
  write({0x6040, 0}, cia402::kFaultReset, 2);
  EXPECT_EQ(drive->state(), State::kSwitchOnDisabled);
  EXPECT_EQ(shown(), State::kSwitchOnDisabled);
  EXPECT_EQ(drive->values().error_code, 0);
}

TEST_F(DriveWithoutSync, ShowsItsEnableLine) {
  drive->set_enable_line(false);
  run_ms(1);
  EXPECT_NE(drive->values().statusword & cia402::kTorqueOff, 0);
}

TEST_F(DriveWithoutSync, ShowsDemandAndShaftBetweenTwoSyncs) {
  write({0x60C2, 1}, 200, 1);
  enable();
  write({0x1006, 0}, 0, 4);  // nobody misses the SYNC
  while (now_us % kCycle_us != 0) run_ms(1);
  target = 20'000;
  run_ms(11);  // one SYNC with it
  syncs = false;
  std::int32_t before = drive->values().position_demand;
  for (int i = 0; i < 10; ++i) {
    shaft.position_rad += 0.01;
    run_ms(10);
    EXPECT_NEAR(drive->values().position_demand - before, 1'000, 100);
    before = drive->values().position_demand;
    EXPECT_NEAR(drive->values().position_actual, shaft.position_rad / kRadPerPositionUnit, 300);
  }
}

// A stream of targets that has ended is no motion any more, though its last target was not the one before.
TEST_F(DriveWithoutSync, ChangesItsModeWhenTheTargetsHaveEnded) {
  enable();
  write({0x1006, 0}, 0, 4);  // nobody misses the SYNC
  for (int i = 0; i < 5; ++i) {
    target += 1'000;
    run_ms(10);
  }
  write({0x6060, 0}, cia402::kProfilePosition, 1);
  target += 1'000;
  run_ms(10);
  EXPECT_EQ(drive->values().mode_display, cia402::kCyclicSynchronousPosition);  // not between two targets
  syncs = false;
  run_ms(21);  // the last way, and the time for the next target to come
  EXPECT_EQ(drive->values().mode_display, cia402::kProfilePosition);
}

TEST_F(DriveWithoutSync, ObeysAnEventDrivenRpdoAtOnce) {
  start();
  for (const std::uint16_t word : kWayToOperation) tell(word);
  EXPECT_EQ(drive->state(), State::kOperationEnabled);
  EXPECT_EQ(shown(), State::kOperationEnabled);
  tell(cia402::kControlQuickStop);
  EXPECT_EQ(shown(), State::kQuickStopActive);
  tell(cia402::kControlDisableVoltage);
  EXPECT_EQ(shown(), State::kSwitchOnDisabled);
  EXPECT_FALSE(is_driven());
}

TEST_F(DriveWithoutSync, SendsEveryChangeOfItsStatuswordByTpdo1) {
  heard.clear();
  start();
  run_ms(100);
  for (const std::uint16_t word : {cia402::kControlShutdown, cia402::kControlSwitchOn}) {
    tell(word);
    run_ms(100);
  }
  drive->set_enable_line(false);
  run_ms(100);
  std::vector<std::uint16_t> words;
  for (const hal::CanFrame& frame : heard) {
    if (frame.identifier == 0x180 + kNode) words.push_back(canopen::load_u16(frame.data.data()));
  }
  EXPECT_EQ(words, (std::vector<std::uint16_t>{0x0250, 0x0231, 0x0233, 0x4250}));
}

// The position has the encoder's noise; the inhibit time keeps it from filling the bus.
TEST_F(DriveWithoutSync, DoesNotFloodTheBusWithAPosition) {
  write({0x1A01, 1}, 0x6064'0020, 4);
  write({0x1A01, 0}, 1, 1);
  write({0x1801, 1}, 0x4000'0000u + 0x280 + kNode, 4);
  start();
  heard.clear();
  for (int i = 0; i < 500; ++i) {
    shaft.position_rad += 0.002;
    run_ms(1);
  }
  const auto told = std::ranges::count(heard, std::uint32_t{0x280 + kNode}, [](const hal::CanFrame& frame) {
    return std::uint32_t{frame.identifier};
  });
  EXPECT_GE(told, 45);
  EXPECT_LE(told, 51);
}

TEST_F(DriveWithoutSync, ProcessesEveryControlwordBetweenTwoSyncs) {
  start();
  say({.identifier = 0x080});
  run_ms(1);
  for (const std::uint16_t word : kWayToOperation)
    say({.identifier = 0x200 + kNode, .size = 2, .data = {static_cast<std::uint8_t>(word), 0}});
  run_ms(2);
  EXPECT_EQ(drive->state(), State::kOperationEnabled);
}

TEST_F(DriveWithoutSync, DefersASynchronousRpdo) {
  write({0x1400, 2}, 1, 1);
  start();
  tell(cia402::kControlShutdown);
  run_ms(100);
  EXPECT_EQ(drive->state(), State::kSwitchOnDisabled);
  say({.identifier = 0x080});
  run_ms(2);
  EXPECT_EQ(drive->state(), State::kReadyToSwitchOn);
}

}  // namespace
}  // namespace koboshi::sim_board
