#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/controller_bench.h"

namespace koboshi::app {
namespace {

using drive::DriveFault;
using test::ControllerBench;

constexpr std::uint16_t kEmergencyOfController = 0x081;

TEST(ControllerBoot, BecomesLimpOnceAllDrivesAndSensorsAnswer) {
  ControllerBench bench;
  ASSERT_TRUE(bench.run_until(State::kLimp));
  EXPECT_EQ(bench.now().reason, Reason::kProgress);
  EXPECT_LT(bench.now_us(), 700'000u);  // 20 drives, 27 requests each, one per millisecond
  EXPECT_TRUE(bench.board.drive_enable.changes().empty());
  for (const auto& drive : bench.drives) EXPECT_TRUE(drive.operational());
}

TEST(ControllerBoot, ResetsItsDrivesFirstAndStartsThemLast) {
  ControllerBench bench;
  ASSERT_TRUE(bench.run_until(State::kLimp));
  std::vector<hal::CanFrame> commands;
  for (const auto& [time_us, frame] : bench.sent) {
    if (frame.identifier == 0x000) commands.push_back(frame);
  }
  std::vector<hal::CanFrame> expected;
  for (const std::uint8_t command : {std::uint8_t{129}, std::uint8_t{1}}) {
    for (std::uint8_t node = 16; node < 36; ++node)
      expected.push_back({.identifier = 0, .size = 2, .data = {command, node}});
  }
  EXPECT_EQ(commands, expected);
}

TEST(ControllerBoot, ReportsItsStateAndProducesSyncAndHeartbeatThroughout) {
  ControllerBench bench;
  bench.run_ms(200);
  ASSERT_EQ(bench.now().state, State::kBoot);
  EXPECT_TRUE(bench.last_sent(0x181));
  const auto sent = [&](std::uint16_t identifier) {
    return std::ranges::count_if(bench.sent, [&](const auto& s) { return s.frame.identifier == identifier; });
  };
  EXPECT_EQ(sent(0x080), 17);  // none while the controller listens for another master
  EXPECT_EQ(sent(0x701), 10);  // the boot-up message, then one every 20 ms
}

TEST(ControllerBoot, NeverSendsATargetToADriveThatIsNotConfigured) {
  ControllerBench bench;
  bench.drives.back().answers_sdo = false;
  ASSERT_TRUE(bench.run_until(State::kFault));
  for (const auto& [time_us, frame] : bench.sent) {
    EXPECT_FALSE(frame.identifier >= 0x210 && frame.identifier < 0x280)
        << frame.identifier;  // nodes 16 and on
  }
}

// --- Failures

struct Misbehaviour {
  const char* name;
  void (*cause)(test::DriveStub&);
  DriveFault drive_fault;
};

class ControllerBootFails : public testing::TestWithParam<Misbehaviour> {};

TEST_P(ControllerBootFails, AndReportsTheDriveAndTheReason) {
  constexpr std::size_t kJoint = 7;
  ControllerBench bench;
  GetParam().cause(bench.drives[kJoint]);
  ASSERT_TRUE(bench.run_until(State::kFault));
  EXPECT_EQ(bench.now().reason, Reason::kDriveFault);
  EXPECT_EQ(bench.now().drive_fault, GetParam().drive_fault);
  EXPECT_EQ(bench.now().faulty_joint, kJoint);
  EXPECT_EQ(bench.now().faults, 1);
  bench.run_ms(1);
  const hal::CanFrame emergency{.identifier = kEmergencyOfController,
                                .size = 8,
                                .data = {0x00, 0xFF, 0x81, static_cast<std::uint8_t>(State::kBoot),
                                         static_cast<std::uint8_t>(Reason::kDriveFault),
                                         static_cast<std::uint8_t>(GetParam().drive_fault), kJoint}};
  EXPECT_EQ(bench.last_sent(kEmergencyOfController), emergency);
  EXPECT_TRUE(bench.board.drive_enable.changes().empty());
}

TEST_P(ControllerBootFails, AndSucceedsAfterRepairAndReset) {
  ControllerBench bench;
  const auto healthy = bench.drives[7];
  GetParam().cause(bench.drives[7]);
  ASSERT_TRUE(bench.run_until(State::kFault));
  bench.drives[7] = healthy;
  bench.command(Command::kReset);
  EXPECT_EQ(bench.now().state, State::kBoot);
  EXPECT_EQ(bench.now().drive_fault, DriveFault::kNone);
  EXPECT_TRUE(bench.run_until_standing());
}

INSTANTIATE_TEST_SUITE_P(
    ByDrive, ControllerBootFails,
    testing::Values(Misbehaviour{"Silent", [](test::DriveStub& d) { d.hangs = true; }, DriveFault::kSilent},
                    Misbehaviour{"DeafToSdo", [](test::DriveStub& d) { d.answers_sdo = false; },
                                 DriveFault::kNoAnswer},
                    Misbehaviour{"Refusing",
                                 [](test::DriveStub& d) {
                                   d.refuses = {0x1A00, 3};
                                 },
                                 DriveFault::kRefused},
                    Misbehaviour{"Exchanged", [](test::DriveStub& d) { d.set_object(0x1018, 4, 1006); },
                                 DriveFault::kWrongIdentity},
                    Misbehaviour{"OfAnotherMake", [](test::DriveStub& d) { d.set_object(0x1018, 1, 0x1234); },
                                 DriveFault::kWrongIdentity}),
    [](const auto& info) { return info.param.name; });

TEST(ControllerBoot, FailsWhenADriveFallsSilentBeforeItsFirstAnswer) {
  ControllerBench bench;
  for (int i = 0; i < 1'000 && !bench.drives[4].operational(); ++i) bench.run_ms(1);
  bench.drives[4].hangs = true;
  ASSERT_TRUE(bench.run_until(State::kFault, 100));
  EXPECT_EQ(bench.now().drive_fault, DriveFault::kLost);
  EXPECT_EQ(bench.now().faulty_joint, 4);
}

// After its reset a drive sends a heartbeat every second, less often than the controller will configure.
TEST(ControllerBoot, ReportsNoLossBeforeADriveIsConfigured) {
  ControllerBench bench;
  bench.drives.back().beats = false;
  bench.run_ms(100);
  bench.board.can.deliver(bench.drives.back().heartbeat());
  bench.run_ms(450);
  EXPECT_EQ(bench.now().state, State::kBoot);
  bench.drives.back().beats = true;
  EXPECT_TRUE(bench.run_until(State::kLimp));
}

TEST(ControllerBoot, WaitsHalfASecondForSensors) {
  ControllerBench bench;
  bench.imu_speaks = false;
  ASSERT_TRUE(bench.run_until(State::kFault));
  EXPECT_EQ(bench.now().reason, Reason::kImuSilent);
  EXPECT_EQ(bench.now_us(), 501'000u);
}

TEST(ControllerBoot, NeedsBothAnkles) {
  ControllerBench bench;
  bench.ankle_speaks[1] = false;
  ASSERT_TRUE(bench.run_until(State::kFault));
  EXPECT_EQ(bench.now().reason, Reason::kAnkleSilent);
}

TEST(ControllerBoot, FailsWithoutAcknowledgement) {
  ControllerBench bench;
  for (auto& drive : bench.drives) drive.hangs = true;
  bench.board.can.set_error_state(hal::CanErrorState::kErrorPassive);
  ASSERT_TRUE(bench.run_until(State::kFault));
  EXPECT_EQ(bench.now().reason, Reason::kNoAcknowledge);
  EXPECT_EQ(bench.now_us(), 201'000u);
}

TEST(ControllerBoot, NeverLeavesTheFaultWithoutAModel) {
  ControllerBench bench;
  bench.restart(std::vector<std::byte>(4096, std::byte{0xFF}));
  for (int i = 0; i < 3; ++i) {
    ASSERT_TRUE(bench.run_until(State::kFault, 20));
    EXPECT_EQ(bench.now().reason, Reason::kModelInvalid);
    bench.run_ms(20);
    bench.command(Command::kReset);
  }
  EXPECT_TRUE(bench.board.drive_enable.changes().empty());
}

TEST(ControllerBoot, KeepsTheLineLowWhileDrivesFromBeforeTheResetMakeTorque) {
  ControllerBench bench;
  ASSERT_TRUE(bench.run_until_standing());
  const auto storage = bench.board.storage.contents();
  bench.restart(std::vector<std::byte>(storage.begin(), storage.end()));  // as after a watchdog reset
  bench.run_ms(10);
  EXPECT_FALSE(bench.board.drive_enable.enabled());
  bench.run_ms(30);  // the controller listens for another master
  for (const auto& drive : bench.drives) EXPECT_EQ(drive.state, test::DriveStub::State::kSwitchOnDisabled);
  EXPECT_TRUE(bench.run_until_standing());
}

}  // namespace
}  // namespace koboshi::app
