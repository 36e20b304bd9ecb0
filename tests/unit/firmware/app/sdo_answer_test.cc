#include <gtest/gtest.h>

#include "firmware/app/dictionary.h"
#include "tests/support/controller_bench.h"
#include "tests/support/sdo_oracle.h"

namespace koboshi::app {
namespace {

using test::Random;
using Answer = test::SdoOracle::Answer;

constexpr std::uint16_t kRequest = 0x601;
constexpr std::uint16_t kResponse = 0x581;

canopen::ObjectAddress random_object(Random& random) {
  const canopen::Entry& row = random.one_of(kControllerNode.rows);
  const auto subindex = static_cast<std::uint8_t>(random.below(row.subindex + row.count + 2u));
  if (random.below(4) != 0) return {row.index, subindex};
  const bool profile = random.below(2) == 0;
  return {static_cast<std::uint16_t>(profile ? 0x1000 + random.below(0x20) : random.below(0x10000)),
          subindex};
}

// Accesses every object of the controller with every command specifier, while the robot obeys the writes.
TEST(ControllerSdo, AnswersEachRequest) {
  constexpr std::uint64_t kSeed = 20250622;
  constexpr int kPatience_ms = 400;  // saving all parameters takes this long
  SCOPED_TRACE(testing::Message() << "seed " << kSeed);
  Random random(kSeed);
  test::ControllerBench bench;
  bench.board.storage.complete_after(1);
  ASSERT_TRUE(bench.run_until(State::kLimp));
  test::SdoOracle oracle;
  for (int i = 0; i < 100'000; ++i) {
    canopen::sdo::Data request = oracle.next(random, random_object(random));
    if (random.below(8) == 0) request[0] = static_cast<std::uint8_t>(random.next());
    const hal::CanFrame asking{.identifier = kRequest, .size = 8, .data = request};
    const Answer owed = oracle.owed(request);
    bench.board.can.deliver(asking);
    std::vector<hal::CanFrame> answers;
    int quiet_ms = 0;
    for (int waited_ms = 0; waited_ms < kPatience_ms && quiet_ms < 3; ++waited_ms) {
      bench.sent.clear();
      bench.run_ms(1);
      const std::size_t before = answers.size();
      for (const auto& sent : bench.sent) {
        if (sent.frame.identifier == kResponse) answers.push_back(sent.frame);
      }
      const bool waits = owed == Answer::kOne && answers.empty();
      quiet_ms = waits || answers.size() != before ? 0 : quiet_ms + 1;
    }
    const bool perhaps =
        owed == Answer::kPerhapsAbort && answers.size() == 1 && answers[0].data[0] == canopen::sdo::kAbort;
    ASSERT_EQ(!answers.empty(), owed == Answer::kOne || perhaps)
        << "request " << i << ", command 0x" << std::hex << int(request[0]) << ", object 0x"
        << canopen::sdo::address_of(request).index << " sub " << int(request[3]);
    oracle.note(request, answers);
  }
  const auto& completed = oracle.completed();
  EXPECT_GT(completed.expedited_downloads, 50);
  EXPECT_GT(completed.segmented_downloads, 5);
  EXPECT_GT(completed.block_downloads, 5);
  EXPECT_GT(completed.expedited_uploads, 50);
  EXPECT_GT(completed.segmented_uploads, 5);
  EXPECT_GT(completed.block_uploads, 5);
}

}  // namespace
}  // namespace koboshi::app
