#include "studio/run/bus_monitor.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <thread>
#include <utility>

#include "firmware/canopen/frame.h"

namespace koboshi::studio {
namespace {

using Kind = simulation::Command::Kind;

// How the controller on the bus answers accesses to the event timer of its velocity.
enum class Sdo { kAnswers, kRefuses, kSilent };

// Records what the monitor sends to the bus.
struct SentFrames {
  std::vector<hal::CanFrame> take_all() {
    const std::scoped_lock lock(mutex);
    return frames;
  }
  // The bytes of the commands that have been sent.
  std::vector<int> commands() {
    const std::scoped_lock lock(mutex);
    return commands_now();
  }
  // Waits until this many commands have been sent.
  bool wait_for(std::size_t count) {
    std::unique_lock lock(mutex);
    return sent.wait_for(lock, std::chrono::seconds(20), [&] { return commands_now().size() >= count; });
  }
  bool wait_for_access() {
    std::unique_lock lock(mutex);
    return sent.wait_for(lock, std::chrono::seconds(20),
                         [&] { return std::ranges::count(frames, 0x601, &hal::CanFrame::identifier) > 0; });
  }
  std::vector<int> commands_now() const {
    std::vector<int> codes;
    for (const hal::CanFrame& frame : frames)
      if (frame.identifier == 0x201) codes.push_back(frame.data[0]);
    return codes;
  }

  std::mutex mutex;
  std::condition_variable sent;
  std::vector<hal::CanFrame> frames;
  std::vector<sim_board::ForeignFrame> foreign{};  // set before the monitor starts: others on the bus
  Sdo sdo = Sdo::kAnswers;
  std::uint16_t timer_ms = 0;  // of the controller's 0x1401:05
};

class RobotBus final : public sim_board::Transport {
 public:
  explicit RobotBus(SentFrames& sent) : sent_(sent) {}
  bool send(const hal::CanFrame& frame, std::uint64_t /*time_us*/) override {
    const std::scoped_lock lock(sent_.mutex);
    if (frame.identifier == 0x601 && sent_.sdo != Sdo::kSilent) answer(frame.data);
    sent_.frames.push_back(frame);
    sent_.sent.notify_all();
    return true;
  }
  void watch_foreign(TakeForeign take) override { take_foreign_ = std::move(take); }
  std::optional<hal::CanFrame> receive() override {
    for (const sim_board::ForeignFrame& frame : std::exchange(sent_.foreign, {})) take_foreign_(frame);
    return std::exchange(answer_, std::nullopt);
  }
  std::string place() const override { return "test"; }

 private:
  void answer(const std::array<std::uint8_t, 8>& request) {
    answer_ = {.identifier = 0x581, .size = 8, .data = {0, request[1], request[2], request[3]}};
    const bool reads = request[0] == 0x40;
    if (sent_.sdo == Sdo::kRefuses) {
      answer_->data[0] = 0x80;
      canopen::store_u32(&answer_->data[4], 0x06090011);  // sub-index does not exist
    } else if (reads) {
      answer_->data[0] = 0x4B;
      canopen::store_u16(&answer_->data[4], sent_.timer_ms);
    } else {
      answer_->data[0] = 0x60;
      sent_.timer_ms = canopen::load_u16(&request[4]);
    }
  }

  SentFrames& sent_;
  TakeForeign take_foreign_;
  std::optional<hal::CanFrame> answer_;
};

simulation::Command command(Kind kind) {
  simulation::Command command;
  command.kind = kind;
  return command;
}

class BusMonitorTest : public ::testing::Test {
 protected:
  BusMonitorTest()
      : monitor(std::make_unique<BusMonitor>(
            std::make_unique<RobotBus>(sent),
            std::filesystem::path(KOBOSHI_SOURCE_DIR) / "robots/koboshi/robot.sdf")) {}

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
  ASSERT_TRUE(sent.wait_for(2));
  EXPECT_EQ(sent.commands(), (std::vector{kWalkCode, kStopCode}));
}

TEST_F(BusMonitorTest, StopsAWalkAtItsEnd) {
  ASSERT_TRUE(monitor->give(command(Kind::kWalk)));
  ASSERT_TRUE(sent.wait_for(1));
  monitor.reset();
  EXPECT_EQ(sent.commands(), (std::vector{kWalkCode, kStopCode}));
}

TEST_F(BusMonitorTest, LeavesARobotThatDoesNotWalkAlone) {
  ASSERT_TRUE(monitor->give(command(Kind::kWalk)));
  ASSERT_TRUE(sent.wait_for(1));
  ASSERT_TRUE(monitor->give(command(Kind::kEmergencyStop)));
  ASSERT_TRUE(sent.wait_for(2));
  monitor.reset();
  EXPECT_EQ(sent.commands(), (std::vector{kWalkCode, 5}));
}

// Accesses, the velocity and the walk, in this order; a stop and the former value at the end.
TEST_F(BusMonitorTest, ArmsTheRobotsDeadlineBeforeAWalkOnly) {
  sent.timer_ms = 7'000;
  ASSERT_TRUE(monitor->give(command(Kind::kWalk)));
  ASSERT_TRUE(sent.wait_for(1));
  std::vector<int> identifiers;
  for (const hal::CanFrame& frame : sent.take_all()) identifiers.push_back(frame.identifier);
  EXPECT_EQ(identifiers, (std::vector{0x601, 0x601, 0x301, 0x201}));
  EXPECT_EQ(sent.timer_ms, WalkDeadline::kDeadline_ms);
  EXPECT_EQ(monitor->walk_deadline(), WalkDeadline::State::kWorks);
  monitor.reset();
  EXPECT_EQ(sent.timer_ms, 7'000);
  EXPECT_EQ(sent.take_all().back().identifier, 0x601);
}

TEST_F(BusMonitorTest, WalksARobotThatRefusesTheDeadlineAndSaysSo) {
  sent.sdo = Sdo::kRefuses;
  ASSERT_TRUE(monitor->give(command(Kind::kWalk)));
  ASSERT_TRUE(sent.wait_for(1));
  EXPECT_EQ(sent.commands().front(), kWalkCode);
  EXPECT_EQ(monitor->walk_deadline(), WalkDeadline::State::kRefused);
}

// Nobody answers, and the velocity is not repeated: neither walk nor stop.
TEST_F(BusMonitorTest, WalksNoRobotThatDoesNotAnswer) {
  sent.sdo = Sdo::kSilent;
  ASSERT_TRUE(monitor->give(command(Kind::kWalk)));
  for (int i = 0; i < 2'000 && monitor->walk_deadline() != WalkDeadline::State::kSilent; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  EXPECT_EQ(monitor->walk_deadline(), WalkDeadline::State::kSilent);
  monitor.reset();
  EXPECT_TRUE(sent.commands().empty());
}

// The upload of a motion is such a client: while it uses the channel, the monitor does not.
TEST_F(BusMonitorTest, AccessesNoObjectWhileAnotherClientHasTheChannel) {
  auto loan = monitor->borrow_sdo();
  loan->wait();
  ASSERT_TRUE(monitor->give(simulation::ObjectRequest{.number = 1, .node_id = 1, .address = {0x1401, 5}}));
  for (std::size_t commands = 1; commands <= 3; ++commands) {
    ASSERT_TRUE(monitor->give(command(Kind::kEnable)));
    ASSERT_TRUE(sent.wait_for(commands));
  }
  EXPECT_EQ(sent.take_all().size(), 3U);  // nothing but commands
  loan.reset();
  ASSERT_TRUE(sent.wait_for_access());
  EXPECT_EQ(sent.take_all().back().identifier, 0x601);
}

TEST_F(BusMonitorTest, TakesCommandsAndAccessesOnly) {
  EXPECT_FALSE(monitor->give(simulation::Push()));
  EXPECT_FALSE(monitor->give(simulation::Fault()));
  EXPECT_TRUE(monitor->give(simulation::ObjectRequest{.number = 1, .node_id = 1, .address = {0x1000, 0}}));
}

// Others on the bus are reported once for each format, and the monitor goes on.
TEST(BusMonitorForeignFrames, AreReportedOnce) {
  SentFrames sent;
  const sim_board::ForeignFrame extended{.extended = true, .identifier = 0x18FEF100};
  sent.foreign = {extended, extended, {.kind = sim_board::ForeignFrame::Kind::kFd, .identifier = 0x123}};
  BusMonitor monitor(std::make_unique<RobotBus>(sent),
                     std::filesystem::path(KOBOSHI_SOURCE_DIR) / "robots/koboshi/robot.sdf");
  std::vector<view::Event> events;
  for (int i = 0; events.size() < 2 && i < 2'000; ++i) {
    if (auto batch = monitor.take(); batch.events) events = *batch.events;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  ASSERT_EQ(events.size(), 2u);
  EXPECT_EQ(events[0].text, "not decoded: 18FEF100#, 29-bit identifier; further ones are skipped");
  EXPECT_EQ(events[1].text, "not decoded: 123##0, CAN FD; further ones are skipped");
  EXPECT_EQ(monitor.error(), "");
}

}  // namespace
}  // namespace koboshi::studio
