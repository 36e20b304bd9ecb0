#include "firmware/canopen/sdo/protocol.h"
#include "tests/unit/firmware/canopen/sdo/conversation.h"

namespace koboshi::canopen {
namespace {

// Block uploads by CiA 301, 7.2.4.3.12 to 7.2.4.3.15, from the domain 0x2100:1 of node 0x10.
class SdoBlockUpload : public SdoConversation {
 protected:
  // Returns the segments of the block that the node sends now.
  std::vector<hal::CanFrame> take_block() {
    std::vector<hal::CanFrame> block;
    for (int i = 0; i < 127; ++i) {
      device_.node.process(now_us_ += 1'000);
      for (const hal::CanFrame& frame : device_.sink.take()) block.push_back(frame);
    }
    return block;
  }
  // Appends the data of a block's first `count` segments, in order and numbered from 1.
  void keep(const std::vector<hal::CanFrame>& block, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
      EXPECT_EQ(block[i].data[0] & 0x7F, i + 1);
      received_.insert(received_.end(), block[i].data.begin() + 1, block[i].data.end());
    }
  }
  void expect_end(const std::vector<hal::CanFrame>& end) {
    ASSERT_EQ(end.size(), 1u);
    for (int unused = end[0].data[0] >> 2 & 7; unused > 0; --unused) received_.pop_back();
    EXPECT_EQ(end[0].data[0] & 0xE3, 0xC1);
    EXPECT_EQ(load_u16(&end[0].data[1]), crc16(0, received_));
    EXPECT_EQ(received_, device_.bytes.bytes);
    EXPECT_TRUE(ask({0xA1, 0, 0, 0, 0, 0, 0, 0}).empty());
    EXPECT_EQ(device_.bytes.open, 0);
  }

  std::vector<std::uint8_t> received_;
};

TEST_F(SdoBlockUpload, TransfersAnyNumberOfBytesInBlocksOfAnySize) {
  for (const bool announces : {true, false}) {
    for (const std::size_t size : {0u, 1u, 6u, 7u, 8u, 14u, 889u, 2000u}) {
      for (const unsigned block_size : {1u, 3u, 127u}) {
        SCOPED_TRACE(testing::Message() << size << " bytes in blocks of " << block_size);
        device_.bytes.bytes = counted_bytes(size);
        device_.bytes.announces = announces;
        received_.clear();
        const auto low = static_cast<unsigned>(size);
        EXPECT_EQ(ask({0xA4, 0x00, 0x21, 1, block_size, 0, 0, 0}),
                  announces ? answer({0xC6, 0x00, 0x21, 1, low & 0xFF, low >> 8, 0, 0})
                            : answer({0xC4, 0x00, 0x21, 1, 0, 0, 0, 0}));
        EXPECT_TRUE(ask({0xA3, 0, 0, 0, 0, 0, 0, 0}).empty());
        auto last = false;
        std::vector<hal::CanFrame> end;
        while (!last) {
          const auto block = take_block();
          ASSERT_FALSE(block.empty());
          ASSERT_LE(block.size(), block_size);
          keep(block, block.size());
          last = (block.back().data[0] & 0x80) != 0;
          end = ask({0xA2, static_cast<unsigned>(block.size()), block_size, 0, 0, 0, 0, 0});
        }
        expect_end(end);
      }
    }
  }
}

TEST_F(SdoBlockUpload, RepeatsLostSegmentsAndChangesTheBlockSize) {
  device_.bytes.bytes = counted_bytes(100);
  ask({0xA4, 0x00, 0x21, 1, 10, 0, 0, 0});
  ask({0xA3, 0, 0, 0, 0, 0, 0, 0});
  auto block = take_block();
  ASSERT_EQ(block.size(), 10u);
  keep(block, 4);
  EXPECT_TRUE(ask({0xA2, 4, 5, 0, 0, 0, 0, 0}).empty());
  block = take_block();
  ASSERT_EQ(block.size(), 5u);
  keep(block, 5);
  ask({0xA2, 5, 127, 0, 0, 0, 0, 0});
  block = take_block();  // 37 bytes are left
  ASSERT_EQ(block.size(), 6u);
  EXPECT_TRUE(ask({0xA2, 0, 127, 0, 0, 0, 0, 0}).empty());
  block = take_block();
  keep(block, 6);
  expect_end(ask({0xA2, 6, 127, 0, 0, 0, 0, 0}));
}

TEST_F(SdoBlockUpload, LimitsTheSegmentsPerCycle) {
  device_.bytes.bytes = counted_bytes(100);
  ask({0xA4, 0x00, 0x21, 1, 10, 0, 0, 0});
  ask({0xA3, 0, 0, 0, 0, 0, 0, 0});
  device_.node.process(1'000);
  EXPECT_EQ(device_.sink.take().size(), static_cast<std::size_t>(SdoServer::kSegmentsPerProcess));
}

TEST_F(SdoBlockUpload, WaitsForFifoSpaceWithoutLoss) {
  device_.bytes.bytes = counted_bytes(100);
  ask({0xA4, 0x00, 0x21, 1, 127, 0, 0, 0});
  ask({0xA3, 0, 0, 0, 0, 0, 0, 0});
  device_.sink.room = 0;
  EXPECT_TRUE(take_block().empty());
  EXPECT_EQ(device_.node.lost_frames(), 0);
  EXPECT_EQ(device_.node.backlog(), 0u);
  device_.sink.room = 1'000;
  const auto block = take_block();
  keep(block, block.size());
  expect_end(ask({0xA2, 15, 127, 0, 0, 0, 0, 0}));
}

TEST_F(SdoBlockUpload, SwitchesTheProtocolForFewBytes) {
  device_.bytes.bytes = counted_bytes(20);
  EXPECT_EQ(ask({0xA4, 0x00, 0x21, 1, 10, 20, 0, 0}), answer({0x41, 0x00, 0x21, 1, 20, 0, 0, 0}));
  EXPECT_EQ(ask({0xA4, 0x00, 0x21, 1, 10, 19, 0, 0}), answer({0xC6, 0x00, 0x21, 1, 20, 0, 0, 0}));
  EXPECT_EQ(ask({0xA4, 0x02, 0x65, 0, 10, 4, 0, 0}), answer({0x43, 0x02, 0x65, 0, 0x80, 0, 0, 0}));
  EXPECT_EQ(ask({0xA4, 0x02, 0x65, 0, 10, 0, 0, 0}), answer({0xC6, 0x02, 0x65, 0, 4, 0, 0, 0}));
}

TEST_F(SdoBlockUpload, OmitsTheCrcForAClientWithoutOne) {
  device_.bytes.bytes = counted_bytes(3);
  ask({0xA0, 0x00, 0x21, 1, 10, 0, 0, 0});
  ask({0xA3, 0, 0, 0, 0, 0, 0, 0});
  ASSERT_EQ(take_block().size(), 1u);
  EXPECT_EQ(ask({0xA2, 1, 10, 0, 0, 0, 0, 0}), answer({0xD1, 0, 0, 0, 0, 0, 0, 0}));
}

TEST_F(SdoBlockUpload, TimesOutWithASilentClient) {
  device_.bytes.bytes = counted_bytes(3);
  ask({0xA4, 0x00, 0x21, 1, 10, 0, 0, 0});
  ask({0xA3, 0, 0, 0, 0, 0, 0, 0});
  take_block();
  device_.node.process(now_us_ + SdoServer::kTimeout_us);
  EXPECT_EQ(device_.sink.take(), answer({0x80, 0x00, 0x21, 1, 0, 0, 4, 5}));
  EXPECT_EQ(device_.bytes.open, 0);
}

}  // namespace
}  // namespace koboshi::canopen
