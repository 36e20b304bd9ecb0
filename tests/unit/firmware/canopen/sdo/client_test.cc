#include "firmware/canopen/sdo/client.h"

#include <gtest/gtest.h>

#include "tests/unit/firmware/canopen/test_node.h"

namespace koboshi::canopen {
namespace {

class SdoClientTest : public testing::Test {
 protected:
  RecordingSink sink_;
  SdoClient client_{sink_, 10'000};
};

TEST_F(SdoClientTest, WritesExpedited) {
  ASSERT_TRUE(client_.begin_write(0x22, {0x6040, 0}, 0x0F, 2, 0));
  EXPECT_EQ(sink_.take(), std::vector{can_frame(0x622, {0x2B, 0x40, 0x60, 0x00, 0x0F, 0x00, 0, 0})});
  EXPECT_EQ(client_.state(), SdoState::kBusy);
  EXPECT_TRUE(client_.on_frame(can_frame(0x5A2, {0x60, 0x40, 0x60, 0x00, 0, 0, 0, 0})));
  EXPECT_EQ(client_.state(), SdoState::kDone);
}

TEST_F(SdoClientTest, ReportsEachSize) {
  const unsigned commands[] = {0x2F, 0x2B, 0x27, 0x23};
  for (std::size_t size = 1; size <= 4; ++size) {
    client_.reset();
    ASSERT_TRUE(client_.begin_write(1, {0x2000, 1}, 0, size, 0));
    EXPECT_EQ(sink_.take()[0].data[0], commands[size - 1]);
  }
  client_.reset();
  EXPECT_FALSE(client_.begin_write(1, {0x2000, 1}, 0, 0, 0));
  EXPECT_FALSE(client_.begin_write(1, {0x2000, 1}, 0, 5, 0));
}

TEST_F(SdoClientTest, ReadsExpedited) {
  ASSERT_TRUE(client_.begin_read(0x22, {0x6041, 0}, 0));
  EXPECT_EQ(sink_.take(), std::vector{can_frame(0x622, {0x40, 0x41, 0x60, 0x00, 0, 0, 0, 0})});
  EXPECT_TRUE(client_.on_frame(can_frame(0x5A2, {0x4B, 0x41, 0x60, 0x00, 0x37, 0x02, 0xAA, 0xBB})));
  EXPECT_EQ(client_.state(), SdoState::kDone);
  EXPECT_EQ(client_.value(), 0x0237u);
  EXPECT_EQ(client_.size(), 2u);
}

TEST_F(SdoClientTest, ReportsTheServersRefusal) {
  ASSERT_TRUE(client_.begin_write(0x22, {0x6041, 0}, 0, 2, 0));
  client_.on_frame(can_frame(0x5A2, {0x80, 0x41, 0x60, 0x00, 0x02, 0x00, 0x01, 0x06}));
  EXPECT_EQ(client_.state(), SdoState::kAborted);
  EXPECT_EQ(client_.abort_code(), AbortCode::kWriteOfReadOnly);
}

TEST_F(SdoClientTest, TimesOutExactly) {
  ASSERT_TRUE(client_.begin_read(0x22, {0x6041, 0}, 5'000));
  sink_.take();
  client_.process(14'999);
  EXPECT_EQ(client_.state(), SdoState::kBusy);
  client_.process(15'000);
  EXPECT_EQ(client_.state(), SdoState::kTimedOut);
  EXPECT_EQ(sink_.take(), std::vector{can_frame(0x622, {0x80, 0x41, 0x60, 0x00, 0x00, 0x00, 0x04, 0x05})});
  // A late answer changes nothing.
  EXPECT_FALSE(client_.on_frame(can_frame(0x5A2, {0x4B, 0x41, 0x60, 0x00, 0x37, 0x02, 0, 0})));
  EXPECT_EQ(client_.state(), SdoState::kTimedOut);
}

TEST_F(SdoClientTest, IgnoresFramesOfOtherTransfers) {
  ASSERT_TRUE(client_.begin_read(0x22, {0x6041, 0}, 0));
  EXPECT_FALSE(client_.on_frame(can_frame(0x5A3, {0x4B, 0x41, 0x60, 0x00, 1, 0, 0, 0})));
  EXPECT_FALSE(client_.on_frame(can_frame(0x5A2, {0x4B, 0x40, 0x60, 0x00, 1, 0, 0, 0})));
  EXPECT_FALSE(client_.on_frame(can_frame(0x5A2, {0x80, 0x40, 0x60, 0x00, 0, 0, 4, 5})));
  EXPECT_FALSE(client_.on_frame(can_frame(0x5A2, {0x4B, 0x41, 0x60})));
  hal::CanFrame remote = can_frame(0x5A2, {0x4B, 0x41, 0x60, 0x00, 1, 0, 0, 0});
  remote.remote = true;
  EXPECT_FALSE(client_.on_frame(remote));
  EXPECT_EQ(client_.state(), SdoState::kBusy);
}

TEST_F(SdoClientTest, ClearsTheLastRefusalOnANewTransfer) {
  ASSERT_TRUE(client_.begin_write(0x22, {0x6041, 0}, 0, 2, 0));
  client_.on_frame(can_frame(0x5A2, {0x80, 0x41, 0x60, 0x00, 0x02, 0x00, 0x01, 0x06}));
  ASSERT_TRUE(client_.begin_read(0x22, {0x6041, 0}, 0));
  EXPECT_EQ(client_.abort_code(), AbortCode::kNone);
}

TEST_F(SdoClientTest, AbortsOnAnInvalidResponse) {
  ASSERT_TRUE(client_.begin_read(0x22, {0x1008, 0}, 0));
  sink_.take();
  EXPECT_TRUE(client_.on_frame(can_frame(0x5A2, {0x41, 0x08, 0x10, 0x00, 17, 0, 0, 0})));
  EXPECT_EQ(client_.state(), SdoState::kAborted);
  EXPECT_EQ(client_.abort_code(), AbortCode::kCommandSpecifierUnknown);
  EXPECT_EQ(sink_.take(), std::vector{can_frame(0x622, {0x80, 0x08, 0x10, 0x00, 0x01, 0x00, 0x04, 0x05})});
}

TEST_F(SdoClientTest, AbortsOnTheResponseToTheOtherDirection) {
  ASSERT_TRUE(client_.begin_read(0x22, {0x6041, 0}, 0));
  EXPECT_TRUE(client_.on_frame(can_frame(0x5A2, {0x60, 0x41, 0x60, 0x00, 0, 0, 0, 0})));
  EXPECT_EQ(client_.state(), SdoState::kAborted);
  ASSERT_TRUE(client_.begin_write(0x22, {0x6040, 0}, 6, 2, 0));
  EXPECT_TRUE(client_.on_frame(can_frame(0x5A2, {0x4B, 0x40, 0x60, 0x00, 6, 0, 0, 0})));
  EXPECT_EQ(client_.state(), SdoState::kAborted);
  EXPECT_EQ(client_.abort_code(), AbortCode::kCommandSpecifierUnknown);
}

TEST_F(SdoClientTest, ReadsAsManyBytesAsTheServerIndicates) {
  const std::uint8_t commands[] = {0x4F, 0x4B, 0x47, 0x43};
  const std::uint32_t values[] = {0x11, 0x2211, 0x33'2211, 0x4433'2211};
  for (std::size_t size = 1; size <= 4; ++size) {
    ASSERT_TRUE(client_.begin_read(0x22, {0x6041, 0}, 0));
    client_.on_frame(can_frame(0x5A2, {commands[size - 1], 0x41, 0x60, 0x00, 0x11, 0x22, 0x33, 0x44}));
    ASSERT_EQ(client_.state(), SdoState::kDone);
    EXPECT_EQ(client_.size(), size);
    EXPECT_EQ(client_.value(), values[size - 1]);
  }
}

TEST_F(SdoClientTest, RunsOneTransferAtATime) {
  ASSERT_TRUE(client_.begin_read(0x22, {0x6041, 0}, 0));
  EXPECT_FALSE(client_.begin_read(0x23, {0x6041, 0}, 0));
  EXPECT_EQ(client_.server(), 0x22);
}

TEST_F(SdoClientTest, StartsNothingWithoutFifoSpace) {
  sink_.room = 0;
  EXPECT_FALSE(client_.begin_read(0x22, {0x6041, 0}, 0));
  EXPECT_EQ(client_.state(), SdoState::kIdle);
}

}  // namespace
}  // namespace koboshi::canopen
