#include "bus/can/lss_master.h"

#include <gtest/gtest.h>

#include <list>

#include "tests/unit/bus/can/far_end.h"
#include "tests/unit/firmware/canopen/test_node.h"

namespace koboshi::bus {
namespace {

using canopen::LssSlave;

constexpr std::uint64_t kTimeout_us = 2'000;  // the slaves answer within the call that sends
constexpr LssAddress kFirst{0x4B4F'4249, 1, 0x0001'0000, 0x0F36'0D10};
constexpr LssAddress kSecond{0x4B4F'4249, 1, 0x0001'0000, 0x8000'0001};

// LSS slaves at the other end of a cable.
class Slaves final : public FarEnd {
 public:
  struct Slave {
    LssSlave lss;
    std::uint8_t active;
  };

  Slave& add(const LssAddress& address, std::uint8_t node_id) {
    slaves_.push_back({LssSlave(address), node_id});
    slaves_.back().lss.restart(node_id);
    return slaves_.back();
  }
  bool send(const hal::CanFrame& frame, std::uint64_t) override {
    for (Slave& slave : slaves_) {
      if (slave.lss.on_request(frame, slave.active, sink_) == LssSlave::Event::kStore)
        LssSlave::stored(store_result, sink_);
    }
    for (const hal::CanFrame& answer : sink_.take()) answers_.push_back(answer);
    return true;
  }

  canopen::AbortCode store_result = canopen::AbortCode::kNone;

 private:
  std::list<Slave> slaves_;
  canopen::RecordingSink sink_;
};

class LssMasterTest : public testing::Test {
 protected:
  std::string error_of(const std::function<void()>& action) {
    try {
      action();
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "";
  }

  Slaves slaves;
  LssMaster master{slaves, kTimeout_us};
};

TEST_F(LssMasterTest, SelectsASlaveAndSetsItsNodeId) {
  Slaves::Slave& first = slaves.add(kFirst, 16);
  slaves.add(kSecond, 17);
  EXPECT_FALSE(master.switch_selectively({1, 2, 3, 4}));
  ASSERT_TRUE(master.switch_selectively(kFirst));
  EXPECT_EQ(master.inquire_address(), kFirst);
  EXPECT_EQ(master.inquire_node_id(), 16);
  master.configure_node_id(40);
  master.store();
  EXPECT_EQ(first.lss.node_id(), 40);
  master.switch_globally(LssSlave::State::kWaiting);
  EXPECT_EQ(error_of([&] { master.inquire_address(); }), "no LSS slave in configuration answers");
}

TEST_F(LssMasterTest, ReportsRefusalsAndSeveralSlaves) {
  slaves.add(kFirst, 16);
  master.switch_globally(LssSlave::State::kConfiguration);
  EXPECT_EQ(error_of([&] { master.configure_bit_timing(0); }), "");
  EXPECT_EQ(error_of([&] { master.configure_bit_timing(2); }),
            "the LSS slave refuses the bit timing: it does not support this bit rate");
  slaves.store_result = canopen::AbortCode::kHardwareError;
  EXPECT_EQ(error_of([&] { master.store(); }), "the LSS slave refuses to store: its storage fails");
  slaves.add(kSecond, 17);
  master.switch_globally(LssSlave::State::kConfiguration);
  EXPECT_NE(error_of([&] { master.inquire_node_id(); }).find("several LSS slaves"), std::string::npos);
}

TEST_F(LssMasterTest, FindsSlavesWithoutNodeIdOneAfterTheOther) {
  EXPECT_EQ(master.fastscan(), std::nullopt);
  slaves.add(kFirst, canopen::kUnconfiguredNodeId);
  slaves.add(kSecond, canopen::kUnconfiguredNodeId);
  slaves.add({1, 2, 3, 4}, 16);
  EXPECT_EQ(master.fastscan(), kFirst);  // a zero wins over a one
  EXPECT_EQ(master.fastscan(), kSecond);
  EXPECT_EQ(master.fastscan(), std::nullopt);
}

TEST(LssAddress, IsWrittenInHexadecimal) {
  EXPECT_EQ(lss_address_text(kFirst), "4B4F4249:00000001:00010000:0F360D10");
  EXPECT_EQ(parse_lss_address("4B4F4249:1:0x10000:0F360D10"), kFirst);
  for (const char* const bad : {"", "1:2:3", "1:2:3:4:5", "1:2:3:G", "1:2:3:123456789"})
    EXPECT_THROW(parse_lss_address(bad), std::invalid_argument) << bad;
}

}  // namespace
}  // namespace koboshi::bus
