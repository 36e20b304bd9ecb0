#include "hal/lockstep/batch_board.h"

#include <gtest/gtest.h>

#include "hal/fake/storage.h"

namespace koboshi::hal {
namespace {

struct BatchBoardTest : testing::Test {
  FakeStorage storage;
  BatchBoard batch{storage};
  Board board = batch.board();
  BatchInput input;

  BatchBoardTest() { input.transmit_space.fill(BatchOutput::kMaxFrames); }

  void add_frames(std::size_t count, std::uint16_t first = 0) {
    for (std::size_t i = 0; i < count; ++i) {
      ASSERT_TRUE(input.frames.push({.identifier = static_cast<std::uint16_t>(first + i)}));
    }
  }
};

TEST_F(BatchBoardTest, ServesFramesAndSamplesInOrder) {
  add_frames(3, 0x100);
  ASSERT_TRUE(input.imu.push({.time_us = 1}));
  ASSERT_TRUE(input.imu.push({.time_us = 2}));
  batch.begin(input);
  CanFrame frame;
  for (const int identifier : {0x100, 0x101, 0x102}) {
    ASSERT_TRUE(board.can.receive(frame));
    EXPECT_EQ(frame.identifier, identifier);
  }
  EXPECT_FALSE(board.can.receive(frame));
  EXPECT_EQ(frame.identifier, 0x102) << "untouched";
  ImuSample sample;
  for (const std::uint32_t time_us : {1u, 2u}) {
    ASSERT_TRUE(board.imu.read(sample));
    EXPECT_EQ(sample.time_us, time_us);
  }
  EXPECT_FALSE(board.imu.read(sample));
}

TEST_F(BatchBoardTest, KeepsUnreadInputForTheNextCall) {
  add_frames(1, 0x100);
  ASSERT_TRUE(input.imu.push({.time_us = 1}));
  input.ankle_fresh = {true, false};
  input.ankles[0].time_us = 7;
  batch.begin(input);
  input = BatchInput{};
  add_frames(1, 0x200);
  batch.begin(input);
  CanFrame frame;
  ASSERT_TRUE(board.can.receive(frame));
  EXPECT_EQ(frame.identifier, 0x100);
  ASSERT_TRUE(board.can.receive(frame));
  EXPECT_EQ(frame.identifier, 0x200);
  ImuSample sample;
  EXPECT_TRUE(board.imu.read(sample));
  AnkleSample ankle;
  EXPECT_TRUE(board.ankles.read(Side::kLeft, ankle));
  EXPECT_EQ(ankle.time_us, 7u);
}

TEST_F(BatchBoardTest, CountsDroppedFramesAndSamples) {
  add_frames(BatchInput::kMaxFrames);
  for (std::uint32_t i = 0; i < BatchInput::kMaxImuSamples; ++i) ASSERT_TRUE(input.imu.push({.time_us = i}));
  input.can_status.receive_overruns = 5;
  input.imu_overruns = 0xFFFE;
  batch.begin(input);
  EXPECT_EQ(board.can.status().receive_overruns, 5);
  EXPECT_EQ(board.imu.overruns(), 0xFFFE);
  CanFrame frame;
  ASSERT_TRUE(board.can.receive(frame));
  batch.begin(input);  // 63 frames are still queued, so 63 of 64 are lost
  EXPECT_EQ(board.can.status().receive_overruns, 5 + 63);
  EXPECT_EQ(board.imu.overruns(), 0xFFFF) << "saturates";
}

TEST_F(BatchBoardTest, TakesAsManyFramesAsTheFifoHasSpace) {
  input.transmit_space = {2, 0, 1};
  batch.begin(input);
  EXPECT_EQ(board.can.transmit_space(kProcessFifo), 2u);
  EXPECT_TRUE(board.can.transmit({.identifier = 1}));
  EXPECT_TRUE(board.can.transmit({.identifier = 2}));
  EXPECT_EQ(board.can.transmit_space(kProcessFifo), 0u);
  EXPECT_FALSE(board.can.transmit({.identifier = 3}));
  EXPECT_TRUE(board.can.transmit({.identifier = 0x701})) << "a FIFO of its own";
  EXPECT_FALSE(board.can.transmit({.identifier = 0x701}));
  ASSERT_EQ(batch.end().frames.size, 3);
  EXPECT_EQ(batch.end().frames.items[1].identifier, 2);
}

TEST_F(BatchBoardTest, TakesNoMoreFramesThanOneMessageCarries) {
  input.transmit_space.fill(1000);
  batch.begin(input);
  EXPECT_EQ(board.can.transmit_space(kProcessFifo), BatchOutput::kMaxFrames);
  for (std::size_t i = 0; i < BatchOutput::kMaxFrames; ++i) EXPECT_TRUE(board.can.transmit({}));
  EXPECT_FALSE(board.can.transmit({}));
}

TEST_F(BatchBoardTest, KeepsTheDriveEnableLineAndClearsTheRest) {
  input.can_status.state = CanErrorState::kBusOff;
  batch.begin(input);
  EXPECT_FALSE(batch.end().drive_enabled) << "low at reset";
  board.drive_enable.set(true);
  board.watchdog.kick(0);
  board.can.recover();
  ASSERT_TRUE(board.can.transmit({}));
  EXPECT_TRUE(batch.end().drive_enabled);
  EXPECT_TRUE(batch.end().watchdog_kicked);
  EXPECT_TRUE(batch.end().recover);
  batch.begin(input);
  EXPECT_TRUE(batch.end().drive_enabled);
  EXPECT_FALSE(batch.end().watchdog_kicked);
  EXPECT_FALSE(batch.end().recover);
  EXPECT_EQ(batch.end().frames.size, 0);
  board.drive_enable.set(false);
  EXPECT_FALSE(batch.end().drive_enabled);
}

TEST_F(BatchBoardTest, RecoversFromBusOffOnly) {
  input.can_status.state = CanErrorState::kErrorPassive;
  batch.begin(input);
  board.can.recover();
  EXPECT_FALSE(batch.end().recover);
}

TEST_F(BatchBoardTest, DeliversEachAnkleSampleOnce) {
  input.ankle_fresh = {false, true};
  input.ankles[1].force_raw = {1, 2, 3};
  batch.begin(input);
  AnkleSample sample;
  EXPECT_FALSE(board.ankles.read(Side::kLeft, sample));
  ASSERT_TRUE(board.ankles.read(Side::kRight, sample));
  EXPECT_EQ(sample, input.ankles[1]);
  EXPECT_FALSE(board.ankles.read(Side::kRight, sample));
}

TEST_F(BatchBoardTest, ForwardsStorage) { EXPECT_EQ(&board.storage, &storage); }

}  // namespace
}  // namespace koboshi::hal
