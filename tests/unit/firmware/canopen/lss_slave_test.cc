#include "firmware/canopen/lss_slave.h"

#include <array>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "tests/unit/firmware/canopen/test_node.h"

// The frames follow CiA 305, 6.2.
namespace koboshi::canopen {
namespace {

constexpr LssSlave::Address kAddress{0x4B4F'4249, 0x0000'0001, 0x0001'0000, 0x0F36'0D10};
constexpr std::uint8_t kConfigured = 0x10;

hal::CanFrame lss_request(std::initializer_list<unsigned> bytes) {
  hal::CanFrame frame = can_frame(0x7E5, bytes);
  frame.size = 8;
  return frame;
}

hal::CanFrame lss_response(std::initializer_list<unsigned> bytes) {
  hal::CanFrame frame = can_frame(0x7E4, bytes);
  frame.size = 8;
  return frame;
}

class LssSlaveTest : public testing::Test {
 protected:
  explicit LssSlaveTest(std::uint8_t node_id = kConfigured) : active(node_id) { slave.restart(node_id); }

  // Returns the response, if there is one.
  std::optional<hal::CanFrame> ask(std::initializer_list<unsigned> bytes) {
    event = slave.on_request(lss_request(bytes), active, sink);
    const auto frames = sink.take();
    if (frames.empty()) return std::nullopt;
    EXPECT_EQ(frames.size(), 1u);
    return frames.front();
  }
  void configure() { EXPECT_EQ(ask({0x04, 1}), std::nullopt); }

  RecordingSink sink;
  LssSlave slave{kAddress};
  std::uint8_t active;
  LssSlave::Event event = LssSlave::Event::kNone;
};

class UnconfiguredLssSlave : public LssSlaveTest {
 protected:
  UnconfiguredLssSlave() : LssSlaveTest(kUnconfiguredNodeId) {}

  std::optional<hal::CanFrame> scan(std::uint32_t number, unsigned bit, unsigned part, unsigned next) {
    return ask({0x51, number & 0xFF, number >> 8 & 0xFF, number >> 16 & 0xFF, number >> 24, bit, part, next});
  }
};

TEST_F(LssSlaveTest, AcceptsRequestsOfEightBytesOnly) {
  EXPECT_TRUE(LssSlave::takes(lss_request({0x04, 1})));
  EXPECT_FALSE(LssSlave::takes(can_frame(0x7E5, {0x04, 1})));
  EXPECT_FALSE(LssSlave::takes(lss_response({0x04, 1})));
}

TEST_F(LssSlaveTest, SwitchesGlobally) {
  EXPECT_EQ(slave.state(), LssSlave::State::kWaiting);
  configure();
  EXPECT_EQ(slave.state(), LssSlave::State::kConfiguration);
  EXPECT_EQ(event, LssSlave::Event::kNone);
  EXPECT_EQ(ask({0x04, 2}), std::nullopt);  // reserved
  EXPECT_EQ(slave.state(), LssSlave::State::kConfiguration);
  EXPECT_EQ(ask({0x04, 0}), std::nullopt);
  EXPECT_EQ(slave.state(), LssSlave::State::kWaiting);
  EXPECT_EQ(event, LssSlave::Event::kLeft);
}

TEST_F(LssSlaveTest, SwitchesByItsAddress) {
  EXPECT_EQ(ask({0x40, 0x49, 0x42, 0x4F, 0x4B}), std::nullopt);
  EXPECT_EQ(ask({0x41, 0x01}), std::nullopt);
  EXPECT_EQ(ask({0x42, 0x00, 0x00, 0x01, 0x00}), std::nullopt);
  EXPECT_EQ(ask({0x43, 0x10, 0x0D, 0x36, 0x0F}), lss_response({0x44}));
  EXPECT_EQ(slave.state(), LssSlave::State::kConfiguration);
}

TEST_F(LssSlaveTest, DoesNotSwitchWhenOnePartOfTheAddressDiffers) {
  ask({0x40, 0x49, 0x42, 0x4F, 0x4B});
  ask({0x41, 0x02});
  ask({0x42, 0x00, 0x00, 0x01, 0x00});
  EXPECT_EQ(ask({0x43, 0x10, 0x0D, 0x36, 0x0F}), std::nullopt);
  EXPECT_EQ(slave.state(), LssSlave::State::kWaiting);
  EXPECT_EQ(ask({0x43, 0x10, 0x0D, 0x36, 0x0F}), std::nullopt);  // only the last part
}

TEST_F(LssSlaveTest, ObeysConfigurationServicesInConfigurationOnly) {
  for (const unsigned command : {0x11u, 0x13u, 0x17u, 0x5Au, 0x5Bu, 0x5Cu, 0x5Du, 0x5Eu}) {
    EXPECT_EQ(ask({command, 5}), std::nullopt) << command;
    EXPECT_EQ(event, LssSlave::Event::kNone);
  }
  EXPECT_EQ(slave.node_id(), kConfigured);
}

TEST_F(LssSlaveTest, AcceptsANodeId) {
  configure();
  EXPECT_EQ(ask({0x11, 0x7F}), lss_response({0x11, 0}));
  EXPECT_EQ(slave.node_id(), 127);
  EXPECT_EQ(ask({0x11, 0x80}), lss_response({0x11, 1}));
  EXPECT_EQ(ask({0x11, 0x00}), lss_response({0x11, 1}));
  EXPECT_EQ(slave.node_id(), 127);
  EXPECT_EQ(ask({0x11, 0xFF}), lss_response({0x11, 0}));
  EXPECT_EQ(slave.node_id(), kUnconfiguredNodeId);
}

TEST_F(LssSlaveTest, SupportsOneBitTiming) {
  configure();
  EXPECT_EQ(ask({0x13, 0, 0}), lss_response({0x13, 0}));  // 1 Mbit/s
  EXPECT_EQ(ask({0x13, 0, 2}), lss_response({0x13, 1}));  // 500 kbit/s
  EXPECT_EQ(ask({0x13, 1, 0}), lss_response({0x13, 1}));  // a manufacturer-specific table
  EXPECT_EQ(ask({0x15, 10, 0}), std::nullopt);
}

TEST_F(LssSlaveTest, AnswersAStoreWhenItIsDone) {
  configure();
  EXPECT_EQ(ask({0x17}), std::nullopt);
  EXPECT_EQ(event, LssSlave::Event::kStore);
  LssSlave::stored(AbortCode::kNone, sink);
  LssSlave::stored(AbortCode::kCannotTransfer, sink);
  LssSlave::stored(AbortCode::kHardwareError, sink);
  EXPECT_EQ(sink.take(),
            (std::vector{lss_response({0x17, 0}), lss_response({0x17, 1}), lss_response({0x17, 2})}));
}

TEST_F(LssSlaveTest, ReportsItsAddressAndNodeId) {
  configure();
  EXPECT_EQ(ask({0x5A}), lss_response({0x5A, 0x49, 0x42, 0x4F, 0x4B}));
  EXPECT_EQ(ask({0x5B}), lss_response({0x5B, 0x01}));
  EXPECT_EQ(ask({0x5C}), lss_response({0x5C, 0x00, 0x00, 0x01, 0x00}));
  EXPECT_EQ(ask({0x5D}), lss_response({0x5D, 0x10, 0x0D, 0x36, 0x0F}));
  ask({0x11, 0x22});
  EXPECT_EQ(ask({0x5E}), lss_response({0x5E, kConfigured}));  // until the next reset
}

TEST_F(LssSlaveTest, IsIdentifiedWithinLimits) {
  const auto identify = [this](unsigned serial_low) {
    ask({0x46, 0x49, 0x42, 0x4F, 0x4B});
    ask({0x47, 0x01});
    ask({0x48, 0x00, 0x00, 0x01, 0x00});
    ask({0x49, 0xFF, 0xFF, 0x01, 0x00});
    ask({0x4A, serial_low, 0x0D, 0x36, 0x0F});
    return ask({0x4B, 0xFF, 0xFF, 0xFF, 0xFF});
  };
  EXPECT_EQ(identify(0x10), lss_response({0x4F}));
  EXPECT_EQ(identify(0x11), std::nullopt);
  configure();
  EXPECT_EQ(identify(0x00), lss_response({0x4F}));
}

TEST_F(LssSlaveTest, IsNotUnconfigured) {
  EXPECT_EQ(ask({0x4C}), std::nullopt);
  EXPECT_EQ(ask({0x51, 0, 0, 0, 0, 0x80, 0, 0}), std::nullopt);
}

TEST_F(UnconfiguredLssSlave, ReportsItsPresence) { EXPECT_EQ(ask({0x4C}), lss_response({0x50})); }

TEST_F(UnconfiguredLssSlave, IsConfiguredOnceItHasANodeId) {
  configure();
  ask({0x11, 0x22});
  ask({0x04, 0});
  EXPECT_EQ(event, LssSlave::Event::kLeft);
  EXPECT_EQ(ask({0x4C}), std::nullopt);
}

// A Fastscan master as in CiA 305, 6.2.5: scans each part bit by bit from the highest.
TEST_F(UnconfiguredLssSlave, IsFoundByFastscan) {
  ASSERT_EQ(scan(0, 0x80, 0, 0), lss_response({0x4F}));
  int requests = 1;
  for (unsigned part = 0; part < 4; ++part) {
    std::uint32_t found = 0;
    for (unsigned bit = 32; bit-- > 0; ++requests) {
      if (!scan(found, bit, part, part)) found |= 1u << bit;
    }
    EXPECT_EQ(found, kAddress[part]);
    ASSERT_EQ(scan(found, 0, part, (part + 1) % 4), lss_response({0x4F}));
    ++requests;
  }
  EXPECT_EQ(requests, 1 + 4 * 33);
  EXPECT_EQ(slave.state(), LssSlave::State::kConfiguration);
  EXPECT_EQ(ask({0x11, 0x22}), lss_response({0x11, 0}));
}

TEST_F(UnconfiguredLssSlave, IsSilentInAScanForAnother) {
  scan(0, 0x80, 0, 0);
  EXPECT_EQ(scan(0x4B4F'4248, 0, 0, 1), std::nullopt);  // the last bit of the vendor id
  EXPECT_EQ(scan(1, 0, 1, 2), std::nullopt);            // and all later scans
  EXPECT_EQ(scan(0x4B4F'4249, 0, 0, 1), lss_response({0x4F}));
  EXPECT_EQ(scan(1, 0, 1, 4), std::nullopt);   // there are only four parts
  EXPECT_EQ(scan(1, 32, 1, 1), std::nullopt);  // there are only 32 bits
  EXPECT_EQ(slave.state(), LssSlave::State::kWaiting);
}

// The rest of a sequence that began before a restart, or never began, is none.
TEST_F(UnconfiguredLssSlave, BeginsEachSequenceAnew) {
  const auto ask_rest_of_identify = [this](LssSlave& asked) {
    for (const auto& bytes :
         {std::array{0x47u, 0x01u, 0u, 0u, 0u}, std::array{0x48u, 0u, 0u, 1u, 0u},
          std::array{0x49u, 0u, 0u, 1u, 0u}, std::array{0x4Au, 0x10u, 0x0Du, 0x36u, 0x0Fu},
          std::array{0x4Bu, 0x10u, 0x0Du, 0x36u, 0x0Fu}})
      static_cast<void>(asked.on_request(lss_request({bytes[0], bytes[1], bytes[2], bytes[3], bytes[4]}),
                                         kUnconfiguredNodeId, sink));
    return sink.take().size();
  };
  const auto ask_rest_of_switch = [this](LssSlave& asked) {
    for (const auto& bytes : {std::array{0x41u, 0x01u, 0u, 0u, 0u}, std::array{0x42u, 0u, 0u, 1u, 0u},
                              std::array{0x43u, 0x10u, 0x0Du, 0x36u, 0x0Fu}})
      static_cast<void>(asked.on_request(lss_request({bytes[0], bytes[1], bytes[2], bytes[3], bytes[4]}),
                                         kUnconfiguredNodeId, sink));
    return sink.take().size();
  };
  ask({0x46, 0x49, 0x42, 0x4F, 0x4B});
  EXPECT_EQ(ask_rest_of_identify(slave), 1u);
  ask({0x46, 0x49, 0x42, 0x4F, 0x4B});
  slave.restart(kUnconfiguredNodeId);
  EXPECT_EQ(ask_rest_of_identify(slave), 0u);
  ask({0x40, 0x49, 0x42, 0x4F, 0x4B});
  slave.restart(kUnconfiguredNodeId);
  EXPECT_EQ(ask_rest_of_switch(slave), 0u);
  ask({0x40, 0x49, 0x42, 0x4F, 0x4B});
  EXPECT_EQ(ask_rest_of_switch(slave), 1u);
  slave.restart(kUnconfiguredNodeId);
  EXPECT_EQ(scan(0x4B4F'4249, 0, 0, 1), lss_response({0x4F})) << "the first part, without a confirmation";
  slave.restart(kUnconfiguredNodeId);
  EXPECT_EQ(scan(1, 0, 1, 2), std::nullopt) << "the second one";
  LssSlave fresh{kAddress};
  EXPECT_EQ(fresh.node_id(), kUnconfiguredNodeId);
  EXPECT_EQ(fresh.state(), LssSlave::State::kWaiting);
  EXPECT_EQ(ask_rest_of_identify(fresh), 0u);
  EXPECT_EQ(ask_rest_of_switch(fresh), 0u);
}

}  // namespace
}  // namespace koboshi::canopen
