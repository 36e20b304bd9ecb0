#include "firmware/canopen/sdo/protocol.h"
#include "tests/unit/firmware/canopen/sdo/conversation.h"

namespace koboshi::canopen {
namespace {

// Downloads to an object that is busy for a while, as flash is. The client of node 0x10 waits.
class SdoBusy : public SdoConversation {
 protected:
  std::vector<hal::CanFrame> pass(std::uint64_t time_us) {
    now_us_ += time_us;
    device_.node.process(now_us_);
    return device_.sink.take();
  }
};

TEST_F(SdoBusy, InitiationIsAnsweredOnceTheObjectIsReady) {
  device_.bytes.begin_verdict = AbortCode::kBusy;
  EXPECT_TRUE(ask({0x21, 0x00, 0x21, 1, 9, 0, 0, 0}).empty());
  EXPECT_TRUE(pass(1'000).empty());
  device_.bytes.begin_verdict = AbortCode::kNone;
  EXPECT_EQ(pass(1'000), answer({0x60, 0x00, 0x21, 1, 0, 0, 0, 0}));
  EXPECT_TRUE(pass(1'000).empty());
  EXPECT_EQ(device_.bytes.open, 1);
}

TEST_F(SdoBusy, AServerDelayIsNoTimeOutOfTheClient) {
  device_.bytes.begin_verdict = AbortCode::kBusy;
  EXPECT_TRUE(ask({0x21, 0x00, 0x21, 1, 9, 0, 0, 0}).empty());
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(pass(900'000).empty());
  device_.bytes.begin_verdict = AbortCode::kNone;
  EXPECT_EQ(pass(1'000), answer({0x60, 0x00, 0x21, 1, 0, 0, 0, 0}));
  EXPECT_EQ(pass(1'000'000), answer({0x80, 0x00, 0x21, 1, 0x00, 0x00, 0x04, 0x05}));  // after this time the
                                                                                      // transfer is aborted
}

TEST_F(SdoBusy, ADelayedRefusalReachesTheClient) {
  device_.bytes.begin_verdict = AbortCode::kBusy;
  EXPECT_TRUE(ask({0x21, 0x00, 0x21, 1, 9, 0, 0, 0}).empty());
  device_.bytes.begin_verdict = AbortCode::kHardwareError;
  EXPECT_EQ(pass(1'000), answer({0x80, 0x00, 0x21, 1, 0x00, 0x00, 0x06, 0x06}));
}

TEST_F(SdoBusy, ClientMayGiveUp) {
  device_.bytes.begin_verdict = AbortCode::kBusy;
  EXPECT_TRUE(ask({0x21, 0x00, 0x21, 1, 9, 0, 0, 0}).empty());
  EXPECT_TRUE(ask({0x80, 0x00, 0x21, 1, 0, 0, 0x04, 0x05}).empty());
  device_.bytes.begin_verdict = AbortCode::kNone;
  EXPECT_TRUE(pass(1'000).empty());
  EXPECT_EQ(device_.bytes.open, 0);
}

TEST_F(SdoBusy, PendingSegmentsAreProcessedOnce) {
  ask({0x21, 0x00, 0x21, 1, 9, 0, 0, 0});
  device_.bytes.write_verdict = AbortCode::kBusy;
  EXPECT_TRUE(ask({0x00, 1, 2, 3, 4, 5, 6, 7}).empty());
  EXPECT_TRUE(pass(1'000).empty());
  device_.bytes.write_verdict = AbortCode::kNone;
  EXPECT_EQ(pass(1'000), answer({0x20, 0, 0, 0, 0, 0, 0, 0}));
  device_.bytes.commit_verdict = AbortCode::kBusy;
  EXPECT_TRUE(ask({0x1B, 8, 9, 0, 0, 0, 0, 0}).empty());
  EXPECT_TRUE(pass(1'000).empty());
  EXPECT_EQ(device_.bytes.arriving.size(), 9u);
  device_.bytes.commit_verdict = AbortCode::kNone;
  EXPECT_EQ(pass(1'000), answer({0x30, 0, 0, 0, 0, 0, 0, 0}));
  EXPECT_EQ(device_.bytes.bytes, (std::vector<std::uint8_t>{1, 2, 3, 4, 5, 6, 7, 8, 9}));
  EXPECT_EQ(device_.bytes.open, 0);
}

TEST_F(SdoBusy, AnExpeditedDownloadIsProcessedOnceForABusyDomain) {
  device_.bytes.begin_verdict = AbortCode::kBusy;
  EXPECT_TRUE(ask({0x2B, 0x00, 0x21, 1, 8, 9, 0, 0}).empty());
  device_.bytes.begin_verdict = AbortCode::kNone;
  device_.bytes.write_verdict = AbortCode::kBusy;
  EXPECT_TRUE(pass(1'000).empty());
  device_.bytes.write_verdict = AbortCode::kNone;
  device_.bytes.commit_verdict = AbortCode::kBusy;
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(pass(1'000).empty());
  EXPECT_EQ(device_.bytes.begun_count, 1);
  device_.bytes.commit_verdict = AbortCode::kNone;
  EXPECT_EQ(pass(1'000), answer({0x60, 0x00, 0x21, 1, 0, 0, 0, 0}));
  EXPECT_EQ(device_.bytes.bytes, (std::vector<std::uint8_t>{8, 9}));
  EXPECT_EQ(device_.bytes.announced, 2u);
  EXPECT_EQ(device_.bytes.open, 0);
}

TEST_F(SdoBusy, APendingExpeditedDownloadYieldsToAnotherRequest) {
  device_.bytes.commit_verdict = AbortCode::kBusy;
  EXPECT_TRUE(ask({0x2B, 0x00, 0x21, 1, 8, 9, 0, 0}).empty());
  EXPECT_EQ(ask({0x00, 1, 2, 3, 4, 5, 6, 7}), answer({0x80, 0x00, 0x21, 1, 0x01, 0x00, 0x04, 0x05}));
  EXPECT_EQ(device_.bytes.open, 0);
  EXPECT_TRUE(ask({0x2B, 0x00, 0x21, 1, 8, 9, 0, 0}).empty());
  EXPECT_EQ(ask({0x40, 0x02, 0x65, 0, 0, 0, 0, 0}), answer({0x43, 0x02, 0x65, 0, 0x80, 0, 0, 0}));
  EXPECT_EQ(device_.bytes.open, 0);
}

TEST_F(SdoBusy, EndsWithAnAbortWhenItsObjectStaysBusy) {
  device_.bytes.commit_verdict = AbortCode::kBusy;
  EXPECT_TRUE(ask({0x2B, 0x00, 0x21, 1, 8, 9, 0, 0}).empty());
  EXPECT_TRUE(pass(SdoServer::kBusyTimeout_us - 1).empty());
  EXPECT_EQ(pass(1), answer({0x80, 0x00, 0x21, 1, 0x00, 0x00, 0x04, 0x05}));
  EXPECT_EQ(device_.bytes.open, 0);
  EXPECT_TRUE(pass(1'000).empty());
}

TEST_F(SdoBusy, SegmentsOfABlockAreRequestedAgain) {
  const auto data = counted_bytes(21);
  const unsigned crc = crc16(0, data);
  const auto segment = [&](unsigned sequence, std::size_t start) {
    hal::CanFrame frame = can_frame(0x610, {sequence, 0, 0, 0, 0, 0, 0, 0});
    std::copy_n(data.begin() + static_cast<std::ptrdiff_t>(start), 7, frame.data.begin() + 1);
    return device_.ask(frame, now_us_);
  };
  ask({0xC6, 0x00, 0x21, 1, 21, 0, 0, 0});
  EXPECT_TRUE(segment(1, 0).empty());
  device_.bytes.write_verdict = AbortCode::kBusy;  // applies to the first segment; the second waits for it
  EXPECT_TRUE(segment(2, 7).empty());
  EXPECT_EQ(segment(0x83, 14), answer({0xA2, 1, 127, 0, 0, 0, 0, 0}));
  device_.bytes.write_verdict = AbortCode::kNone;
  EXPECT_TRUE(segment(1, 7).empty());
  EXPECT_EQ(segment(0x82, 14), answer({0xA2, 2, 127, 0, 0, 0, 0, 0}));
  device_.bytes.write_verdict = AbortCode::kBusy;  // and to the last segment; the end request waits for it
  EXPECT_TRUE(ask({0xC1, crc & 0xFF, crc >> 8, 0, 0, 0, 0, 0}).empty());
  device_.bytes.write_verdict = AbortCode::kNone;
  device_.bytes.commit_verdict = AbortCode::kBusy;
  EXPECT_TRUE(pass(1'000).empty());
  device_.bytes.commit_verdict = AbortCode::kNone;
  EXPECT_EQ(pass(1'000), answer({0xA1, 0, 0, 0, 0, 0, 0, 0}));
  EXPECT_EQ(device_.bytes.bytes, data);
}

TEST_F(SdoBusy, StoringIsAnsweredOnceComplete) {
  NodeDescription description = kTestDescription;
  description.stored_groups = group_bit(ParameterGroup::kAll);
  TestNode storing(0x10, description);
  storing.make_operational();
  storing.verdict = AbortCode::kBusy;
  EXPECT_TRUE(storing.ask(can_frame(0x610, {0x23, 0x10, 0x10, 1, 0x73, 0x61, 0x76, 0x65})).empty());
  storing.node.process(1'000);
  EXPECT_TRUE(storing.sink.take().empty());
  storing.verdict = AbortCode::kNone;
  storing.node.process(2'000);
  EXPECT_EQ(storing.sink.take(), answer({0x60, 0x10, 0x10, 1, 0, 0, 0, 0}));
}

}  // namespace
}  // namespace koboshi::canopen
