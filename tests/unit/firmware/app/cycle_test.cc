#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/controller_bench.h"
#include "tests/unit/firmware/robot/test_robot.h"

namespace koboshi::app {
namespace {

using test::ControllerBench;

// Returns the identifiers of the frames that the controller sends in the millisecond of a tick.
std::vector<std::uint16_t> identifiers_of_a_tick(ControllerBench& bench) {
  while (bench.now_us() % Controller::kTick_us != 0) bench.run_ms(1);
  bench.sent.clear();
  bench.run_ms(1);
  std::vector<std::uint16_t> identifiers;
  for (const auto& [time_us, frame] : bench.sent) {
    if (frame.identifier != 0x701) identifiers.push_back(frame.identifier);
  }
  return identifiers;
}

TEST(ControllerCycle, SendsTwentyRpdosThenSyncThenTelemetry) {
  std::vector<std::uint16_t> expected;
  for (std::uint16_t node = 16; node < 36; ++node)
    expected.push_back(static_cast<std::uint16_t>(0x200 + node));
  constexpr std::uint16_t kOthers[] = {0x080, 0x181, 0x281, 0x381, 0x481, 0x182, 0x282, 0x382, 0x482};
  for (const std::uint16_t other : kOthers) expected.push_back(other);
  // Ten times a second: what changes slowly.
  std::vector<std::uint16_t> tenth = expected;
  for (const std::uint16_t slow : {std::uint16_t{0x202}, std::uint16_t{0x302}}) tenth.push_back(slow);

  ControllerBench bench;
  ASSERT_TRUE(bench.run_until_standing());
  int tenths = 0;
  for (int i = 0; i < 20; ++i) {
    const auto sent = identifiers_of_a_tick(bench);
    const bool is_tenth = sent.size() > expected.size();
    tenths += is_tenth ? 1 : 0;
    EXPECT_EQ(sent, is_tenth ? tenth : expected);
    bench.run_ms(5);
  }
  EXPECT_EQ(tenths, 2);
}

TEST(ControllerCycle, SendsNoPdoBetweenTicks) {
  ControllerBench bench;
  ASSERT_TRUE(bench.run_until_standing());
  bench.sent.clear();
  bench.run_ms(1'000);
  for (const auto& [time_us, frame] : bench.sent) {
    const bool heartbeat = frame.identifier == 0x701;
    const bool sdo = frame.identifier >= 0x600 && frame.identifier < 0x680;
    EXPECT_TRUE(time_us % Controller::kTick_us == 0 || heartbeat || sdo) << std::hex << frame.identifier;
  }
}

TEST(ControllerCycle, PutsControlwordAndTargetIntoAnRpdo) {
  ControllerBench bench;
  ASSERT_TRUE(bench.run_until_standing());
  bench.run_ms(20);
  // Left knee, node 19: operation enabled, 1820 * 2^-14 turn (40 degrees) = 116480 units of 2^-20 turn.
  EXPECT_EQ(bench.last_sent(0x213),
            (hal::CanFrame{.identifier = 0x213, .size = 6, .data = {0x0F, 0x00, 0x00, 0xC7, 0x01, 0x00}}));
}

TEST(ControllerCycle, ReportsStateReasonAndRefusal) {
  ControllerBench bench;
  ASSERT_TRUE(bench.run_until_standing());
  bench.command(Command::kEnable);
  bench.run_ms(10);
  const hal::CanFrame telemetry{
      .identifier = 0x181,
      .size = 8,
      .data = {static_cast<std::uint8_t>(State::kStanding), static_cast<std::uint8_t>(Reason::kProgress), 0,
               0, 0, 0, 0, static_cast<std::uint8_t>(Reason::kNotInThisState)}};
  EXPECT_EQ(bench.last_sent(0x181), telemetry);
}

TEST(ControllerCycle, ReportsTheAttitude) {
  ControllerBench bench;
  bench.imu_sample.accelerometer_raw = {0, 4'100, 7'101};  // 30 degrees of roll to the right
  ASSERT_TRUE(bench.run_until(State::kLimp));
  const double roll_deg = bench.values().attitude.roll * 360.0 / 65536.0;
  EXPECT_NEAR(roll_deg, 30.0, 0.02);
  EXPECT_NEAR(bench.values().attitude.pitch, 0, 1);
}

TEST(ControllerCycle, CountsLostFrames) {
  ControllerBench bench;
  for (int i = 0; i < 20; ++i) bench.board.imu.deliver({});
  for (int i = 0; i < 70; ++i) bench.board.can.deliver({.identifier = 0x7FF});
  bench.run_ms(1);
  EXPECT_EQ(bench.values().diagnosis.imu_overruns, 5);  // sum of 20 and the bench's own overrun, modulo 16
  EXPECT_EQ(bench.values().diagnosis.receive_overruns, 6);
}

TEST(ControllerCycle, FeedsTheWatchdogEachMillisecond) {
  ControllerBench bench;
  bench.run_ms(100);
  EXPECT_EQ(bench.board.watchdog.kicks(), 100);
}

TEST(ControllerCycle, IsDeterministicToTheByte) {
  const auto run = [] {
    ControllerBench bench;
    EXPECT_TRUE(bench.run_until_standing());
    bench.command(Command::kPlay, 1);
    bench.run_ms(500);
    std::vector<hal::CanFrame> frames;
    for (const auto& sent : bench.sent) frames.push_back(sent.frame);
    return frames;
  };
  EXPECT_EQ(run(), run());
}

TEST(ControllerCycle, LoadsItsModelAndItsMotions) {
  ControllerBench bench;
  bench.run_ms(1);
  EXPECT_EQ(bench.values().diagnosis.model_id, bench.model().id);
  EXPECT_EQ(bench.values().diagnosis.motions[0], 0b11u);
}

}  // namespace
}  // namespace koboshi::app
