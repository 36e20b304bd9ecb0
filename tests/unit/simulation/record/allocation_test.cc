#include <gtest/gtest.h>

#include <vector>

#include "sim_board/can/bus.h"
#include "simulation/record/recorder.h"
#include "tests/support/allocations.h"
#include "tests/support/temporary_folder.h"

namespace koboshi::simulation {
namespace {

using koboshi::test::allocations;

class Sender final : public sim_board::BusNode {
 public:
  void on_frame(const hal::CanFrame&, std::uint64_t) override {}
};

TEST(Step, DoesNotAllocateForBusAndRecord) {
  test::TemporaryFolder folder;
  Recorder recorder(folder.path, std::vector<TraceColumn>(200, {"x", "m"}), WhenFull::kWait);
  const std::vector<TraceValue> row(200, TraceValue(0.125));
  sim_board::Bus bus;
  bus.set_observer(&recorder);
  std::vector<Sender> nodes(21);
  std::vector<sim_board::NodeHandle> handles;
  for (Sender& node : nodes) handles.push_back(bus.attach(node, sim_board::AcceptanceFilter::all(), 4));
  bus.advance_to(1000);

  // The first advance built the table of receivers. The recorder's own thread does not count.
  const long before = allocations();
  ASSERT_GT(before, 21) << "the counter counts";
  for (std::uint64_t cycle = 1; cycle <= 1000; ++cycle) {
    for (std::size_t i = 0; i < handles.size(); ++i) {
      const auto identifier = static_cast<std::uint16_t>(0x180 + i);
      ASSERT_TRUE(
          bus.queue(handles[i], {.identifier = identifier, .size = 8, .remote = false, .data = {}}, 0));
    }
    bus.advance_to(cycle * 10'000);
    recorder.row(cycle * 10'000, row);
  }
  const long during = allocations() - before;
  EXPECT_EQ(during, 0);
  EXPECT_EQ(bus.usage().frames, 21'000u);
}

}  // namespace
}  // namespace koboshi::simulation
