#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/controller_bench.h"

namespace koboshi::app {
namespace {

using drive::DriveFault;
using test::ControllerBench;
using DriveState = canopen::cia402::State;

constexpr std::uint16_t kQuickStop = 0x02;
constexpr std::uint16_t kDisableVoltage = 0x00;

class ControllerFault : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(bench.run_until_standing());
    bench.command(Command::kPlay, 1);
    ASSERT_EQ(bench.now().state, State::kMotion);
    bench.run_ms(100);
  }
  void expect_drive_fault(DriveFault kind, std::uint8_t joint) const {
    EXPECT_EQ(bench.now().reason, Reason::kDriveFault);
    EXPECT_EQ(bench.now().drive_fault, kind);
    EXPECT_EQ(bench.now().faulty_joint, joint);
  }

  ControllerBench bench;
};

TEST_F(ControllerFault, StopsTheDrivesFirstAndThenLowersTheLine) {
  auto& slow = bench.drives[3];
  slow.hangs = true;  // a drive that never reports the end of its quick stop
  ASSERT_TRUE(bench.run_until(State::kFault, 100));
  EXPECT_EQ(bench.drives[0].controlword, kQuickStop);  // in the cycle that detected the fault
  EXPECT_TRUE(bench.board.drive_enable.enabled());
  bench.run_ms(290);
  EXPECT_TRUE(bench.board.drive_enable.enabled());
  bench.run_ms(10);
  EXPECT_FALSE(bench.board.drive_enable.enabled());
}

TEST_F(ControllerFault, LowersTheLineAsSoonAsAllHaveStopped) {
  bench.imu_speaks = false;
  ASSERT_TRUE(bench.run_until(State::kFault, 100));
  EXPECT_TRUE(bench.board.drive_enable.enabled());
  bench.run_ms(10);  // the stubs stop at once
  EXPECT_FALSE(bench.board.drive_enable.enabled());
}

TEST_F(ControllerFault, NamesADriveThatHangs) {
  bench.drives[11].hangs = true;
  ASSERT_TRUE(bench.run_until(State::kFault, 60));  // five cycles, long before the heartbeat time-out
  expect_drive_fault(DriveFault::kLost, 11);
}

TEST_F(ControllerFault, NamesADriveWhoseHeartbeatStopsWhileItStillAnswers) {
  bench.run_ms(10);
  // Object 0x1016 monitors heartbeats: a drive is lost after 350 ms without one. The stubs send one every 100
  // ms.
  for (auto& drive : bench.drives) drive.beats = false;
  ASSERT_TRUE(bench.run_until(State::kFault, 460));
  EXPECT_EQ(bench.now().drive_fault, DriveFault::kLost);
}

TEST_F(ControllerFault, NamesADriveThatStartedAnew) {
  bench.board.can.deliver(bench.drives[2].boot_up());
  ASSERT_TRUE(bench.run_until(State::kFault, 10));
  expect_drive_fault(DriveFault::kRestarted, 2);
}

TEST_F(ControllerFault, NamesADriveThatReportsAnEmergency) {
  bench.board.can.deliver(bench.drives[6].emergency(0x2310));
  ASSERT_TRUE(bench.run_until(State::kFault, 10));
  expect_drive_fault(DriveFault::kFault, 6);
  EXPECT_EQ(bench.now().drive_error_code, 0x2310);
}

TEST_F(ControllerFault, NamesADriveWhoseStatuswordShowsAFault) {
  bench.drives[6].state = DriveState::kFault;
  ASSERT_TRUE(bench.run_until(State::kFault, 21));
  expect_drive_fault(DriveFault::kFault, 6);
}

TEST_F(ControllerFault, DoesNotReEnableADriveThatLeftOperation) {
  bench.drives[8].state = DriveState::kSwitchOnDisabled;
  ASSERT_TRUE(bench.run_until(State::kFault, 21));
  expect_drive_fault(DriveFault::kNotEnabled, 8);
  EXPECT_EQ(bench.drives[8].state, DriveState::kSwitchOnDisabled);
  EXPECT_EQ(bench.drives[0].controlword, kQuickStop);
  bench.run_ms(100);
  EXPECT_EQ(bench.drives[8].state, DriveState::kSwitchOnDisabled);
}

TEST_F(ControllerFault, NamesADriveThatNoLongerFollowsItsTargets) {
  bench.drives[8].follows = false;
  ASSERT_TRUE(bench.run_until(State::kFault, 21));
  expect_drive_fault(DriveFault::kNotFollowing, 8);
  EXPECT_EQ(bench.drives[8].controlword, kQuickStop);
  EXPECT_EQ(bench.drives[0].controlword, kQuickStop);
}

TEST_F(ControllerFault, KeepsTheFirstDriveFaultAndCountsOneFault) {
  bench.board.can.deliver(bench.drives[6].emergency(0x2310));
  ASSERT_TRUE(bench.run_until(State::kFault, 10));
  bench.drives[1].hangs = true;
  bench.imu_speaks = false;
  bench.run_ms(500);
  expect_drive_fault(DriveFault::kFault, 6);
  EXPECT_EQ(bench.now().faults, 1);
}

TEST_F(ControllerFault, ComesFromAnInertialUnitThatStops) {
  bench.imu_speaks = false;
  EXPECT_FALSE(bench.run_until(State::kFault, 50));
  ASSERT_TRUE(bench.run_until(State::kFault, 20));
  EXPECT_EQ(bench.now().reason, Reason::kImuSilent);
  EXPECT_EQ(bench.now().drive_fault, DriveFault::kNone);
}

TEST_F(ControllerFault, ComesFromEitherAnkle) {
  bench.ankle_speaks[0] = false;
  ASSERT_TRUE(bench.run_until(State::kFault, 70));
  EXPECT_EQ(bench.now().reason, Reason::kAnkleSilent);
}

TEST_F(ControllerFault, ComesFromBusOffAndTriesToRecover) {
  bench.board.can.set_error_state(hal::CanErrorState::kBusOff);
  bench.run_ms(10);
  EXPECT_EQ(bench.now().state, State::kFault);
  EXPECT_EQ(bench.now().reason, Reason::kBusOff);
  EXPECT_GE(bench.board.can.recoveries(), 1);
}

TEST_F(ControllerFault, DoesNotComeFromABusThatIsDisturbedButWorks) {
  bench.board.can.set_error_state(hal::CanErrorState::kErrorPassive);
  bench.run_ms(500);
  EXPECT_EQ(bench.now().state, State::kMotion);
  EXPECT_TRUE(std::ranges::any_of(bench.sent, [](const auto& sent) {
    return sent.frame.identifier == 0x081 && canopen::load_u16(sent.frame.data.data()) == 0x8120;
  }));
}

TEST_F(ControllerFault, ComesFromABusWithoutAcknowledgement) {
  for (auto& drive : bench.drives) drive.hangs = true;
  bench.run_ms(10);  // one cycle without any answer
  EXPECT_EQ(bench.now().state, State::kMotion);
  bench.board.can.set_error_state(hal::CanErrorState::kErrorPassive);
  bench.run_ms(10);
  EXPECT_EQ(bench.now().reason, Reason::kNoAcknowledge);
  EXPECT_TRUE(std::ranges::any_of(bench.sent, [](const auto& sent) {
    return sent.frame.identifier == 0x081 && canopen::load_u16(sent.frame.data.data()) == 0x8120;
  }));
}

TEST_F(ControllerFault, ComesFromANodeThatAPcStopped) {
  bench.board.can.deliver({.identifier = 0x000, .size = 2, .data = {128, 1}});  // enter pre-operational
  ASSERT_TRUE(bench.run_until(State::kFault, 10));
  EXPECT_EQ(bench.now().reason, Reason::kNotOperational);
  bench.run_ms(310);
  EXPECT_FALSE(bench.board.drive_enable.enabled());
}

TEST_F(ControllerFault, IsLeftOnlyByResetAndThenThroughABoot) {
  bench.board.can.deliver(bench.drives[6].emergency(0x2310));
  ASSERT_TRUE(bench.run_until(State::kFault, 10));
  bench.run_ms(1'000);
  EXPECT_EQ(bench.now().state, State::kFault);
  bench.sent.clear();
  bench.command(Command::kReset);
  EXPECT_EQ(bench.now().state, State::kBoot);
  EXPECT_EQ(bench.last_sent(0x000), (hal::CanFrame{.identifier = 0, .size = 2, .data = {129, 35}}));
  EXPECT_EQ(bench.last_sent(0x081)->data[0], 0);  // the controller's error is reset
  EXPECT_TRUE(bench.run_until_standing());
}

TEST_F(ControllerFault, EndsByResetOnceItsCauseIsGone) {
  struct Cause {
    Reason reason;
    void (*set)(ControllerBench& bench, bool broken);
  };
  using hal::CanErrorState;
  constexpr Cause kCauses[] = {
      {Reason::kImuSilent, [](ControllerBench& b, bool broken) { b.imu_speaks = !broken; }},
      {Reason::kAnkleSilent, [](ControllerBench& b, bool broken) { b.ankle_speaks[1] = !broken; }},
      {Reason::kDriveFault, [](ControllerBench& b, bool broken) { b.drives[9].hangs = broken; }},
      {Reason::kBusOff,
       [](ControllerBench& b, bool broken) {
         b.board.can.set_error_state(broken ? CanErrorState::kBusOff : CanErrorState::kErrorActive);
       }},
      {Reason::kNoAcknowledge,
       [](ControllerBench& b, bool broken) {
         b.board.can.set_error_state(broken ? CanErrorState::kErrorPassive : CanErrorState::kErrorActive);
         for (auto& drive : b.drives) drive.hangs = broken;
       }},
  };
  for (const Cause& cause : kCauses) {
    cause.set(bench, true);
    ASSERT_TRUE(bench.run_until(State::kFault, 100));
    EXPECT_EQ(bench.now().reason, cause.reason);
    bench.run_ms(500);
    cause.set(bench, false);
    bench.command(Command::kReset);
    ASSERT_TRUE(bench.run_until_standing()) << static_cast<int>(cause.reason);
  }
  EXPECT_EQ(bench.now().faults, std::size(kCauses));
}

TEST_F(ControllerFault, IgnoresAnswersOfADriveFromBeforeItsReset) {
  bench.board.can.deliver(bench.drives[6].emergency(0x2310));
  ASSERT_TRUE(bench.run_until(State::kFault, 10));
  bench.board.can.deliver(
      {.identifier = 0x201, .size = 3, .data = {6}});  // reset, followed in the receive FIFO by:
  bench.board.can.deliver(bench.drives[6].emergency(0x2310));
  EXPECT_TRUE(bench.run_until_standing());
}

// Sends the reset in each millisecond of the cycle, with drive answers that arrive after the command or while
// the drives restart.
TEST_F(ControllerFault, IsLeftForAnyAnswersFromBeforeTheReset) {
  for (int phase_ms = 0; phase_ms < 10; ++phase_ms) {
    for (const bool emergency : {false, true}) {
      SCOPED_TRACE(testing::Message() << phase_ms << " ms, emergency stop " << emergency);
      if (emergency) {
        bench.command(Command::kEmergencyStop);
      } else {
        for (auto& drive : bench.drives) drive.state = DriveState::kFault;
        ASSERT_TRUE(bench.run_until(State::kFault, 21));
      }
      const int now_ms = static_cast<int>(bench.now_us() / 1'000);
      bench.run_ms((phase_ms + 20 - now_ms % 10) % 10);
      const auto faults = bench.now().faults;
      bench.board.can.deliver({.identifier = 0x201, .size = 3, .data = {6}});
      for (int i = 0; i < 4; ++i) {
        for (const auto& drive : bench.drives) {
          const auto identifier = static_cast<std::uint16_t>(0x190 + (&drive - bench.drives.data()));
          bench.board.can.deliver({.identifier = identifier, .size = 8, .data = {0x18}});  // in fault
        }
        bench.run_ms(1);
      }
      ASSERT_EQ(bench.now().state, State::kBoot);
      ASSERT_TRUE(bench.run_until_standing());
      EXPECT_EQ(bench.now().faults, faults);
    }
  }
}

TEST_F(ControllerFault, ResetIsRefusedInEveryStateWithoutOne) {
  const auto refused = [&] {
    const State before = bench.now().state;
    bench.command(Command::kReset);
    EXPECT_EQ(bench.now().refusal, Reason::kNotInThisState);
    return bench.now().state == before;
  };
  EXPECT_TRUE(refused());  // while a motion plays
  bench.command(Command::kStop);
  ASSERT_TRUE(bench.run_until(State::kStanding));
  EXPECT_TRUE(refused());
  bench.command(Command::kWalk);
  EXPECT_TRUE(refused());
  bench.command(Command::kLimp);
  EXPECT_TRUE(refused());
  bench.restart();
  bench.run_ms(100);
  EXPECT_TRUE(refused());  // during boot
}

// --- Emergency stop

TEST_F(ControllerFault, EmergencyStopLowersTheLineAtOnce) {
  bench.command(Command::kEmergencyStop);
  EXPECT_FALSE(bench.board.drive_enable.enabled());
  EXPECT_EQ(bench.now().state, State::kEmergencyStop);
  EXPECT_EQ(bench.now().faults, 0);
  bench.run_ms(20);
  for (const auto& drive : bench.drives) EXPECT_EQ(drive.controlword, kDisableVoltage);
}

TEST_F(ControllerFault, EmergencyStopLatchesUntilReset) {
  bench.command(Command::kEmergencyStop);
  for (const Command command : {Command::kEnable, Command::kLimp, Command::kPlay, Command::kEmergencyStop}) {
    bench.command(command);
    EXPECT_EQ(bench.now().refusal, Reason::kNotInThisState);
    bench.run_ms(200);
    EXPECT_EQ(bench.now().state, State::kEmergencyStop);
    EXPECT_FALSE(bench.board.drive_enable.enabled());
  }
  bench.command(Command::kReset);
  ASSERT_TRUE(bench.run_until(State::kLimp));
  bench.run_ms(500);
  EXPECT_EQ(bench.now().state, State::kLimp);  // stays limp until enabled
  EXPECT_TRUE(bench.run_until_standing());
}

TEST_F(ControllerFault, EmergencyStopWinsOverAnEnableInTheSameMillisecond) {
  bench.command(Command::kLimp);
  bench.run_ms(50);
  bench.board.can.deliver({.identifier = 0x201, .size = 3, .data = {1}});  // enable
  bench.command(Command::kEmergencyStop);
  EXPECT_EQ(bench.now().state, State::kEmergencyStop);
  EXPECT_FALSE(bench.board.drive_enable.enabled());
}

TEST_F(ControllerFault, EmergencyStopCutsAQuickStopShort) {
  bench.drives[0].hangs = true;
  ASSERT_TRUE(bench.run_until(State::kFault, 100));
  ASSERT_TRUE(bench.board.drive_enable.enabled());
  bench.command(Command::kEmergencyStop);
  EXPECT_FALSE(bench.board.drive_enable.enabled());
}

}  // namespace
}  // namespace koboshi::app
