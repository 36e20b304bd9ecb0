#include "firmware/canopen/frame.h"

#include <gtest/gtest.h>

#include "tests/unit/firmware/canopen/test_node.h"

namespace koboshi::canopen {
namespace {

TEST(Frame, EncodesNmtCommandsAsCia301Specifies) {
  EXPECT_EQ(encode(NmtMessage{NmtCommand::kStart, 0}), can_frame(0x000, {0x01, 0x00}));
  EXPECT_EQ(encode(NmtMessage{NmtCommand::kStop, 0x23}), can_frame(0x000, {0x02, 0x23}));
  EXPECT_EQ(encode(NmtMessage{NmtCommand::kEnterPreOperational, 1}), can_frame(0x000, {0x80, 0x01}));
  EXPECT_EQ(encode(NmtMessage{NmtCommand::kResetNode, 0x7F}), can_frame(0x000, {0x81, 0x7F}));
  EXPECT_EQ(encode(NmtMessage{NmtCommand::kResetCommunication, 2}), can_frame(0x000, {0x82, 0x02}));
}

TEST(Frame, EncodesHeartbeatsAndBootUp) {
  EXPECT_EQ(encode(Heartbeat{0x10, NmtState::kInitialising}), can_frame(0x710, {0x00}));
  EXPECT_EQ(encode(Heartbeat{0x10, NmtState::kStopped}), can_frame(0x710, {0x04}));
  EXPECT_EQ(encode(Heartbeat{0x10, NmtState::kOperational}), can_frame(0x710, {0x05}));
  EXPECT_EQ(encode(Heartbeat{0x7F, NmtState::kPreOperational}), can_frame(0x77F, {0x7F}));
}

TEST(Frame, EncodesEmergencies) {
  EXPECT_EQ(encode(Emergency{0x22, 0x8130, 0x11, {1, 2, 3, 4, 5}}),
            can_frame(0x0A2, {0x30, 0x81, 0x11, 0x01, 0x02, 0x03, 0x04, 0x05}));
}

TEST(Frame, RoundTrips) {
  const NmtMessage command{NmtCommand::kResetNode, 35};
  const Heartbeat heartbeat{127, NmtState::kOperational};
  const Emergency emergency{1, 0xFF01, 0x81, {9, 8, 7, 6, 5}};
  EXPECT_EQ(decode_nmt(encode(command)), command);
  EXPECT_EQ(decode_heartbeat(encode(heartbeat)), heartbeat);
  EXPECT_EQ(decode_emergency(encode(emergency)), emergency);
}

TEST(Frame, RefusesMalformedNmtMessages) {
  EXPECT_FALSE(decode_nmt(can_frame(0x001, {0x01, 0x00})));
  EXPECT_FALSE(decode_nmt(can_frame(0x000, {0x01})));
  EXPECT_FALSE(decode_nmt(can_frame(0x000, {0x01, 0x00, 0x00})));
  EXPECT_FALSE(decode_nmt(can_frame(0x000, {0x03, 0x00})));
  EXPECT_FALSE(decode_nmt(can_frame(0x000, {0x01, 0x80})));
  hal::CanFrame remote = encode(NmtMessage{NmtCommand::kStart, 0});
  remote.remote = true;
  EXPECT_FALSE(decode_nmt(remote));
}

TEST(Frame, RefusesMalformedHeartbeatsAndEmergencies) {
  EXPECT_FALSE(decode_heartbeat(can_frame(0x700, {0x05})));
  EXPECT_FALSE(decode_heartbeat(can_frame(0x780, {0x05})));
  EXPECT_FALSE(decode_heartbeat(can_frame(0x710, {})));
  EXPECT_FALSE(decode_heartbeat(can_frame(0x710, {0x05, 0x00})));
  EXPECT_FALSE(decode_heartbeat(can_frame(0x710, {0x06})));
  EXPECT_FALSE(decode_emergency(can_frame(0x080, {0, 0, 0, 0, 0, 0, 0, 0})));
  EXPECT_FALSE(decode_emergency(can_frame(0x100, {0, 0, 0, 0, 0, 0, 0, 0})));
  EXPECT_FALSE(decode_emergency(can_frame(0x081, {0, 0, 0, 0, 0, 0, 0})));
}

TEST(CobId, RestrictsTheIdentifiersOfTable40) {
  for (unsigned identifier = 0; identifier <= 0x7FF; ++identifier) {
    const bool restricted = identifier <= 0x7F || (identifier >= 0x101 && identifier <= 0x180) ||
                            (identifier >= 0x581 && identifier <= 0x5FF) ||
                            (identifier >= 0x601 && identifier <= 0x67F) ||
                            (identifier >= 0x6E0 && identifier <= 0x6FF) ||
                            (identifier >= 0x701 && identifier <= 0x77F) || identifier >= 0x780;
    const bool unnamed = identifier == 0x700;  // the heartbeat base with node id 0, which no node uses
    EXPECT_EQ(is_restricted(static_cast<std::uint16_t>(identifier)), restricted || unnamed) << identifier;
  }
}

}  // namespace
}  // namespace koboshi::canopen
