// Tests of foreign traffic on the bus of a standing robot. Firmware, drives and bus are the real ones; time
// is simulated and there is no physics.

#include <gtest/gtest.h>

#include <algorithm>

#include "firmware/canopen/cia402.h"
#include "firmware/canopen/sdo/protocol.h"
#include "tests/support/bus_bench.h"

namespace koboshi::test {
namespace {

using canopen::cia402::State;

constexpr std::uint16_t kSync = 0x080;
constexpr std::uint64_t kCycle_us = 10'000;
// Duration at 1 Mbit/s of the longest frame with all stuff bits, plus the intermission
// (docs/design/timing.md).
constexpr std::uint64_t kMaxFrame_us = 132 + 3;

// Returns the latest end of a SYNC frame relative to its tick, over all SYNCs seen.
std::uint64_t latest_sync_us(const BusBench& bench) {
  std::uint64_t latest_us = 0;
  for (const BusBench::SeenFrame& sync : bench.seen_with(kSync))
    latest_us = std::max(latest_us, sync.end_us % kCycle_us);
  return latest_us;
}

// SDO clients that send requests back to back, a higher load than real clients can produce. Each client takes
// all bandwidth that the other nodes leave.
class SdoFlood : public testing::TestWithParam<std::vector<std::uint16_t>> {};

TEST_P(SdoFlood, DelaysSyncByAtMostOneFrameAndLosesNoNode) {
  BusBench bench;
  ASSERT_TRUE(bench.run_until_standing());
  bench.seen.clear();
  bench.run_ms(500);
  const std::uint64_t usual_us = latest_sync_us(bench);
  for (const std::uint16_t identifier : GetParam()) {
    bench.add_babbler({.frame = {.identifier = identifier, .size = 8, .data = {0x60, 0xFF, 0x55}},
                       .from_us = bench.now_us()});
  }
  bench.run_ms(10);
  bench.seen.clear();
  const sim_board::BusUsage before = bench.bus.usage();
  bench.run_ms(2'000);

  EXPECT_GT(sim_board::bus_load(before, bench.bus.usage()), 0.99);
  EXPECT_EQ(bench.seen_with(kSync).size(), 200u);
  EXPECT_LE(latest_sync_us(bench), usual_us + kMaxFrame_us);
  for (std::uint16_t node = 16; node < 36; ++node) EXPECT_EQ(bench.seen_with(0x180 + node).size(), 200u);
  for (std::uint8_t node = 1; node < 36; ++node) EXPECT_TRUE(bench.emergencies(node).empty()) << int{node};
  EXPECT_EQ(bench.controller().state(), behaviour::State::kStanding);
  EXPECT_EQ(bench.count_in(State::kOperationEnabled), 20);
  EXPECT_EQ(bench.controller().values().diagnosis.receive_overruns, 0);
  EXPECT_EQ(bench.controller().values().diagnosis.frames_lost, 0);
}

INSTANTIATE_TEST_SUITE_P(Clients, SdoFlood,
                         testing::Values(std::vector<std::uint16_t>{0x601}, std::vector<std::uint16_t>{0x610},
                                         std::vector<std::uint16_t>{0x601, 0x602, 0x610, 0x623, 0x690,
                                                                    0x6A3}));

// --- A second master

void expect_standing(BusBench& bench) {
  EXPECT_EQ(bench.controller().state(), behaviour::State::kStanding);
  EXPECT_EQ(bench.count_in(State::kOperationEnabled), 20);
  EXPECT_TRUE(bench.emergencies(1).empty());
}

// Expects the fault state for this reason, with the drive-enable line low and no torque on any drive.
void expect_fault(BusBench& bench, behaviour::Reason reason) {
  EXPECT_EQ(bench.controller().state(), behaviour::State::kFault);
  EXPECT_EQ(bench.controller().values().behaviour.reason, reason);
  EXPECT_FALSE(bench.controller().drive_enable_line());
  for (std::size_t i = 0; i < bench.drive_count(); ++i) EXPECT_FALSE(bench.drive(i).makes_torque()) << i;
}

TEST(SecondMaster, RefusesToBootWhileTheRobotStands) {
  BusBench bench;
  ASSERT_TRUE(bench.run_until_standing());
  bench.seen.clear();
  BusBench::Unit& second = bench.add_controller();
  bench.run_ms(100);
  EXPECT_EQ(second.state(), behaviour::State::kFault);
  EXPECT_EQ(second.values().behaviour.reason, behaviour::Reason::kSecondMaster);
  // The second master has sent its emergency message with both identifiers. From now on it sends nothing: no
  // reset, no SYNC, no heartbeat.
  const std::uint64_t said = bench.bus.counters(second.handle()).sent;
  EXPECT_EQ(std::ranges::count(bench.emergencies(1), 0xFF00), 1);
  EXPECT_TRUE(bench.seen_with(0x000).empty());
  bench.seen.clear();
  bench.run_ms(1'000);
  EXPECT_EQ(bench.bus.counters(second.handle()).sent, said);
  expect_standing(bench);
  // Switches the first master off and resets the second one.
  bench.controller(0).runs = false;
  bench.run_ms(1'000);
  bench.say(
      {.identifier = 0x201, .size = 3, .data = {static_cast<std::uint8_t>(behaviour::Command::kReset)}});
  bench.run_ms(2'000);
  EXPECT_EQ(second.state(), behaviour::State::kLimp);
}

TEST(SecondMaster, PoweredOnWithTheFirstPreventsBothFromBooting) {
  BusBench bench;
  bench.run_ms(4);
  BusBench::Unit& second = bench.add_controller();
  bench.run_ms(2'000);
  expect_fault(bench, behaviour::Reason::kSecondMaster);
  EXPECT_EQ(second.values().behaviour.reason, behaviour::Reason::kSecondMaster);
  EXPECT_TRUE(bench.seen_with(0x000).empty());
}

// SYNC, heartbeat or targets from a second source, each on its own and at the rate of a master.
TEST(SecondMaster, SendingAsTheFirstStopsTheRobot) {
  for (const hal::CanFrame& frame :
       {hal::CanFrame{.identifier = kSync}, hal::CanFrame{.identifier = 0x701, .size = 1, .data = {5}},
        hal::CanFrame{.identifier = 0x213, .size = 6, .data = {0x0F}}}) {
    SCOPED_TRACE(frame.identifier);
    BusBench bench;
    ASSERT_TRUE(bench.run_until_standing());
    const std::uint64_t interval_us = frame.identifier == 0x701 ? 20'000 : 10'000;
    // Sends in the quiet part of the cycle: two identical frames at the same time would merge into one.
    const std::uint64_t from_us = (bench.now_us() / kCycle_us + 1) * kCycle_us + 8'000;
    bench.add_babbler({.frame = frame, .interval_us = interval_us, .from_us = from_us});
    bench.run_ms(300);
    EXPECT_EQ(bench.controller().values().behaviour.reason, behaviour::Reason::kSecondMaster);
    bench.run_ms(400);
    expect_fault(bench, behaviour::Reason::kSecondMaster);
  }
}

TEST(SecondMaster, IsNotReportedForOneFrameASecond) {
  BusBench bench;
  ASSERT_TRUE(bench.run_until_standing());
  for (const std::uint16_t identifier : {kSync, std::uint16_t{0x701}})
    bench.add_babbler({.frame = {.identifier = identifier, .size = std::uint8_t(identifier == kSync ? 0 : 1)},
                       .interval_us = 1'000'000,
                       .from_us = bench.now_us() + 3'000});
  bench.run_ms(3'500);
  expect_standing(bench);
}

// --- A second node with the same id

TEST(DuplicateNode, OfADriveIsDetectedDuringBoot) {
  BusBench bench;
  bench.add_drive(3, 9'999);
  bench.run_ms(3'000);
  expect_fault(bench, behaviour::Reason::kDriveFault);
  EXPECT_EQ(bench.controller().values().behaviour.faulty_joint, 3);
}

TEST(DuplicateNode, PluggedInStopsTheRobot) {
  BusBench bench;
  ASSERT_TRUE(bench.run_until_standing());
  bench.add_drive(3, 9'999);
  bench.run_ms(1'000);
  expect_fault(bench, behaviour::Reason::kDriveFault);
  EXPECT_EQ(bench.controller().values().behaviour.drive_fault, drive::DriveFault::kRestarted);
  EXPECT_EQ(bench.controller().values().behaviour.faulty_joint, 3);
}

// --- A bus that is stuck

TEST(DominantBus, ForFiveMillisecondsIsTolerated) {
  BusBench bench;
  ASSERT_TRUE(bench.run_until_standing());
  bench.bus.set_dominant(true);
  bench.run_ms(5);
  bench.bus.set_dominant(false);
  bench.seen.clear();
  bench.run_ms(1'000);
  EXPECT_EQ(bench.controller().state(), behaviour::State::kStanding);
  EXPECT_EQ(bench.count_in(State::kOperationEnabled), 20);
}

TEST(DominantBus, StopsTheRobotWhichBootsAgainAfterRepair) {
  BusBench bench;
  ASSERT_TRUE(bench.run_until_standing());
  bench.bus.set_dominant(true);
  bench.run_ms(1'000);
  EXPECT_EQ(bench.controller().state(), behaviour::State::kFault);
  EXPECT_FALSE(bench.controller().drive_enable_line());
  EXPECT_EQ(bench.count_in(State::kFault), 20) << "each stopped by itself";
  bench.bus.set_dominant(false);
  bench.run_ms(500);
  bench.command(behaviour::Command::kReset);
  EXPECT_TRUE(bench.run_until(behaviour::State::kLimp));
}

// --- Oscillators with the frequency tolerance of cheap parts

TEST(Clocks, MayDifferByFiveHundredPpm) {
  for (const double rate : {1.0 - 500e-6, 1.0 + 500e-6}) {
    SCOPED_TRACE(rate);
    BusBench bench(rate);
    ASSERT_TRUE(bench.run_until_standing());
    bench.command(behaviour::Command::kPlay, 1);
    bench.seen.clear();
    const std::uint64_t before_us = bench.now_us();
    bench.run_ms(20'000);  // their phases cross twice
    EXPECT_EQ(bench.controller().state(), behaviour::State::kMotion);
    EXPECT_EQ(bench.count_in(State::kOperationEnabled), 20);
    for (std::uint8_t node = 1; node < 36; ++node) EXPECT_TRUE(bench.emergencies(node).empty()) << int{node};
    const double cycles = static_cast<double>(bench.now_us() - before_us) * rate / kCycle_us;
    EXPECT_NEAR(static_cast<double>(bench.seen_with(kSync).size()), cycles, 1.0);
    EXPECT_NEAR(static_cast<double>(bench.seen_with(0x1A3).size()), cycles, 1.0);
  }
}

// --- A client that dies in the middle of a transfer

struct Transfer {
  const char* name;
  std::vector<canopen::sdo::Data> requests;  // the initiate request
  bool in_block = false;                     // within a block the server treats any frame as a segment
};
void PrintTo(const Transfer& transfer, std::ostream* out) { *out << transfer.name; }

class DeadClient : public testing::TestWithParam<Transfer> {
 protected:
  std::vector<std::uint32_t> aborts() const {
    std::vector<std::uint32_t> codes;
    for (const BusBench::SeenFrame& answer : bench.seen_with(0x581)) {
      if (answer.frame.data[0] == canopen::sdo::kAbort)
        codes.push_back(canopen::sdo::data_of(answer.frame.data));
    }
    return codes;
  }
  void ask(const canopen::sdo::Data& data) { bench.say({.identifier = 0x601, .size = 8, .data = data}); }

  BusBench bench;
};

TEST_P(DeadClient, TimesOutAfterOneSecond) {
  ASSERT_TRUE(bench.run_until_standing());
  bench.seen.clear();
  for (const canopen::sdo::Data& request : GetParam().requests) {
    ask(request);
    bench.run_ms(30);  // the flash may have to erase a slot first
  }
  ASSERT_FALSE(bench.seen_with(0x581).empty());
  ASSERT_TRUE(aborts().empty());
  bench.run_ms(900);
  EXPECT_TRUE(aborts().empty());
  bench.run_ms(200);
  EXPECT_EQ(aborts(), (std::vector<std::uint32_t>{0x0504'0000}));
  bench.run_ms(2'000);
  EXPECT_EQ(aborts().size(), 1u) << "told once";
  // The SDO channel and the object are available again.
  bench.seen.clear();
  ask(GetParam().requests[0]);
  bench.run_ms(30);
  EXPECT_TRUE(aborts().empty());
  EXPECT_EQ(bench.seen_with(0x581).size(), 1u);
  expect_standing(bench);
}

TEST_P(DeadClient, IsReplacedAtOnceByAnotherClient) {
  ASSERT_TRUE(bench.run_until_standing());
  for (const canopen::sdo::Data& request : GetParam().requests) {
    ask(request);
    bench.run_ms(30);
  }
  bench.seen.clear();
  if (GetParam().in_block) ask({canopen::sdo::kAbort});
  ask({0x40, 0x00, 0x10, 0x00});  // the device type
  bench.run_ms(20);
  const auto answers = bench.seen_with(0x581);
  ASSERT_FALSE(answers.empty());
  EXPECT_EQ(answers.back().frame.data[0], 0x43);
  EXPECT_EQ(answers.back().frame.data[1], 0x00);
  EXPECT_EQ(answers.back().frame.data[2], 0x10);
  bench.run_ms(2'000);
  EXPECT_TRUE(aborts().empty()) << "the first transfer is forgotten";
}

// Motions 0 and 2 (0x2400).
INSTANTIATE_TEST_SUITE_P(
    Transfers, DeadClient,
    testing::Values(
        Transfer{"SegmentedDownload", {{0x21, 0x00, 0x24, 0x03, 0x00, 0x02}, {0x00, 1, 2, 3, 4, 5, 6, 7}}},
        Transfer{"BlockDownload",
                 {{0xC6, 0x00, 0x24, 0x03, 0x00, 0x02}, {1, 1, 2, 3, 4, 5, 6, 7}, {2, 1, 2, 3, 4, 5, 6, 7}},
                 true},
        Transfer{"SegmentedUpload", {{0x40, 0x00, 0x24, 0x01}, {0x60}}},
        Transfer{"BlockUpload", {{0xA4, 0x00, 0x24, 0x01, 127}, {0xA3}}}),
    [](const auto& info) { return std::string(info.param.name); });

// --- Resets

// A winding that is still hot is a fault from the first moment after the reset, while the resets of the other
// drives keep the bus busy. The emergency message must not overtake the boot-up message.
TEST(Reset, ReportsWhyADriveIsInFaultAgain) {
  BusBench bench;
  ASSERT_TRUE(bench.run_until_standing());
  bench.drive(5).overheat();
  ASSERT_TRUE(bench.run_until(app::State::kFault));
  bench.run_ms(600);
  bench.command(app::Command::kReset);
  ASSERT_TRUE(bench.run_until(app::State::kFault));
  const auto& behaviour = bench.controller().values().behaviour;
  EXPECT_EQ(behaviour.faults, 2);
  EXPECT_EQ(behaviour.drive_fault, drive::DriveFault::kFault);
  EXPECT_EQ(behaviour.faulty_joint, 5);
  EXPECT_EQ(behaviour.drive_error_code, 0x4310);
}

// The controller is the SDO client of the drives while it boots them; then another master takes over.
TEST(DeadMaster, LeavesDrivesThatANewMasterCanBoot) {
  BusBench bench;
  bench.run_ms(200);
  ASSERT_EQ(bench.controller().state(), behaviour::State::kBoot);
  bench.controller().runs = false;
  bench.run_ms(100);
  BusBench::Unit& next = bench.add_controller();
  bench.run_ms(2'000);
  EXPECT_EQ(next.state(), behaviour::State::kLimp);
}

}  // namespace
}  // namespace koboshi::test
