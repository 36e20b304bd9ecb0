#include "firmware/canopen/sdo/protocol.h"
#include "tests/unit/firmware/canopen/sdo/conversation.h"

namespace koboshi::canopen {
namespace {

// Block downloads by CiA 301, 7.2.4.3.9 to 7.2.4.3.11, to the domain 0x2100:1 of node 0x10.
class SdoBlockDownload : public SdoConversation {
 protected:
  // Sends segment `sequence` of a block whose first byte is at `start`, and returns the answers.
  std::vector<hal::CanFrame> send_segment(const std::vector<std::uint8_t>& data, std::size_t start,
                                          unsigned sequence) {
    const std::size_t from = start + 7 * (sequence - 1);
    const std::size_t size = std::min<std::size_t>(7, data.size() - from);
    hal::CanFrame frame = can_frame(0x610, {sequence, 0, 0, 0, 0, 0, 0, 0});
    if (from + size == data.size()) frame.data[0] |= 0x80;
    std::copy_n(data.begin() + static_cast<std::ptrdiff_t>(from), size, frame.data.begin() + 1);
    return device_.ask(frame, now_us_);
  }
  std::vector<hal::CanFrame> send_end(const std::vector<std::uint8_t>& data, unsigned crc) {
    const auto unused = static_cast<unsigned>((7 - data.size() % 7) % 7);
    return ask({0xC1 | unused << 2, crc & 0xFF, crc >> 8, 0, 0, 0, 0, 0});
  }
  void begin(std::size_t size) {
    const auto bytes = static_cast<unsigned>(size);
    EXPECT_EQ(ask({0xC6, 0x00, 0x21, 1, bytes & 0xFF, bytes >> 8, 0, 0}),
              answer({0xA4, 0x00, 0x21, 1, 127, 0, 0, 0}));
  }
};

TEST_F(SdoBlockDownload, TransfersAnyNumberOfBytes) {
  for (const std::size_t size : {1u, 6u, 7u, 8u, 13u, 14u, 888u, 889u, 890u, 5000u}) {
    SCOPED_TRACE(size);
    const auto data = counted_bytes(size);
    begin(size);
    EXPECT_EQ(device_.bytes.announced, size);
    for (std::size_t start = 0; start < size; start += 889) {
      const auto segments = static_cast<unsigned>(std::min<std::size_t>(127, (size - start + 6) / 7));
      for (unsigned sequence = 1; sequence < segments; ++sequence) {
        ASSERT_TRUE(send_segment(data, start, sequence).empty());
      }
      ASSERT_EQ(send_segment(data, start, segments), answer({0xA2, segments, 127, 0, 0, 0, 0, 0}));
    }
    EXPECT_EQ(send_end(data, crc16(0, data)), answer({0xA1, 0, 0, 0, 0, 0, 0, 0}));
    EXPECT_EQ(device_.bytes.bytes, data);
    EXPECT_EQ(device_.bytes.open, 0);
  }
}

TEST_F(SdoBlockDownload, NeedsNeitherSizeNorCrc) {
  const auto data = counted_bytes(10);
  EXPECT_EQ(ask({0xC0, 0x00, 0x21, 1, 99, 0, 0, 0}), answer({0xA4, 0x00, 0x21, 1, 127, 0, 0, 0}));
  EXPECT_EQ(device_.bytes.announced, Domain::kUnknownSize);
  send_segment(data, 0, 1);
  send_segment(data, 0, 2);
  EXPECT_EQ(send_end(data, 0), answer({0xA1, 0, 0, 0, 0, 0, 0, 0}));
  EXPECT_EQ(device_.bytes.bytes, data);
}

TEST_F(SdoBlockDownload, RequestsRepetitionOfLostSegments) {
  const auto data = counted_bytes(70);
  begin(data.size());
  for (const unsigned sequence : {1u, 2u, 3u, 5u, 6u, 7u, 8u, 9u}) {
    EXPECT_TRUE(send_segment(data, 0, sequence).empty());
  }
  EXPECT_EQ(send_segment(data, 0, 10), answer({0xA2, 3, 127, 0, 0, 0, 0, 0}));
  for (unsigned sequence = 1; sequence <= 6; ++sequence) send_segment(data, 21, sequence);
  EXPECT_EQ(send_segment(data, 21, 7), answer({0xA2, 7, 127, 0, 0, 0, 0, 0}));
  EXPECT_EQ(send_end(data, crc16(0, data)), answer({0xA1, 0, 0, 0, 0, 0, 0, 0}));
  EXPECT_EQ(device_.bytes.bytes, data);
}

TEST_F(SdoBlockDownload, RequestsLostLastSegmentsAgain) {
  const auto data = counted_bytes(70);
  begin(data.size());
  send_segment(data, 0, 1);
  send_segment(data, 0, 2);
  device_.node.process(SdoServer::kBlockTimeout_us - 1);
  EXPECT_TRUE(device_.sink.take().empty());
  device_.node.process(SdoServer::kBlockTimeout_us);
  EXPECT_EQ(device_.sink.take(), answer({0xA2, 2, 127, 0, 0, 0, 0, 0}));
  now_us_ = SdoServer::kBlockTimeout_us;
  for (unsigned sequence = 1; sequence <= 8; ++sequence) send_segment(data, 14, sequence);
  EXPECT_EQ(send_end(data, crc16(0, data)), answer({0xA1, 0, 0, 0, 0, 0, 0, 0}));
  EXPECT_EQ(device_.bytes.bytes, data);
}

// Each segment that arrives gives the client the whole patience again.
TEST_F(SdoBlockDownload, RequestsLostSegmentsAsOftenAsTheyAreLost) {
  const auto data = counted_bytes(70);
  begin(data.size());
  for (unsigned lost = 0; lost < 3; ++lost) {
    send_segment(data, 7 * lost, 1);
    now_us_ += SdoServer::kBlockTimeout_us;
    device_.node.process(now_us_);
    EXPECT_EQ(device_.sink.take(), answer({0xA2, 1, 127, 0, 0, 0, 0, 0}));
  }
  for (unsigned sequence = 1; sequence <= 7; ++sequence) send_segment(data, 21, sequence);
  EXPECT_EQ(send_end(data, crc16(0, data)), answer({0xA1, 0, 0, 0, 0, 0, 0, 0}));
  EXPECT_EQ(device_.bytes.bytes, data);
}

TEST_F(SdoBlockDownload, TimesOutWithASilentClient) {
  begin(70);
  device_.node.process(SdoServer::kBlockTimeout_us);
  EXPECT_EQ(device_.sink.take(), answer({0xA2, 0, 127, 0, 0, 0, 0, 0}));
  device_.node.process(SdoServer::kTimeout_us);
  EXPECT_EQ(device_.sink.take(), answer({0x80, 0x00, 0x21, 1, 0, 0, 4, 5}));
  EXPECT_EQ(device_.bytes.open, 0);
}

TEST_F(SdoBlockDownload, AlsoWritesNumbers) {
  EXPECT_EQ(ask({0xC2, 0x7A, 0x60, 0, 4, 0, 0, 0}), answer({0xA4, 0x7A, 0x60, 0, 127, 0, 0, 0}));
  EXPECT_EQ(ask({0x81, 0x18, 0xFC, 0xFF, 0xFF, 0, 0, 0}), answer({0xA2, 1, 127, 0, 0, 0, 0, 0}));
  EXPECT_EQ(ask({0xCD, 0, 0, 0, 0, 0, 0, 0}), answer({0xA1, 0, 0, 0, 0, 0, 0, 0}));
  EXPECT_EQ(device_.values.target, -1000);
}

TEST_F(SdoBlockDownload, CommitsNoAbortedTransfer) {
  device_.bytes.bytes = {42};
  begin(14);
  EXPECT_EQ(device_.bytes.open, 1);
  send_segment(counted_bytes(14), 0, 1);
  EXPECT_TRUE(ask({0x80, 0x00, 0x21, 1, 0, 0, 0, 8}).empty());
  EXPECT_EQ(device_.bytes.open, 0);
  EXPECT_EQ(device_.bytes.bytes, std::vector<std::uint8_t>{42});
  begin(14);
  device_.node.command(NmtCommand::kStop, 0);
  EXPECT_EQ(device_.bytes.open, 0);
}

}  // namespace
}  // namespace koboshi::canopen
