#include "sim_board/can/transport/background_transport.h"

#include <gtest/gtest.h>

#include <chrono>
#include <stdexcept>

namespace koboshi::sim_board {
namespace {

// Both ends of it, for a test's thread and the other one.
struct Ends {
  std::mutex mutex;
  std::vector<hal::CanFrame> heard;
  std::vector<hal::CanFrame> said;  // the last one first
  std::size_t room = 1'000'000;
  bool gone = false;
};

class SharedOutside final : public Transport {
 public:
  explicit SharedOutside(Ends& ends) : ends_(ends) {}

  bool send(const hal::CanFrame& frame, std::uint64_t) override {
    const std::lock_guard lock(ends_.mutex);
    if (ends_.heard.size() >= ends_.room) return false;
    ends_.heard.push_back(frame);
    return true;
  }
  std::optional<hal::CanFrame> receive() override {
    const std::lock_guard lock(ends_.mutex);
    if (ends_.gone) throw std::runtime_error("it is gone");
    if (ends_.said.empty()) return std::nullopt;
    const hal::CanFrame frame = ends_.said.back();
    ends_.said.pop_back();
    return frame;
  }
  std::string place() const override { return "outside"; }

 private:
  Ends& ends_;
};

hal::CanFrame numbered(std::uint16_t number) { return {.identifier = number, .size = 1, .data = {7}}; }

class BackgroundTransportTest : public testing::Test {
 protected:
  void open() { transport_.emplace(std::make_unique<SharedOutside>(ends_)); }
  void close() { transport_.reset(); }
  // Within ten seconds.
  hal::CanFrame receive() {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(10);
    while (std::chrono::steady_clock::now() < end) {
      if (const auto frame = transport_->receive()) return *frame;
      std::this_thread::yield();
    }
    ADD_FAILURE() << "nothing came in";
    return {};
  }

  Ends ends_;
  std::optional<BackgroundTransport> transport_;
};

TEST_F(BackgroundTransportTest, SendsAllFramesInOrderBeforeItEnds) {
  open();
  for (std::uint16_t i = 0; i < 2'000; ++i) ASSERT_TRUE(transport_->send(numbered(i), i));
  close();
  ASSERT_EQ(ends_.heard.size(), 2'000u);
  for (std::uint16_t i = 0; i < 2'000; ++i) EXPECT_EQ(ends_.heard[i], numbered(i));
}

TEST_F(BackgroundTransportTest, ReceivesAllFramesInOrder) {
  for (std::uint16_t i = 500; i > 0; --i) ends_.said.push_back(numbered(i));
  open();
  for (std::uint16_t i = 1; i <= 500; ++i) EXPECT_EQ(receive(), numbered(i));
  EXPECT_EQ(transport_->receive(), std::nullopt);
}

TEST_F(BackgroundTransportTest, RejectsFramesWhenFullWithoutBlocking) {
  ends_.room = 10;
  open();
  std::size_t taken = 0;
  for (std::size_t i = 0; i < 3 * BackgroundTransport::kCapacity; ++i) {
    if (transport_->send(numbered(1), i)) ++taken;
  }
  EXPECT_GE(taken, BackgroundTransport::kCapacity);
  EXPECT_LE(taken, 2 * BackgroundTransport::kCapacity + 10);
  close();
  EXPECT_EQ(ends_.heard.size(), 10u);
}

TEST_F(BackgroundTransportTest, StopsReadingWhenItsQueueIsFull) {
  for (std::size_t i = 0; i < 4 * BackgroundTransport::kCapacity; ++i) ends_.said.push_back(numbered(1));
  open();
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  close();
  EXPECT_GE(ends_.said.size(), 2 * BackgroundTransport::kCapacity);
}

TEST_F(BackgroundTransportTest, ReportsThatThePeerIsGone) {
  ends_.gone = true;
  open();
  EXPECT_THROW(receive(), std::runtime_error);
  EXPECT_EQ(transport_->receive(), std::nullopt);
}

}  // namespace
}  // namespace koboshi::sim_board
