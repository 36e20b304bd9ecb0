#include "firmware/canopen/transmit_queue.h"

#include <gtest/gtest.h>

#include <array>

#include "tests/unit/firmware/canopen/test_node.h"

namespace koboshi::canopen {
namespace {

class TransmitQueueTest : public testing::Test {
 protected:
  bool send(std::uint16_t identifier) { return queue_.send({.identifier = identifier}); }
  std::vector<int> sent() const {
    std::vector<int> identifiers;
    for (const hal::CanFrame& frame : sink_.frames) identifiers.push_back(frame.identifier);
    return identifiers;
  }

  RecordingSink sink_;
  std::array<hal::CanFrame, 2> backlog_;
  TransmitQueue queue_{sink_, backlog_};
};

TEST_F(TransmitQueueTest, SendsAtOnceWhileThereIsSpace) {
  EXPECT_TRUE(send(1));
  EXPECT_EQ(sent(), std::vector<int>{1});
  EXPECT_EQ(queue_.backlog(), 0u);
}

TEST_F(TransmitQueueTest, KeepsTheOrderOfQueuedFrames) {
  sink_.room = 1;
  for (const std::uint16_t identifier : std::to_array<std::uint16_t>({1, 2, 3}))
    EXPECT_TRUE(send(identifier));
  EXPECT_EQ(queue_.backlog(), 2u);
  sink_.room = 1;
  EXPECT_TRUE(send(4));  // frame 2 is sent and makes room
  sink_.room = 10;
  queue_.flush();
  EXPECT_EQ(sent(), (std::vector<int>{1, 2, 3, 4}));
  EXPECT_EQ(queue_.lost(), 0u);
}

// A FIFO that becomes free at the worst moment: between the attempt to send waiting frames and that to send a
// new one.
class FickleSink final : public FrameSink {
 public:
  bool send(const hal::CanFrame& frame) override {
    if (refusals_ > 0) {
      --refusals_;
      return false;
    }
    identifiers.push_back(frame.identifier);
    return true;
  }
  std::vector<int> identifiers;

 private:
  int refusals_ = 2;
};

TEST(TransmitQueue, KeepsTheOrderOfPendingFrames) {
  FickleSink sink;
  std::array<hal::CanFrame, 8> backlog;
  TransmitQueue queue(sink, backlog);
  for (const std::uint16_t identifier : std::to_array<std::uint16_t>({1, 2, 3})) {
    ASSERT_TRUE(queue.send({.identifier = identifier}));
  }
  EXPECT_EQ(sink.identifiers, (std::vector<int>{1, 2, 3}));
}

// A port with room for process data only.
class BusyServices final : public FrameSink {
 public:
  bool send(const hal::CanFrame& frame) override {
    if (hal::transmit_fifo(frame) != hal::kProcessFifo && !idle) return false;
    identifiers.push_back(frame.identifier);
    return true;
  }
  std::vector<int> identifiers;
  bool idle = false;
};

TEST(TransmitQueue, SendsProcessDataBeforeServices) {
  BusyServices sink;
  std::array<hal::CanFrame, 1> backlog;
  TransmitQueue queue(sink, backlog);
  for (const std::uint16_t identifier : std::to_array<std::uint16_t>({0x701, 0x210, 0x581, 0x080}))
    ASSERT_TRUE(queue.send({.identifier = identifier}));
  EXPECT_EQ(sink.identifiers, (std::vector<int>{0x210, 0x080}));
  EXPECT_EQ(queue.backlog(), 2u);
  EXPECT_FALSE(queue.offer({.identifier = 0x582}));
  sink.idle = true;
  queue.flush();
  EXPECT_EQ(sink.identifiers, (std::vector<int>{0x210, 0x080, 0x581, 0x701}));
  EXPECT_EQ(queue.lost(), 0u);
}

// CiA 301, 7.3.2.2: the boot-up message is the first frame after a reset. A heartbeat may wait.
TEST_F(TransmitQueueTest, SendsABootUpBeforeProcessData) {
  sink_.room = 0;
  EXPECT_TRUE(queue_.send({.identifier = 0x701, .size = 1, .data = {0x05}}));
  EXPECT_TRUE(queue_.send({.identifier = 0x701, .size = 1, .data = {0x00}}));
  EXPECT_TRUE(send(0x081));
  sink_.room = 10;
  queue_.flush();
  EXPECT_EQ(sent(), (std::vector<int>{0x701, 0x081, 0x701}));
  EXPECT_EQ(sink_.frames.front().data[0], 0x00);
}

TEST_F(TransmitQueueTest, CountsDroppedFrames) {
  sink_.room = 0;
  EXPECT_TRUE(send(1));
  EXPECT_TRUE(send(2));
  EXPECT_FALSE(send(3));
  EXPECT_EQ(queue_.lost(), 1u);
  for (int i = 0; i < 70'000; ++i) static_cast<void>(send(4));
  EXPECT_EQ(queue_.lost(), 0xFFFF);
}

}  // namespace
}  // namespace koboshi::canopen
