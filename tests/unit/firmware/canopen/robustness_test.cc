#include <gtest/gtest.h>

#include <array>

#include "firmware/canopen/sdo/client.h"
#include "tests/support/random_frames.h"
#include "tests/unit/firmware/canopen/test_node.h"

namespace koboshi::canopen {
namespace {

using test::Random;

// Half of the frames are noise; the others resemble messages that this node serves.
hal::CanFrame random_frame(Random& random) {
  static constexpr std::uint16_t kServed[] = {0x000, 0x080, 0x081, 0x210, 0x310, 0x590,
                                              0x610, 0x610, 0x610, 0x701, 0x6A0};
  static constexpr std::uint16_t kIndices[] = {
      0x1003, 0x1005, 0x1006, 0x1008, 0x1016, 0x1017, 0x1400, 0x1401, 0x1600, 0x1601, 0x1800, 0x1801,
      0x1A00, 0x1A01, 0x2000, 0x6060, 0x2100, 0x2100, 0x1010, 0x1014, 0x1015, 0x1019, 0x1029, 0x1201};
  static constexpr std::uint8_t kBlockCommands[] = {0xA0, 0xA1, 0xA2, 0xA3, 0xA4, 0xC0,
                                                    0xC1, 0xC2, 0xC6, 1,    2,    0x82};
  hal::CanFrame frame;
  for (std::uint8_t& byte : frame.data) byte = static_cast<std::uint8_t>(random.next());
  const bool noise = random.below(2) == 0;
  frame.identifier = static_cast<std::uint16_t>(noise ? random.below(0x800) : kServed[random.below(11)]);
  frame.size = static_cast<std::uint8_t>(noise ? random.below(9) : 8);
  frame.remote = noise && random.below(8) == 0;
  if (frame.identifier == 0x000) {
    frame = encode(NmtMessage{random.below(20) == 0 ? NmtCommand::kResetNode : NmtCommand::kStart, 0});
  }
  if ((frame.identifier == 0x610 || frame.identifier == 0x6A0) && random.below(2) == 0) {
    store_u16(&frame.data[1], kIndices[random.below(24)]);
    frame.data[3] = static_cast<std::uint8_t>(random.below(6));
    if (random.below(4) == 0) frame.data[0] = kBlockCommands[random.below(std::size(kBlockCommands))];
    if (random.below(2) == 0) store_u32(&frame.data[4], mapping(0x2000, frame.data[3], 32));
  }
  return frame;
}

// Values between guard words, which detect a write out of bounds even without a sanitizer.
struct Guarded {
  std::array<std::uint8_t, 64> before;
  TestValues values;
  std::array<std::uint8_t, 64> after;
};

TEST(Robustness, SurvivesRandomFrames) {
  const std::uint64_t frames = test::frames_to_survive();
  constexpr std::uint64_t kSeed = 20081127;
  SCOPED_TRACE(testing::Message() << "seed " << kSeed);
  Random random(kSeed);
  Guarded guarded{};
  guarded.before.fill(0xA5);
  guarded.after.fill(0x5A);
  RecordingSink sink;
  NodeMemory<4, 4, 3, 4> memory;
  class : public NodeApplication {
   public:
    Domain* domain(ObjectAddress) override { return &bytes; }
    TestDomain bytes;
  } application;
  application.bytes.bytes = counted_bytes(500);
  NodeDescription description = kTestDescription;
  description.second_sdo = {0x6A0, 0x6A1};
  Node node(description, {.node_id = 0x10, .values = std::as_writable_bytes(std::span(&guarded.values, 1))},
            memory.buffers(), sink, application);
  SdoClient client(node.sink(), 5'000);
  node.start(0);
  std::uint64_t now_us = 0;
  std::uint64_t sent = 0;
  for (std::uint64_t i = 0; i < frames; ++i) {
    now_us += random.below(2'000);
    const hal::CanFrame frame = random_frame(random);
    sink.room = random.below(4);
    node.on_frame(frame, now_us);
    client.on_frame(frame);
    static_cast<void>(client.begin_read(0x10, {0x1000, 0}, now_us));
    if (i % 7 == 0) node.process(now_us);
    client.process(now_us);
    sent += sink.take().size();
    ASSERT_TRUE(
        std::all_of(guarded.before.begin(), guarded.before.end(), [](auto byte) { return byte == 0xA5; }));
    ASSERT_TRUE(
        std::all_of(guarded.after.begin(), guarded.after.end(), [](auto byte) { return byte == 0x5A; }));
    ASSERT_LE(node.backlog(), 4u + TransmitQueue::kAnswerBacklog + TransmitQueue::kBackgroundBacklog);
    ASSERT_GE(application.bytes.open, 0);
    ASSERT_LE(application.bytes.open, 1);
    node.on_can_status({.state = static_cast<hal::CanErrorState>(random.below(3))}, now_us);
  }
  EXPECT_GT(sent, frames / 10);
  EXPECT_NE(node.state(), NmtState::kInitialising);
}

}  // namespace
}  // namespace koboshi::canopen
