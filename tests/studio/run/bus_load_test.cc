#include "studio/run/bus_load.h"

#include <gtest/gtest.h>

#include <vector>

namespace koboshi::studio {
namespace {

// A SYNC message has 48 bits with stuffing, and 3 bits of intermission (sim_board/can/bus_test.cc).
constexpr double kSyncBits = 51.0;

// Each millisecond one message, from 1 ms on.
std::vector<view::Frame> syncs(std::uint64_t count) {
  std::vector<view::Frame> frames;
  for (std::uint64_t i = 1; i <= count; ++i) {
    view::Frame frame{.end_us = 1'000 * i};
    frame.frame.identifier = 0x080;
    frames.push_back(frame);
  }
  return frames;
}

TEST(LoadOfFrames, IsTheShareOfTheSecondBefore) {
  const std::vector<view::Frame> frames = syncs(3'000);
  EXPECT_DOUBLE_EQ(load_of_frames(frames, 2'000'000), 1'000 * kSyncBits / 1e6);
  EXPECT_DOUBLE_EQ(load_of_frames(frames, 3'000'000), 1'000 * kSyncBits / 1e6);
  // Half of that second is after the last frame, or before the first.
  EXPECT_DOUBLE_EQ(load_of_frames(frames, 3'500'000), 500 * kSyncBits / 1e6);
  EXPECT_DOUBLE_EQ(load_of_frames(frames, 500'000), 500 * kSyncBits / 1e6);
}

TEST(LoadOfFrames, CountsAFrameThatEndsNowAndNoneThatEndedBefore) {
  const std::vector<view::Frame> frames = syncs(1'000);
  EXPECT_DOUBLE_EQ(load_of_frames(frames, 1'000), kSyncBits / 1e6);
  EXPECT_EQ(load_of_frames(frames, 999), 0.0);
  EXPECT_DOUBLE_EQ(load_of_frames(frames, 10'000, 1'000), kSyncBits / 1e3);
  EXPECT_EQ(load_of_frames(frames, 2'000'000), 0.0);
  EXPECT_EQ(load_of_frames({}, 1'000), 0.0);
}

TEST(LoadOfFrames, IsOneOnAFullBus) {
  std::vector<view::Frame> frames;
  for (std::uint64_t end_us = 48; end_us <= 102'000; end_us += 51) {
    view::Frame frame{.end_us = end_us};
    frame.frame.identifier = 0x080;
    frames.push_back(frame);
  }
  EXPECT_NEAR(load_of_frames(frames, 102'000, 100'000), 1.0, 0.001);
}

}  // namespace
}  // namespace koboshi::studio
