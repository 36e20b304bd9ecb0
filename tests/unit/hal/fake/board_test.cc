#include "hal/fake/board.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace koboshi::hal {
namespace {

using testing::ElementsAre;

struct FakeBoardTest : testing::Test {
  FakeBoard board;
  Board ports = board.ports();
};

TEST_F(FakeBoardTest, DeliversFramesInOrderAndCountsTheOverrun) {
  for (std::uint16_t i = 0; i <= FakeCan::kReceiveCapacity; ++i) board.can.deliver({.identifier = i});
  EXPECT_EQ(ports.can.status().receive_overruns, 1);
  CanFrame frame;
  for (std::uint16_t i = 0; i < FakeCan::kReceiveCapacity; ++i) {
    ASSERT_TRUE(ports.can.receive(frame));
    EXPECT_EQ(frame.identifier, i);
  }
  EXPECT_FALSE(ports.can.receive(frame));
}

TEST_F(FakeBoardTest, RecordsSentFrames) {
  const CanFrame sync{.identifier = 0x80};
  const CanFrame first{.identifier = 0x210, .size = 1, .data = {1}};
  const CanFrame second{.identifier = 0x210, .size = 1, .data = {2}};
  for (const CanFrame& frame : {first, sync, second}) ASSERT_TRUE(ports.can.transmit(frame));
  EXPECT_THAT(board.can.sent(), ElementsAre(first, sync, second));
  EXPECT_EQ(board.can.last_sent(0x210), second);
  EXPECT_EQ(board.can.last_sent(0x211), std::nullopt);
  board.can.clear_sent();
  EXPECT_TRUE(board.can.sent().empty());
}

TEST_F(FakeBoardTest, RefusesFramesWhenTheBusStalls) {
  board.can.limit_transmit(1);
  EXPECT_EQ(ports.can.transmit_space(kProcessFifo), 1u);
  EXPECT_TRUE(ports.can.transmit({}));
  EXPECT_FALSE(ports.can.transmit({}));
  board.can.release_transmit();
  EXPECT_TRUE(ports.can.transmit({}));
  EXPECT_EQ(board.can.sent().size(), 2u);
}

TEST_F(FakeBoardTest, RefusesTheFramesOfOneFifo) {
  board.can.limit_transmit(kBackgroundFifo, 0);
  EXPECT_TRUE(ports.can.transmit_pending(kBackgroundFifo));
  EXPECT_FALSE(ports.can.transmit_pending(kProcessFifo));
  EXPECT_FALSE(ports.can.transmit({.identifier = 0x701}));
  EXPECT_TRUE(ports.can.transmit({.identifier = 0x210}));
}

TEST_F(FakeBoardTest, ReportsTheScriptedErrorState) {
  ports.can.recover();
  EXPECT_EQ(board.can.recoveries(), 0) << "only bus-off needs recovery";
  board.can.set_error_state(CanErrorState::kBusOff);
  board.can.set_error_counts(255, 12);
  const CanStatus expected{CanErrorState::kBusOff, 255, 12, 0};
  EXPECT_EQ(ports.can.status(), expected);
  ports.can.recover();
  EXPECT_EQ(board.can.recoveries(), 1);
}

TEST_F(FakeBoardTest, QueuesImuSamplesAndCountsTheOverrun) {
  for (std::uint32_t i = 0; i <= FakeImu::kCapacity; ++i) board.imu.deliver({.time_us = i});
  EXPECT_EQ(ports.imu.overruns(), 1);
  ImuSample sample;
  ASSERT_TRUE(ports.imu.read(sample));
  EXPECT_EQ(sample.time_us, 0u);
}

TEST_F(FakeBoardTest, KeepsTheLatestAnkleSampleOfEachSide) {
  board.ankles.deliver(Side::kLeft, {.time_us = 1});
  board.ankles.deliver(Side::kLeft, {.time_us = 2});
  AnkleSample sample;
  EXPECT_FALSE(ports.ankles.read(Side::kRight, sample));
  ASSERT_TRUE(ports.ankles.read(Side::kLeft, sample));
  EXPECT_EQ(sample.time_us, 2u);
  EXPECT_FALSE(ports.ankles.read(Side::kLeft, sample));
}

TEST_F(FakeBoardTest, RecordsTheWatchdogAndTheDriveEnableLine) {
  EXPECT_EQ(board.watchdog.last_kick_us(), std::nullopt);
  ports.watchdog.kick(1'000);
  ports.watchdog.kick(2'000);
  EXPECT_EQ(board.watchdog.kicks(), 2);
  EXPECT_EQ(board.watchdog.last_kick_us(), 2'000u);

  EXPECT_FALSE(board.drive_enable.enabled()) << "low at reset";
  for (const bool level : {false, true, true, false}) ports.drive_enable.set(level);
  EXPECT_THAT(board.drive_enable.changes(), ElementsAre(true, false));
}

}  // namespace
}  // namespace koboshi::hal
