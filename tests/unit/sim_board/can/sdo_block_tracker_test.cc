#include "sim_board/can/sdo_block_tracker.h"

#include <gtest/gtest.h>

namespace koboshi::sim_board {
namespace {

class SdoBlockTrackerTest : public testing::Test {
 protected:
  bool client(const SdoBlockTracker::Data& data) { return tracker_.follow(data, true); }
  bool server(const SdoBlockTracker::Data& data) { return tracker_.follow(data, false); }

  void begin_download(std::uint8_t block_size) {
    EXPECT_FALSE(client({0xC6, 0x00, 0x21, 1, 40}));
    EXPECT_FALSE(server({0xA4, 0x00, 0x21, 1, block_size}));
  }
  void begin_upload(std::uint8_t block_size) {
    EXPECT_FALSE(client({0xA4, 0x00, 0x21, 1, block_size}));
    EXPECT_FALSE(server({0xC6, 0x00, 0x21, 1, 40}));
    EXPECT_FALSE(client({0xA3}));
  }

  SdoBlockTracker tracker_;
};

TEST_F(SdoBlockTrackerTest, FollowsADownloadOfTwoBlocks) {
  begin_download(2);
  EXPECT_TRUE(client({1}));
  EXPECT_TRUE(client({2}));
  EXPECT_FALSE(server({0xA2, 2, 127}));
  EXPECT_TRUE(client({1}));
  EXPECT_TRUE(client({0x82}));
  EXPECT_FALSE(server({0xA2, 2, 127}));
  EXPECT_FALSE(client({0xC1}));
  EXPECT_FALSE(server({0xA1}));
  EXPECT_FALSE(client({0x40, 0x18, 0x10, 1}));
}

TEST_F(SdoBlockTrackerTest, FollowsAnUploadOfTwoBlocks) {
  begin_upload(2);
  EXPECT_TRUE(server({1}));
  EXPECT_TRUE(server({2}));
  EXPECT_FALSE(client({0xA2, 2, 127}));
  EXPECT_TRUE(server({0x81}));
  EXPECT_FALSE(client({0xA2, 1, 127}));
  EXPECT_FALSE(server({0xC1}));
  EXPECT_FALSE(client({0xA1}));
  EXPECT_FALSE(server({0x43, 0x18, 0x10, 1}));
}

// The receiver confirms the first segment only.
TEST_F(SdoBlockTrackerTest, FollowsTheRepetitionOfLostSegments) {
  begin_download(127);
  EXPECT_TRUE(client({1}));
  EXPECT_TRUE(client({3}));
  EXPECT_TRUE(client({0x84}));
  EXPECT_FALSE(server({0xA2, 1, 127}));
  EXPECT_TRUE(client({1}));
  EXPECT_TRUE(client({2}));
  EXPECT_TRUE(client({0x83}));
  EXPECT_FALSE(server({0xA2, 3, 127}));
  EXPECT_FALSE(client({0xC1}));
}

TEST_F(SdoBlockTrackerTest, EndsWithAnAbortOfEitherSide) {
  for (const bool by_client : {true, false}) {
    begin_download(127);
    EXPECT_TRUE(client({0x40}));
    EXPECT_FALSE(tracker_.follow({0x80, 0x00, 0x21, 1}, by_client));
    EXPECT_FALSE(client({0x40, 0x18, 0x10, 1}));
    begin_upload(127);
    EXPECT_TRUE(server({0x43}));
    EXPECT_FALSE(tracker_.follow({0x80, 0x00, 0x21, 1}, by_client));
    EXPECT_FALSE(server({0x43, 0x18, 0x10, 1}));
  }
}

TEST_F(SdoBlockTrackerTest, TakesNoMessageOfOtherTransfersForASegment) {
  EXPECT_FALSE(client({0x40, 0x18, 0x10, 1}));
  EXPECT_FALSE(server({0x41, 0x18, 0x10, 1, 9}));
  EXPECT_FALSE(client({0x60}));
  EXPECT_FALSE(server({0x01}));
  EXPECT_FALSE(client({0xC6, 0x00, 0x21, 1, 40}));
  EXPECT_FALSE(server({0x80, 0x00, 0x21, 1}));  // refused
  EXPECT_FALSE(client({0x01}));
  EXPECT_FALSE(client({0xA4, 0x00, 0x21, 1, 127}));
  EXPECT_FALSE(server({0x4F, 0x00, 0x21, 1, 7}));  // answered without blocks
  EXPECT_FALSE(server({0x01}));
}

TEST_F(SdoBlockTrackerTest, KnowsAnUploadWhoseBeginningItHasMissed) {
  EXPECT_FALSE(client({0xA3}));
  EXPECT_TRUE(server({0x43}));
  tracker_.reset();
  EXPECT_FALSE(server({0x43, 0x18, 0x10, 1}));
}

}  // namespace
}  // namespace koboshi::sim_board
