#include <gtest/gtest.h>

#include <array>

#include "tests/support/sdo_oracle.h"
#include "tests/unit/firmware/canopen/test_node.h"

namespace koboshi::canopen {
namespace {

using test::Random;
using Answer = test::SdoOracle::Answer;

constexpr std::uint32_t kMaxBusy_ms = 4;  // per step of a transfer

// Random verdicts: sometimes busy for a few calls, sometimes an error.
class Mood {
 public:
  explicit Mood(Random& random) : random_(random) {}

  AbortCode verdict(std::uint32_t least_busy_ms = 0) {
    if (!thinking_) busy_ms_ = random_.below(4) == 0 ? random_.below(kMaxBusy_ms) : least_busy_ms;
    thinking_ = busy_ms_ > 0;
    if (busy_ms_ > 0) {
      --busy_ms_;
      return AbortCode::kBusy;
    }
    return random_.below(10) == 0 ? AbortCode::kHardwareError : AbortCode::kNone;
  }
  void forget() { thinking_ = false; }

 private:
  Random& random_;
  bool thinking_ = false;
  std::uint32_t busy_ms_ = 0;
};

// A domain in flash: committing the data takes time in each transfer.
class FlashDomain final : public Domain {
 public:
  explicit FlashDomain(Random& random) : random_(random), mood_(random) {}

  AbortCode begin_upload(std::uint32_t& size_bytes) override {
    length_ = random_.below(3) == 0 ? 0 : random_.below(300);
    if (random_.below(2) == 0) size_bytes = length_;
    return mood_.verdict();
  }
  std::size_t read(std::uint32_t position, std::span<std::uint8_t> bytes) override {
    return std::min<std::size_t>(bytes.size(), length_ - std::min(position, length_));
  }
  AbortCode begin_download(std::uint32_t) override { return mood_.verdict(); }
  AbortCode write(std::span<const std::uint8_t>) override { return mood_.verdict(); }
  AbortCode commit() override { return mood_.verdict(1); }
  void release() override { mood_.forget(); }

 private:
  Random& random_;
  Mood mood_;
  std::uint32_t length_ = 0;
};

class Owner final : public NodeApplication {
 public:
  explicit Owner(Random& random) : bytes_(random), mood_(random) {}
  AbortCode on_write(ObjectAddress, std::uint32_t) override { return mood_.verdict(); }
  Domain* domain(ObjectAddress) override { return &bytes_; }
  AbortCode on_store(ParameterGroup) override { return mood_.verdict(); }
  AbortCode on_restore(ParameterGroup) override { return mood_.verdict(); }

 private:
  FlashDomain bytes_;
  Mood mood_;
};

ObjectAddress random_object(Random& random) {
  static constexpr std::uint16_t kCommunication[] = {0x1000, 0x1003, 0x1005, 0x1008, 0x1010, 0x1011,
                                                     0x1014, 0x1016, 0x1017, 0x1018, 0x1029, 0x1200,
                                                     0x1400, 0x1600, 0x1800, 0x1A00, 0x1C00, 0x3000};
  const auto subindex = static_cast<std::uint8_t>(random.below(6));
  const std::uint16_t index =
      random.below(3) == 0 ? random.one_of(kCommunication) : random.one_of(kTestRows).index;
  return {index, subindex};
}

// The server answers each request that CiA 301 requires it to answer, after any history and with any
// behaviour of the object, and no other request.
TEST(SdoAnswers, ExistForEveryRequest) {
  constexpr std::uint64_t kSeed = 20250621;
  constexpr std::uint64_t kPatience_us = 100'000;  // the longest block takes 64 ms
  constexpr std::uint64_t kQuiet_us = 3 * kMaxBusy_ms * 1'000 + 1'000;
  SCOPED_TRACE(testing::Message() << "seed " << kSeed);
  Random random(kSeed);
  Owner owner(random);
  RecordingSink sink;
  TestValues values;
  NodeMemory<4, 4, 3, 4> memory;
  Node node(kTestDescription, {.node_id = 0x10, .values = std::as_writable_bytes(std::span(&values, 1))},
            memory.buffers(), sink, owner);
  node.start(0);
  test::SdoOracle oracle;
  std::uint64_t now_us = 0;
  std::array<int, 8> asked{};  // by command specifier
  for (int i = 0; i < 30'000; ++i) {
    sdo::Data request = oracle.next(random, random_object(random));
    if (random.below(8) == 0) {
      const ObjectAddress address = random_object(random);
      request = sdo::message(static_cast<std::uint8_t>(random.next()), address, random.next());
    }
    ++asked[request[0] >> 5];
    const auto owed = oracle.owed(request);
    sink.frames.clear();
    const hal::CanFrame asking{.identifier = 0x610, .size = 8, .data = request};
    node.on_frame(asking, now_us);
    std::uint64_t quiet_us = 0;
    for (std::uint64_t waited_us = 0; waited_us < kPatience_us && quiet_us < kQuiet_us; waited_us += 1'000) {
      const std::size_t before = sink.frames.size();
      now_us += 1'000;
      node.process(now_us);
      quiet_us = sink.frames.size() == before ? quiet_us + 1'000 : 0;
    }
    std::vector<hal::CanFrame> answers;
    for (const hal::CanFrame& frame : sink.take()) {
      if (frame.identifier == 0x590) answers.push_back(frame);
    }
    SCOPED_TRACE(testing::Message() << "request " << i << ": " << testing::PrintToString(asking));
    const bool aborted = answers.size() == 1 && answers[0].data[0] == sdo::kAbort;
    const bool perhaps = owed == Answer::kPerhapsAbort && aborted;
    ASSERT_EQ(!answers.empty(), owed == Answer::kOne || perhaps);
    oracle.note(request, answers);
  }
  for (std::size_t i = 0; i < asked.size(); ++i) EXPECT_GT(asked[i], 100) << "specifier " << i;
  const auto& completed = oracle.completed();
  EXPECT_GT(completed.expedited_downloads, 50);
  EXPECT_GT(completed.segmented_downloads, 50);
  EXPECT_GT(completed.block_downloads, 50);
  EXPECT_GT(completed.expedited_uploads, 50);
  EXPECT_GT(completed.segmented_uploads, 50);
  EXPECT_GT(completed.block_uploads, 50);
}

}  // namespace
}  // namespace koboshi::canopen
