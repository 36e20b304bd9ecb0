#include <initializer_list>

#include "sim_board/can/bus_faults.h"
#include "tests/unit/sim_board/drive/drive_bench.h"

// A drive's reactions to the state of its own CAN controller.
namespace koboshi::sim_board {
namespace {

using hal::CanErrorState;

class DriveOnABadBus : public DriveTest {
 protected:
  DriveOnABadBus() { bus.set_disturbance(&faults); }
  // Errors in so many attempts of the drive to send.
  void corrupt(std::uint64_t count) {
    faults.add({.effect = FrameFault::Effect::kCorrupted,
                .node = drive->bus_handle(),
                .count = count,
                .from_us = now_us});
  }
  CanErrorState bus_state() const { return bus.status(drive->bus_handle()).state; }

  BusFaults faults{1};
};

// Behind the acceptance filter of its CAN controller a drive costs no time for frames of others.
TEST_F(DriveTest, HearsOnlyWhatItActsOn) {
  enable();
  const std::uint64_t before = bus.counters(drive->bus_handle()).received;
  for (const std::uint16_t identifier :
       std::initializer_list<std::uint16_t>{0x181, 0x201, 0x581, 0x601, 0x702})
    say({.identifier = identifier, .size = 8});
  run_ms(20);
  EXPECT_EQ(bus.counters(drive->bus_handle()).received - before, 5u) << "two SYNCs, two RPDOs, a heartbeat";
}

TEST_F(DriveTest, HearsThePdoThatItIsToldTo) {
  configure();
  syncs = false;
  write({0x1400, 1}, 0x8000'0000u + 0x200 + kNode, 4);
  write({0x1400, 2}, 255, 1);
  write({0x1400, 1}, 0x255, 4);
  say({.identifier = 0x255, .size = 6, .data = {0x06, 0x00, 0x39, 0x30}});
  run_ms(2);
  EXPECT_EQ(drive->values().controlword, 6);
  EXPECT_EQ(drive->values().target_position, 12345);
}

TEST_F(DriveOnABadBus, ReportsErrorPassiveAndContinues) {
  write({0x1800, 2}, 1, 1);  // answers each SYNC
  enable();
  corrupt(17);
  run_ms(20);
  EXPECT_EQ(bus_state(), CanErrorState::kErrorPassive);
  EXPECT_EQ(emergencies(), std::vector<std::uint16_t>{0x8120});
  EXPECT_EQ(drive->state(), State::kOperationEnabled);
  run_ms(200);  // a frame sent takes one off the count
  EXPECT_EQ(bus_state(), CanErrorState::kErrorActive);
  EXPECT_EQ(emergencies(), (std::vector<std::uint16_t>{0x8120, 0x0000}));
  EXPECT_EQ(drive->state(), State::kOperationEnabled);
}

TEST_F(DriveOnABadBus, StopsAtBusOffAndRecoversAfterAPause) {
  write({0x1800, 2}, 1, 1);
  enable();
  corrupt(40);
  run_ms(20);
  EXPECT_EQ(bus_state(), CanErrorState::kBusOff);
  EXPECT_EQ(drive->state(), State::kFaultReactionActive);
  EXPECT_EQ(drive->values().error_code, 0x8140);
  EXPECT_TRUE(emergencies().empty());
  run_ms(70);
  EXPECT_EQ(bus_state(), CanErrorState::kBusOff);
  run_ms(120);
  EXPECT_EQ(bus_state(), CanErrorState::kErrorActive);
  EXPECT_EQ(drive->state(), State::kFault);
  const auto told = emergencies();
  EXPECT_EQ(std::ranges::count(told, 0x8140), 1);
  controlword = cia402::kFaultReset;
  run_ms(20);
  EXPECT_EQ(drive->state(), State::kSwitchOnDisabled);
  EXPECT_EQ(emergencies().back(), 0);
}

TEST_F(DriveOnABadBus, FollowsItsOptionCodeAtBusOff) {
  write({0x6007, 0}, 0, 2);  // nothing
  write({0x1800, 2}, 1, 1);
  enable();
  corrupt(40);
  run_ms(20);
  EXPECT_EQ(bus_state(), CanErrorState::kBusOff);
  EXPECT_EQ(drive->state(), State::kOperationEnabled);
}

}  // namespace
}  // namespace koboshi::sim_board
