#include "tools/studio/run/bus_monitor.h"

#include <gtest/gtest.h>

#include <chrono>
#include <condition_variable>
#include <mutex>

namespace koboshi::studio {
namespace {

using Kind = sim::Command::Kind;

// What is sent to a bus on which nobody answers.
struct SentFrames {
  std::vector<hal::CanFrame> take_all() {
    const std::scoped_lock lock(mutex);
    return frames;
  }
  // Waits until this many frames have been sent.
  bool wait_for(std::size_t count) {
    std::unique_lock lock(mutex);
    return sent.wait_for(lock, std::chrono::seconds(20), [&] { return frames.size() >= count; });
  }

  std::mutex mutex;
  std::condition_variable sent;
  std::vector<hal::CanFrame> frames;
};

class SilentBus final : public sim::Transport {
 public:
  explicit SilentBus(SentFrames& sent) : sent_(sent) {}
  bool send(const hal::CanFrame& frame, std::uint64_t /*time_us*/) override {
    const std::scoped_lock lock(sent_.mutex);
    sent_.frames.push_back(frame);
    sent_.sent.notify_all();
    return true;
  }
  std::optional<hal::CanFrame> receive() override { return std::nullopt; }
  std::string place() const override { return "silent"; }

 private:
  SentFrames& sent_;
};

sim::Command command(Kind kind) {
  sim::Command command;
  command.kind = kind;
  return command;
}

class BusMonitorTest : public ::testing::Test {
 protected:
  BusMonitorTest()
      : monitor(std::make_unique<BusMonitor>(
            std::make_unique<SilentBus>(sent),
            std::filesystem::path(KOBOSHI_SOURCE_DIR) / "robots/koboshi/robot.sdf")) {}
  // The bytes of the commands that have been sent.
  std::vector<int> commands() {
    std::vector<int> codes;
    for (const hal::CanFrame& frame : sent.take_all())
      if (frame.identifier == 0x201) codes.push_back(frame.data[0]);
    return codes;
  }

  SentFrames sent;
  std::unique_ptr<BusMonitor> monitor;
};

constexpr int kStopCode = 4;
constexpr int kWalkCode = 7;

TEST_F(BusMonitorTest, SendsNothingByItself) {
  monitor.reset();
  EXPECT_TRUE(sent.take_all().empty());
}

TEST_F(BusMonitorTest, StopsAWalkThatIsNotRepeated) {
  ASSERT_TRUE(monitor->give(command(Kind::kWalk)));
  ASSERT_TRUE(sent.wait_for(3));  // velocity, walk, stop
  EXPECT_EQ(commands(), (std::vector{kWalkCode, kStopCode}));
}

TEST_F(BusMonitorTest, StopsAWalkAtItsEnd) {
  ASSERT_TRUE(monitor->give(command(Kind::kWalk)));
  ASSERT_TRUE(sent.wait_for(2));
  monitor.reset();
  EXPECT_EQ(commands(), (std::vector{kWalkCode, kStopCode}));
}

TEST_F(BusMonitorTest, LeavesARobotThatDoesNotWalkAlone) {
  ASSERT_TRUE(monitor->give(command(Kind::kWalk)));
  ASSERT_TRUE(monitor->give(command(Kind::kEmergencyStop)));
  ASSERT_TRUE(sent.wait_for(3));
  monitor.reset();
  EXPECT_EQ(commands(), (std::vector{kWalkCode, 5}));
}

TEST_F(BusMonitorTest, TakesCommandsAndAccessesOnly) {
  EXPECT_FALSE(monitor->give(sim::Push()));
  EXPECT_FALSE(monitor->give(sim::Fault()));
  EXPECT_TRUE(monitor->give(sim::ObjectRequest{.number = 1, .node_id = 1, .address = {0x1000, 0}}));
}

}  // namespace
}  // namespace koboshi::studio
