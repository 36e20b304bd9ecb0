#include "firmware/canopen/sdo/server.h"

#include <gtest/gtest.h>

#include <string>

#include "tests/unit/firmware/canopen/test_node.h"

namespace koboshi::canopen {
namespace {

// Wire vectors by CiA 301, 7.2.4.3, of node 0x10: requests on 0x610, responses on 0x590.
class SdoServerTest : public testing::Test {
 protected:
  void SetUp() override { device_.make_operational(); }
  std::vector<hal::CanFrame> ask(std::initializer_list<unsigned> bytes, std::uint64_t now_us = 0) {
    return device_.ask(can_frame(0x610, bytes), now_us);
  }
  static std::vector<hal::CanFrame> answer(std::initializer_list<unsigned> bytes) {
    return {can_frame(0x590, bytes)};
  }

  TestNode device_;
};

TEST_F(SdoServerTest, UploadsNumbersExpedited) {
  device_.values.controlword = 0x1234;
  device_.values.position = -2;
  EXPECT_EQ(ask({0x40, 0x00, 0x10, 0x00, 0, 0, 0, 0}),
            answer({0x43, 0x00, 0x10, 0x00, 0x92, 0x01, 0x02, 0x00}));
  EXPECT_EQ(ask({0x40, 0x01, 0x10, 0x00, 0, 0, 0, 0}), answer({0x4F, 0x01, 0x10, 0x00, 0x00, 0, 0, 0}));
  EXPECT_EQ(ask({0x40, 0x40, 0x60, 0x00, 0, 0, 0, 0}), answer({0x4B, 0x40, 0x60, 0x00, 0x34, 0x12, 0, 0}));
  EXPECT_EQ(ask({0x40, 0x64, 0x60, 0x00, 0, 0, 0, 0}),
            answer({0x43, 0x64, 0x60, 0x00, 0xFE, 0xFF, 0xFF, 0xFF}));
}

TEST_F(SdoServerTest, UploadsTheIdentity) {
  EXPECT_EQ(ask({0x40, 0x18, 0x10, 0x00, 0, 0, 0, 0}), answer({0x4F, 0x18, 0x10, 0x00, 0x04, 0, 0, 0}));
  EXPECT_EQ(ask({0x40, 0x18, 0x10, 0x01, 0, 0, 0, 0}),
            answer({0x43, 0x18, 0x10, 0x01, 0x44, 0x33, 0x22, 0x11}));
  EXPECT_EQ(ask({0x40, 0x18, 0x10, 0x02, 0, 0, 0, 0}), answer({0x43, 0x18, 0x10, 0x02, 0x55, 0, 0, 0}));
  EXPECT_EQ(ask({0x40, 0x18, 0x10, 0x03, 0, 0, 0, 0}), answer({0x43, 0x18, 0x10, 0x03, 0x02, 0, 0x01, 0}));
  EXPECT_EQ(ask({0x40, 0x18, 0x10, 0x04, 0, 0, 0, 0}), answer({0x43, 0x18, 0x10, 0x04, 0xFE, 0xCA, 0, 0}));
  EXPECT_EQ(ask({0x40, 0x00, 0x12, 0x01, 0, 0, 0, 0}), answer({0x43, 0x00, 0x12, 0x01, 0x10, 0x06, 0, 0}));
  EXPECT_EQ(ask({0x40, 0x00, 0x12, 0x02, 0, 0, 0, 0}), answer({0x43, 0x00, 0x12, 0x02, 0x90, 0x05, 0, 0}));
  EXPECT_EQ(ask({0x40, 0x14, 0x10, 0x00, 0, 0, 0, 0}), answer({0x43, 0x14, 0x10, 0x00, 0x90, 0x00, 0, 0}));
}

TEST_F(SdoServerTest, DownloadsNumbersExpedited) {
  EXPECT_EQ(ask({0x2B, 0x40, 0x60, 0x00, 0x0F, 0x00, 0, 0}), answer({0x60, 0x40, 0x60, 0x00, 0, 0, 0, 0}));
  EXPECT_EQ(device_.values.controlword, 0x0F);
  EXPECT_EQ(ask({0x23, 0x7A, 0x60, 0x00, 0x18, 0xFC, 0xFF, 0xFF}),
            answer({0x60, 0x7A, 0x60, 0x00, 0, 0, 0, 0}));
  EXPECT_EQ(device_.values.target, -1000);
  EXPECT_EQ(ask({0x2F, 0x60, 0x60, 0x00, 0xFF, 0, 0, 0}), answer({0x60, 0x60, 0x60, 0x00, 0, 0, 0, 0}));
  EXPECT_EQ(device_.values.mode, -1);
  EXPECT_EQ(ask({0x22, 0x40, 0x60, 0x00, 0x07, 0x00, 0, 0}), answer({0x60, 0x40, 0x60, 0x00, 0, 0, 0, 0}));
  EXPECT_EQ(device_.values.controlword, 0x07);
}

TEST_F(SdoServerTest, ConsultsTheOwnerBeforeItStores) {
  device_.verdict = AbortCode::kDeviceState;
  EXPECT_EQ(ask({0x2F, 0x60, 0x60, 0x00, 0xFF, 0, 0, 0}),
            answer({0x80, 0x60, 0x60, 0x00, 0x22, 0x00, 0x00, 0x08}));
  EXPECT_EQ(device_.values.mode, 0);
  ASSERT_EQ(device_.written.size(), 1u);
  EXPECT_EQ(static_cast<std::int32_t>(device_.written[0].value), -1);
}

TEST_F(SdoServerTest, UploadsTextsInSegments) {
  // "Koboshi test node": 17 bytes in segments of 7, 7 and 3.
  EXPECT_EQ(ask({0x40, 0x08, 0x10, 0x00, 0, 0, 0, 0}), answer({0x41, 0x08, 0x10, 0x00, 17, 0, 0, 0}));
  EXPECT_EQ(ask({0x60, 0, 0, 0, 0, 0, 0, 0}), answer({0x00, 'K', 'o', 'b', 'o', 's', 'h', 'i'}));
  EXPECT_EQ(ask({0x70, 0, 0, 0, 0, 0, 0, 0}), answer({0x10, ' ', 't', 'e', 's', 't', ' ', 'n'}));
  EXPECT_EQ(ask({0x60, 0, 0, 0, 0, 0, 0, 0}), answer({0x09, 'o', 'd', 'e', 0, 0, 0, 0}));
  EXPECT_EQ(ask({0x40, 0x09, 0x10, 0x00, 0, 0, 0, 0}), answer({0x41, 0x09, 0x10, 0x00, 1, 0, 0, 0}));
  EXPECT_EQ(ask({0x60, 0, 0, 0, 0, 0, 0, 0}), answer({0x0D, 'A', 0, 0, 0, 0, 0, 0}));
  EXPECT_EQ(ask({0x40, 0x0A, 0x10, 0x00, 0, 0, 0, 0}), answer({0x41, 0x0A, 0x10, 0x00, 5, 0, 0, 0}));
  EXPECT_EQ(ask({0x60, 0, 0, 0, 0, 0, 0, 0}), answer({0x05, '1', '.', '0', '.', '0', 0, 0}));
}

// The last segment is marked, also if it is full.
TEST_F(SdoServerTest, UploadsAnyNumberOfBytesInSegments) {
  for (std::size_t size = 1; size <= 22; ++size) {
    SCOPED_TRACE(size);
    device_.bytes.bytes = counted_bytes(size);
    EXPECT_EQ(ask({0x40, 0x00, 0x21, 1, 0, 0, 0, 0}),
              answer({0x41, 0x00, 0x21, 1, static_cast<unsigned>(size), 0, 0, 0}));
    std::vector<std::uint8_t> read;
    for (unsigned toggle = 0; device_.bytes.open != 0; toggle ^= 0x10) {
      ASSERT_LT(read.size(), size);
      const auto segment = ask({0x60 | toggle, 0, 0, 0, 0, 0, 0, 0});
      ASSERT_EQ(segment.size(), 1u);
      const unsigned command = segment[0].data[0];
      EXPECT_EQ(command & 0xF0, toggle);
      EXPECT_EQ((command & 1) != 0, device_.bytes.open == 0);
      read.insert(read.end(), segment[0].data.begin() + 1, segment[0].data.end() - (command >> 1 & 7));
    }
    EXPECT_EQ(read, device_.bytes.bytes);
  }
}

TEST_F(SdoServerTest, DownloadsInSegments) {
  EXPECT_EQ(ask({0x21, 0x40, 0x60, 0x00, 0x02, 0, 0, 0}), answer({0x60, 0x40, 0x60, 0x00, 0, 0, 0, 0}));
  EXPECT_EQ(ask({0x0C, 0x34, 0, 0, 0, 0, 0, 0}), answer({0x20, 0, 0, 0, 0, 0, 0, 0}));
  EXPECT_EQ(device_.values.controlword, 0);
  EXPECT_EQ(ask({0x1D, 0x12, 0, 0, 0, 0, 0, 0}), answer({0x30, 0, 0, 0, 0, 0, 0, 0}));
  EXPECT_EQ(device_.values.controlword, 0x1234);
  EXPECT_EQ(ask({0x20, 0x7A, 0x60, 0x00, 0, 0, 0, 0}), answer({0x60, 0x7A, 0x60, 0x00, 0, 0, 0, 0}));
  EXPECT_EQ(ask({0x07, 0xE8, 0x03, 0, 0, 0, 0, 0}), answer({0x20, 0, 0, 0, 0, 0, 0, 0}));
  EXPECT_EQ(device_.values.target, 1000);
}

// A number takes at most four bytes, in whatever segments they come and though the client has not told their
// number.
TEST_F(SdoServerTest, RefusesAFifthByteOfUnknownSize) {
  const auto too_long = answer({0x80, 0x7A, 0x60, 0x00, 0x12, 0x00, 0x07, 0x06});
  ask({0x20, 0x7A, 0x60, 0x00, 0, 0, 0, 0});
  EXPECT_EQ(ask({0x05, 1, 0, 0, 0, 0, 0, 0}), too_long);  // five bytes at once
  ask({0x20, 0x7A, 0x60, 0x00, 0, 0, 0, 0});
  EXPECT_EQ(ask({0x08, 1, 0, 0, 0, 0, 0, 0}), answer({0x20, 0, 0, 0, 0, 0, 0, 0}));  // three, and two
  EXPECT_EQ(ask({0x1B, 0, 0, 0, 0, 0, 0, 0}), too_long);
  ask({0x20, 0x7A, 0x60, 0x00, 0, 0, 0, 0});
  EXPECT_EQ(ask({0x06, 1, 0, 0, 0, 0, 0, 0}), answer({0x20, 0, 0, 0, 0, 0, 0, 0}));  // four, and one
  EXPECT_EQ(ask({0x1D, 0, 0, 0, 0, 0, 0, 0}), too_long);
  EXPECT_EQ(device_.values.target, 0);
}

TEST_F(SdoServerTest, AbortsATransferOfASilentClient) {
  ask({0x40, 0x08, 0x10, 0x00, 0, 0, 0, 0}, 5'000);
  device_.node.process(5'000 + SdoServer::kTimeout_us - 1);
  EXPECT_TRUE(device_.sink.take().empty());
  device_.node.process(5'000 + SdoServer::kTimeout_us);
  EXPECT_EQ(device_.sink.take(), answer({0x80, 0x08, 0x10, 0x00, 0x00, 0x00, 0x04, 0x05}));
  device_.node.process(10'000'000);
  EXPECT_TRUE(device_.sink.take().empty());
}

TEST_F(SdoServerTest, ANewTransferReplacesAnUnfinishedOne) {
  ask({0x40, 0x08, 0x10, 0x00, 0, 0, 0, 0});
  EXPECT_EQ(ask({0x40, 0x09, 0x10, 0x00, 0, 0, 0, 0}), answer({0x41, 0x09, 0x10, 0x00, 1, 0, 0, 0}));
  EXPECT_EQ(ask({0x60, 0, 0, 0, 0, 0, 0, 0}), answer({0x0D, 'A', 0, 0, 0, 0, 0, 0}));
}

TEST_F(SdoServerTest, LeavesAbortsAndShortFramesUnanswered) {
  ask({0x40, 0x08, 0x10, 0x00, 0, 0, 0, 0});
  EXPECT_TRUE(ask({0x80, 0x08, 0x10, 0x00, 0, 0, 0x04, 0x05}).empty());
  EXPECT_TRUE(ask({0x40, 0x08, 0x10, 0x00}).empty());
  EXPECT_EQ(ask({0x60, 0, 0, 0, 0, 0, 0, 0}), answer({0x80, 0, 0, 0, 0x01, 0x00, 0x04, 0x05}));
}

}  // namespace
}  // namespace koboshi::canopen
