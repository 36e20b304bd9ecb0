#include <gtest/gtest.h>

#include <deque>

#include "firmware/canopen/sdo/client.h"
#include "tests/unit/firmware/canopen/test_node.h"

namespace koboshi::canopen {
namespace {

// An ideal bus without delay: each frame reaches all other nodes in the order of sending.
class TestBus {
 public:
  class Port final : public FrameSink {
   public:
    Port(TestBus& bus, std::size_t number) : bus_(bus), number_(number) {}
    bool send(const hal::CanFrame& frame) override {
      bus_.frames_.push_back({number_, frame});
      return true;
    }

   private:
    TestBus& bus_;
    std::size_t number_;
  };

  // Delivers frames until no node sends any more; fails if this does not happen.
  template <typename Deliver>
  void settle(const Deliver& deliver) {
    for (int i = 0; i < 1'000 && !frames_.empty(); ++i) {
      const auto [sender, frame] = frames_.front();
      frames_.pop_front();
      deliver(sender, frame);
    }
    EXPECT_TRUE(frames_.empty());
  }

 private:
  std::deque<std::pair<std::size_t, hal::CanFrame>> frames_;
};

class NetworkTest : public testing::Test {
 protected:
  void settle() {
    bus_.settle([this](std::size_t sender, const hal::CanFrame& frame) {
      if (sender != 0) {
        master_.node.on_frame(frame, now_us_);
        client_.on_frame(frame);
      }
      if (sender != 1) device_.node.on_frame(frame, now_us_);
    });
  }
  // Advances the time by one millisecond.
  void advance() {
    now_us_ += 1'000;
    master_.node.process(now_us_);
    device_.node.process(now_us_);
    client_.process(now_us_);
    settle();
  }
  SdoState write(ObjectAddress address, std::uint32_t value, std::size_t size) {
    client_.reset();
    EXPECT_TRUE(client_.begin_write(0x10, address, value, size, now_us_));
    settle();
    return client_.state();
  }
  void command(NmtCommand command) {
    EXPECT_TRUE(master_.node.sink().send(encode(NmtMessage{command, 0x10})));
    settle();
  }

  // The master's PDOs mirror the device's.
  static constexpr PdoConfiguration kMasterRpdo{
      .cob_id = 0x190, .mapping = {mapping(0x0006, 0, 16), mapping(0x2000, 1, 32), mapping(0x0006, 0, 16)}};
  static constexpr PdoConfiguration kMasterTpdo{.cob_id = 0x210,
                                                .mapping = {mapping(0x6041, 0, 16), mapping(0x6064, 0, 32)}};

  std::uint64_t now_us_ = 0;
  TestBus bus_;
  TestBus::Port master_port_{bus_, 0};
  TestBus::Port device_port_{bus_, 1};
  TestNode master_{0x01, kTestDescription, master_port_};
  TestNode device_{0x10, kTestDescription, device_port_};
  SdoClient client_{master_.node.sink(), 10'000};
};

TEST_F(NetworkTest, MasterBootsConfiguresAndRunsADevice) {
  master_.node.start(now_us_);
  ASSERT_EQ(master_.node.write_object({0x1016, 1}, (0x10u << 16) | 30, 4), AbortCode::kNone);
  ASSERT_EQ(master_.node.configure_rpdo(0, kMasterRpdo), AbortCode::kNone);
  ASSERT_EQ(master_.node.configure_tpdo(0, kMasterTpdo), AbortCode::kNone);
  device_.node.start(now_us_);
  settle();
  ASSERT_EQ(master_.heartbeats.size(), 1u);
  EXPECT_EQ(master_.heartbeats[0].kind, HeartbeatEventKind::kBootedUp);

  ASSERT_EQ(write({0x1017, 0}, 10, 2), SdoState::kDone);
  ASSERT_EQ(write({0x6060, 0}, 8, 1), SdoState::kDone);
  EXPECT_EQ(device_.values.mode, 8);
  EXPECT_EQ(write({0x6041, 0}, 8, 2), SdoState::kAborted);
  master_.node.command(NmtCommand::kStart, now_us_);
  command(NmtCommand::kStart);
  EXPECT_EQ(device_.node.state(), NmtState::kOperational);

  master_.next_statusword = 0x000F;
  master_.values.statusword = 0x000F;
  master_.values.position = 500;
  device_.values.position = 0x11223344;
  master_.node.trigger_tpdo(0, now_us_);
  ASSERT_EQ(master_.node.write_object({0x1005, 0}, 0x4000'0080, 4), AbortCode::kNone);
  master_.node.send_sync(now_us_);
  settle();
  EXPECT_EQ(device_.values.controlword, 0x000F);
  EXPECT_EQ(device_.values.target, 500);
  EXPECT_EQ(master_.values.gains[0], 0x11223344u);
}

TEST_F(NetworkTest, MasterNoticesADeviceThatFallsSilent) {
  master_.node.start(now_us_);
  ASSERT_EQ(master_.node.write_object({0x1016, 1}, (0x10u << 16) | 30, 4), AbortCode::kNone);
  device_.node.start(now_us_);
  ASSERT_EQ(device_.node.write_object({0x1017, 0}, 10, 2), AbortCode::kNone);
  for (int i = 0; i < 100; ++i) advance();
  ASSERT_EQ(master_.heartbeats.size(), 2u);
  EXPECT_EQ(master_.heartbeats[1].kind, HeartbeatEventKind::kFirstSeen);
  ASSERT_EQ(device_.node.write_object({0x1017, 0}, 0, 2), AbortCode::kNone);
  for (int i = 0; i < 30; ++i) advance();
  ASSERT_EQ(master_.heartbeats.size(), 3u);
  EXPECT_EQ(master_.heartbeats[2].kind, HeartbeatEventKind::kLost);
  EXPECT_FALSE(client_.begin_read(0x7F, {0x1000, 0}, now_us_) && client_.state() != SdoState::kBusy);
  for (int i = 0; i < 10; ++i) advance();
  EXPECT_EQ(client_.state(), SdoState::kTimedOut);
}

TEST_F(NetworkTest, DeviceReportsItsErrorsToTheMaster) {
  master_.node.start(now_us_);
  device_.node.start(now_us_);
  device_.node.raise_error(0x3220, error_register::kVoltage);
  device_.node.clear_error(0x3220);
  settle();
  ASSERT_EQ(master_.emergencies.size(), 2u);
  EXPECT_EQ(master_.emergencies[0], (Emergency{0x10, 0x3220, 0x05, {}}));
  EXPECT_EQ(master_.emergencies[1], (Emergency{0x10, 0x0000, 0x00, {}}));
}

}  // namespace
}  // namespace koboshi::canopen
