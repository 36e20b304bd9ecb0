#include "bus/can/describe.h"

#include <gtest/gtest.h>

#include <random>

#include "bus/can/frame_text.h"

namespace koboshi::bus {
namespace {

std::string words(const char* text) { return describe(parse_frame(text)); }

TEST(Describe, DescribesNetworkServices) {
  EXPECT_EQ(words("000#0100"), "NMT all nodes: start");
  EXPECT_EQ(words("000#8110"), "NMT node 16: reset node");
  EXPECT_EQ(words("080#"), "SYNC");
  EXPECT_EQ(words("080#07"), "SYNC 7");
  EXPECT_EQ(words("701#05"), "heartbeat node 1: operational");
  EXPECT_EQ(words("710#00"), "heartbeat node 16: boot-up");
  EXPECT_EQ(words("090#1043090000000000"), "EMCY node 16: 4310 temperature, register 09");
  EXPECT_EQ(words("090#0000000000000000"), "EMCY node 16: 0000 no error, register 00");
  EXPECT_EQ(words("701#R"), "remote request of node 1");
  EXPECT_EQ(words("190#0102"), "");
}

TEST(Describe, DescribesSdoTransfers) {
  EXPECT_EQ(words("601#4018100100000000"), "SDO node 1: read 1018:01");
  EXPECT_EQ(words("581#4318100192010200"), "SDO node 1: read answered 1018:01 = 0x00020192");
  EXPECT_EQ(words("610#2F60600008000000"), "SDO node 16: write 6060:00 = 0x08");
  EXPECT_EQ(words("590#6060600000000000"), "SDO node 16: write done 6060:00");
  EXPECT_EQ(words("581#4108100011000000"), "SDO node 1: read answered 1008:00, 17 bytes");
  EXPECT_EQ(words("581#8000200002000106"),
            "SDO node 1: abort 2000:00: 06010002 attempt to write a read-only object");
}

TEST(Describe, NamesTheObjectsOfSdoTransfers) {
  const auto named = [](const char* text) {
    return describe(parse_frame(text), [](int node, canopen::ObjectAddress address) {
      return node == 16 && address.index == 0x6060 ? std::string("modes of operation") : std::string();
    });
  };
  EXPECT_EQ(named("610#2F60600008000000"), "SDO node 16: write 6060:00 modes of operation = 0x08");
  EXPECT_EQ(named("590#6060600000000000"), "SDO node 16: write done 6060:00 modes of operation");
  EXPECT_EQ(named("690#4060600000000000"), "second SDO node 16: read 6060:00 modes of operation");
  EXPECT_EQ(named("590#8060600002000106"),
            "SDO node 16: abort 6060:00 modes of operation: 06010002 attempt to write a read-only object");
  EXPECT_EQ(named("611#2F60600008000000"), "SDO node 17: write 6060:00 = 0x08") << "no name, no text";
}

TEST(Describe, DescribesTheDrivesSecondSdoChannels) {
  EXPECT_EQ(words("690#4041600000000000"), "second SDO node 16: read 6041:00");
  EXPECT_EQ(words("6A4#4B41600040020000"), "second SDO node 16: read answered 6041:00 = 0x0240");
  EXPECT_EQ(words("6A3#4041600000000000"), "second SDO node 35: read 6041:00");
  EXPECT_EQ(words("6B7#4B41600040020000"), "second SDO node 35: read answered 6041:00 = 0x0240");
  EXPECT_EQ(words("6B8#4041600000000000"), "second SDO node 39: read 6041:00");
  EXPECT_EQ(words("6CC#4B41600040020000"), "second SDO node 39: read answered 6041:00 = 0x0240");
  EXPECT_EQ(words("6CB#4041600000000000"), "second SDO node 58: read 6041:00");
  EXPECT_EQ(words("6DF#4B41600040020000"), "second SDO node 58: read answered 6041:00 = 0x0240");
  for (const char* other : {"68F#4041600000000000", "6E0#4041600000000000"}) {
    EXPECT_EQ(kind_of(parse_frame(other)), FrameKind::kOther);
    EXPECT_EQ(words(other), "");
  }
}

TEST(Describe, SurvivesAnyFrame) {
  std::mt19937 random(1);  // the seed
  for (int i = 0; i < 100'000; ++i) {
    hal::CanFrame frame{.identifier = static_cast<std::uint16_t>(random() & 0x7FF),
                        .size = static_cast<std::uint8_t>(random() % 9),
                        .remote = random() % 16 == 0};
    for (auto& byte : frame.data) byte = static_cast<std::uint8_t>(random());
    EXPECT_LT(describe(frame).size(), 200u);
  }
}

}  // namespace
}  // namespace koboshi::bus
