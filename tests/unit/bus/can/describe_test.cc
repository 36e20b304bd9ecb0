#include "bus/can/describe.h"

#include <gtest/gtest.h>

#include <random>

#include "bus/can/frame_text.h"
#include "bus/can/sdo_blocks.h"

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

// The segments look like a read of 1018:01 and its answer.
TEST(Describe, KnowsTheSegmentsOfBlockTransfers) {
  SdoBlocks blocks;
  const auto next = [&](const char* text) {
    const hal::CanFrame frame = parse_frame(text);
    const bool is_segment = blocks.follow(frame);
    return describe(frame, {}, is_segment);
  };
  EXPECT_EQ(next("610#C600210128000000"), "SDO node 16: block transfer");
  EXPECT_EQ(next("590#A40021017F000000"), "SDO node 16: block transfer");
  EXPECT_EQ(next("610#4018100100000000"), "SDO node 16: block segment 64");
  EXPECT_EQ(next("690#4018100100000000"), "second SDO node 16: read 1018:01");
  EXPECT_EQ(next("611#4018100100000000"), "SDO node 17: read 1018:01");
  EXPECT_EQ(next("610#R"), "remote request of node 16");
  EXPECT_EQ(next("610#C118100100000000"), "SDO node 16: block segment 65, the last");
  EXPECT_EQ(next("590#A2417F0000000000"), "SDO node 16: block transfer");
  EXPECT_EQ(next("610#C100000000000000"), "SDO node 16: block transfer");
  EXPECT_EQ(next("610#4018100100000000"), "SDO node 16: read 1018:01");
  for (const char* upload : {"690#A40021017F000000", "6A4#C600210128000000", "690#A300000000000000"})
    next(upload);
  EXPECT_EQ(next("6A4#4318100192010200"), "second SDO node 16: block segment 67");
  next("710#00");
  EXPECT_EQ(next("6A4#4318100192010200"), "second SDO node 16: read answered 1018:01 = 0x00020192");
}

TEST(Describe, DescribesLayerSettingServices) {
  EXPECT_EQ(words("7E5#0401000000000000"), "LSS master: all slaves to configuration");
  EXPECT_EQ(words("7E5#0400000000000000"), "LSS master: all slaves to waiting");
  EXPECT_EQ(words("7E5#4049424F4B000000"), "LSS master: select vendor id 4B4F4249");
  EXPECT_EQ(words("7E5#4301000000000000"), "LSS master: select serial number 00000001");
  EXPECT_EQ(words("7E4#4400000000000000"), "LSS slave: selected, in configuration");
  EXPECT_EQ(words("7E5#1128000000000000"), "LSS master: configure node id 40");
  EXPECT_EQ(words("7E5#11FF000000000000"), "LSS master: configure no node id");
  EXPECT_EQ(words("7E4#1100000000000000"), "LSS slave: configure node id done");
  EXPECT_EQ(words("7E4#1301000000000000"), "LSS slave: configure bit timing refused, error 1, 0");
  EXPECT_EQ(words("7E5#1300020000000000"), "LSS master: configure bit timing 2 of table 0");
  EXPECT_EQ(words("7E5#15E8030000000000"), "LSS master: activate bit timing after 1000 ms");
  EXPECT_EQ(words("7E5#1700000000000000"), "LSS master: store");
  EXPECT_EQ(words("7E5#5100000000800000"), "LSS master: fastscan, any slave without a node id");
  EXPECT_EQ(words("7E5#51000000400C0101"), "LSS master: fastscan, product code 40000000 from bit 12 on");
  EXPECT_EQ(words("7E4#4F00000000000000"), "LSS slave: identified");
  EXPECT_EQ(words("7E5#4B01000000000000"), "LSS master: identify highest serial number 00000001");
  EXPECT_EQ(words("7E5#5D00000000000000"), "LSS master: inquire serial number");
  EXPECT_EQ(words("7E4#5D01000000000000"), "LSS slave: serial number 00000001");
  EXPECT_EQ(words("7E4#5E10000000000000"), "LSS slave: node id 16");
  EXPECT_EQ(words("7E4#5EFF000000000000"), "LSS slave: no node id");
  EXPECT_EQ(words("7E5#9900000000000000"), "LSS master: unknown command 99");
  EXPECT_EQ(words("7E4#4F"), "LSS of wrong length");
  EXPECT_EQ(kind_of(parse_frame("7E5#00")), FrameKind::kLss);
  EXPECT_EQ(node_of(parse_frame("7E5#00")), 0);
}

TEST(Describe, SurvivesAnyFrame) {
  std::mt19937 random(1);  // the seed
  for (int i = 0; i < 100'000; ++i) {
    hal::CanFrame frame{.identifier = static_cast<std::uint16_t>(random() & 0x7FF),
                        .size = static_cast<std::uint8_t>(random() % 9),
                        .remote = random() % 16 == 0};
    for (auto& byte : frame.data) byte = static_cast<std::uint8_t>(random());
    EXPECT_LT(describe(frame).size(), 200u);
    EXPECT_LT(describe(frame, {}, true).size(), 200u);
  }
}

}  // namespace
}  // namespace koboshi::bus
