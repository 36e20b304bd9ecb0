#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "tests/support/controller_bench.h"
#include "tests/support/sdo_pc.h"

namespace koboshi::app {
namespace {

using canopen::AbortCode;
using test::ControllerBench;
using test::SdoPc;

constexpr canopen::ObjectAddress kLowestSupply{0x2100, 1};
constexpr canopen::ObjectAddress kRampRate{0x2100, 3};
constexpr canopen::ObjectAddress kKneeGain{0x2101, 4};

class ControllerParameters : public testing::Test {
 protected:
  void SetUp() override {
    bench.board.storage.complete_after(22);  // duration of a flash page erase
    ASSERT_TRUE(bench.run_until(State::kLimp));
  }
  void power_cycle() {
    bench.board.storage.lose_power();
    bench.restart();
    ASSERT_TRUE(bench.run_until(State::kLimp));
  }

  ControllerBench bench;
  SdoPc pc{bench};
};

TEST_F(ControllerParameters, SurviveAPowerCycleOnceTheyAreSaved) {
  ASSERT_EQ(pc.write(kLowestSupply, 6'500, 2), AbortCode::kNone);
  ASSERT_EQ(pc.write(kKneeGain, -300, 2), AbortCode::kNone);
  power_cycle();
  EXPECT_EQ(bench.values().parameters.supply_min_mV, 6'000);
  ASSERT_EQ(pc.write(kLowestSupply, 6'500, 2), AbortCode::kNone);
  ASSERT_EQ(pc.write(kKneeGain, -300, 2), AbortCode::kNone);
  ASSERT_EQ(pc.save(), AbortCode::kNone);
  EXPECT_GT(pc.answer_ms, 22);  // the answer is sent after completion
  power_cycle();
  EXPECT_EQ(bench.values().parameters.supply_min_mV, 6'500);
  EXPECT_EQ(bench.values().feedback.motion.knee, -300);
}

TEST_F(ControllerParameters, AreFactoryDefaultsAfterRestoreAndReset) {
  ASSERT_EQ(pc.write(kLowestSupply, 6'500, 2), AbortCode::kNone);
  ASSERT_EQ(pc.save(), AbortCode::kNone);
  ASSERT_EQ(pc.restore(), AbortCode::kNone);
  EXPECT_EQ(bench.values().parameters.supply_min_mV, 6'500);  // the value stays until the reset
  bench.board.can.deliver({.identifier = 0x000, .size = 2, .data = {129, 1}});
  bench.run_ms(1);
  EXPECT_EQ(bench.values().parameters.supply_min_mV, 6'000);
}

TEST_F(ControllerParameters, ResetOfTheNodeLoadsTheSavedOnes) {
  ASSERT_EQ(pc.write(kLowestSupply, 6'500, 2), AbortCode::kNone);
  ASSERT_EQ(pc.save(), AbortCode::kNone);
  ASSERT_EQ(pc.write(kLowestSupply, 7'000, 2), AbortCode::kNone);
  bench.board.can.deliver({.identifier = 0x000, .size = 2, .data = {130, 1}});  // reset communication
  bench.run_ms(1);
  EXPECT_EQ(bench.values().parameters.supply_min_mV, 7'000);
  bench.board.can.deliver({.identifier = 0x000, .size = 2, .data = {129, 1}});
  bench.run_ms(1);
  EXPECT_EQ(bench.values().parameters.supply_min_mV, 6'500);
}

TEST_F(ControllerParameters, AreWrittenOnlyWhenTheyHaveChanged) {
  ASSERT_EQ(pc.save(), AbortCode::kNone);
  EXPECT_GT(pc.answer_ms, 22);
  ASSERT_EQ(pc.save(), AbortCode::kNone);
  EXPECT_EQ(pc.answer_ms, 1);
}

TEST_F(ControllerParameters, ReportWhichGroupsAreStored) {
  for (const std::uint16_t index : {std::uint16_t{0x1010}, std::uint16_t{0x1011}}) {
    EXPECT_EQ(pc.read({index, 0}), 4u);
    for (const std::uint8_t group : std::to_array<std::uint8_t>({1, 2, 3, 4}))
      EXPECT_EQ(pc.read({index, group}), 1u);
  }
  EXPECT_EQ(pc.write({0x1010, 3}, 0x65766174, 4), AbortCode::kCannotTransfer);  // wrong signature
  EXPECT_EQ(pc.write({0x1010, 3}, 0x65766173, 4), AbortCode::kNone);
}

struct CommunicationWrite {
  canopen::ObjectAddress address;
  std::int32_t value;
  std::size_t size_bytes;
};

// The deadline of the velocity, heartbeat, EMCY, second SDO channel, telemetry by time instead of SYNC and
// with another mapping, an answer of a drive that waits for SYNC, and NMT startup.
constexpr CommunicationWrite kCommunicationWrites[] = {
    {{0x1401, 5}, 700, 2},
    {{0x1015, 0}, 20, 2},
    {{0x1017, 0}, 40, 2},
    {{0x1029, 1}, 0, 1},
    {{0x1014, 0}, static_cast<std::int32_t>(0x8000'0081), 4},
    {{0x1014, 0}, 0x91, 4},
    {{0x1201, 1}, 0x6A0, 4},
    {{0x1201, 2}, 0x6B0, 4},
    {{0x1801, 1}, static_cast<std::int32_t>(0xC000'0281), 4},
    {{0x1801, 2}, 254, 1},
    {{0x1801, 3}, 30, 2},
    {{0x1801, 5}, 50, 2},
    {{0x1A01, 0}, 0, 1},
    {{0x1A01, 1}, 0x2010'0210, 4},
    {{0x1A01, 0}, 1, 1},
    {{0x1801, 1}, 0x4000'0281, 4},
    {{0x1403, 2}, 1, 1},
    {{0x1F80, 0}, 3, 4},
};

std::vector<std::uint32_t> communication_values(SdoPc& pc) {
  std::vector<std::uint32_t> values;
  for (const CommunicationWrite& write : kCommunicationWrites) values.push_back(pc.read(write.address));
  return values;
}

TEST_F(ControllerParameters, IncludeThoseOfTheCommunication) {
  for (const std::uint8_t group : std::to_array<std::uint8_t>({1, 2})) {
    const std::vector<std::uint32_t> defaults = communication_values(pc);
    for (const auto& [address, value, size_bytes] : kCommunicationWrites)
      ASSERT_EQ(pc.write(address, value, size_bytes), AbortCode::kNone) << std::hex << address.index;
    const std::vector<std::uint32_t> written = communication_values(pc);
    EXPECT_EQ(written.front(), 700u);
    ASSERT_EQ(pc.write({0x1010, group}, 0x65766173, 4), AbortCode::kNone);
    power_cycle();
    EXPECT_EQ(communication_values(pc), written);
    ASSERT_EQ(pc.write({0x1401, 5}, 0, 2), AbortCode::kNone);
    bench.board.can.deliver({.identifier = 0x000, .size = 2, .data = {130, 1}});  // reset communication
    ASSERT_TRUE(bench.run_until(State::kBoot));
    ASSERT_TRUE(bench.run_until(State::kLimp));
    EXPECT_EQ(communication_values(pc), written);
    ASSERT_EQ(pc.write({0x1011, group}, 0x64616F6C, 4), AbortCode::kNone);
    EXPECT_EQ(communication_values(pc), written);  // until the reset
    power_cycle();
    EXPECT_EQ(communication_values(pc), defaults);
  }
}

TEST_F(ControllerParameters, AreSavedByGroups) {
  ASSERT_EQ(pc.write({0x1401, 5}, 700, 2), AbortCode::kNone);
  ASSERT_EQ(pc.write(kKneeGain, -300, 2), AbortCode::kNone);
  ASSERT_EQ(pc.write({0x1010, 4}, 0x65766173, 4), AbortCode::kNone);
  power_cycle();
  EXPECT_EQ(pc.read({0x1401, 5}), kVelocityDeadline_ms);
  EXPECT_EQ(bench.values().feedback.motion.knee, -300);
  ASSERT_EQ(pc.write({0x1401, 5}, 700, 2), AbortCode::kNone);
  ASSERT_EQ(pc.write(kKneeGain, 0, 2), AbortCode::kNone);
  ASSERT_EQ(pc.write({0x1010, 2}, 0x65766173, 4), AbortCode::kNone);
  power_cycle();
  EXPECT_EQ(pc.read({0x1401, 5}), 700u);
  EXPECT_EQ(bench.values().feedback.motion.knee, -300);
}

TEST_F(ControllerParameters, AreNotSavedWhileTheRobotWalks) {
  bench.run_ms(1'200);  // of rest, for the gyro's bias
  bench.command(Command::kEnable);
  EXPECT_EQ(pc.save(), AbortCode::kDeviceState);
  ASSERT_TRUE(bench.run_until(State::kStanding));
  bench.command(Command::kWalk);
  ASSERT_EQ(bench.now().state, State::kWalking);
  EXPECT_EQ(pc.save(), AbortCode::kDeviceState);
  bench.command(Command::kStop);
  ASSERT_TRUE(bench.run_until(State::kStanding));
  bench.command(Command::kPlay, 1);
  EXPECT_EQ(pc.save(), AbortCode::kNone);
  EXPECT_EQ(bench.now().state, State::kMotion);  // it goes on
}

TEST_F(ControllerParameters, SavingReportsAFlashFailure) {
  bench.board.storage.fail_next();
  EXPECT_EQ(pc.save(), AbortCode::kHardwareError);
  EXPECT_EQ(pc.save(), AbortCode::kNone);
}

// Power fails in each millisecond of a save: afterwards both parameters are old or both are new.
TEST_F(ControllerParameters, AreNeverPartlySavedByAPowerFailure) {
  bench.board.storage.complete_after(2);
  ASSERT_EQ(pc.write(kLowestSupply, 6'100, 2), AbortCode::kNone);
  ASSERT_EQ(pc.write(kRampRate, 100, 2), AbortCode::kNone);
  ASSERT_EQ(pc.save(), AbortCode::kNone);
  const int save_ms = pc.answer_ms;
  const std::vector<std::byte> flash(bench.board.storage.contents().begin(),
                                     bench.board.storage.contents().end());
  int new_ones = 0;
  for (int time_ms = 0; time_ms <= save_ms; ++time_ms) {
    ASSERT_EQ(pc.write(kLowestSupply, 6'200, 2), AbortCode::kNone);
    ASSERT_EQ(pc.write(kRampRate, 200, 2), AbortCode::kNone);
    bench.board.can.deliver(
        {.identifier = 0x601, .size = 8, .data = {0x23, 0x10, 0x10, 1, 0x73, 0x61, 0x76, 0x65}});
    bench.run_ms(time_ms);
    power_cycle();
    const bool is_new = bench.values().parameters.ramp_rate == 200;
    new_ones += is_new ? 1 : 0;
    EXPECT_EQ(bench.values().parameters.ramp_rate, is_new ? 200 : 100) << time_ms;
    EXPECT_EQ(bench.values().parameters.supply_min_mV, is_new ? 6'200 : 6'100) << time_ms;
    bench.restart(flash);
    ASSERT_TRUE(bench.run_until(State::kLimp));
  }
  EXPECT_GE(new_ones, 1);
  EXPECT_LE(new_ones, 3);
}

}  // namespace
}  // namespace koboshi::app
