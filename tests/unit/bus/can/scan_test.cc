#include "bus/can/scan.h"

#include <gtest/gtest.h>

#include <set>

#include "firmware/canopen/sdo/protocol.h"
#include "tests/unit/bus/can/far_end.h"

namespace koboshi::bus {
namespace {

// Nodes that answer each read with one number, on the first or the second SDO channel, from a number of
// requests on. On their first channel, drives answer a controller instead.
class Nodes final : public FarEnd {
 public:
  bool send(const hal::CanFrame& frame, std::uint64_t) override {
    ++sent;
    requests.insert(frame.identifier);
    if (sent <= deaf || frame.size != 8) return true;
    for (const auto& [request, response] : servers)
      if (frame.identifier == request && canopen::sdo::address_of(frame.data).index < 0x2000)
        arrive({.identifier = response,
                .size = 8,
                .data = canopen::sdo::message(0x43, canopen::sdo::address_of(frame.data), 0x20192)});
    return true;
  }

  std::map<std::uint16_t, std::uint16_t> servers;
  std::set<std::uint16_t> requests;
  int sent = 0;
  int deaf = 0;  // requests that find no one
};

constexpr ScanOptions kShort{.listen_us = 1'000, .request_period_us = 10};

TEST(Scan, AsksDrivesOnTheirSecondChannelAndThenOnTheFirst) {
  Nodes nodes;
  nodes.servers = {
      {0x690, 0x6A4}, {0x611, 0x591}, {0x624, 0x5A4}};  // 16 on the second; 17 and 36 on the first
  const ScanResult result = scan_bus(nodes, kShort);
  ASSERT_EQ(result.nodes.size(), 3u);
  for (const FoundNode& node : result.nodes) {
    EXPECT_TRUE(node.answers_sdo) << int{node.node};
    EXPECT_EQ(node.device_type, 0x20192u) << int{node.node};
    EXPECT_EQ(node.identity[0], 0x20192u) << int{node.node};
  }
  EXPECT_FALSE(nodes.requests.contains(0x610));  // the controller's channel of drive 16
  EXPECT_TRUE(nodes.requests.contains(0x611));
}

TEST(Scan, UsesOneChannelIfToldSo) {
  Nodes nodes;
  nodes.servers = {{0x690, 0x6A4}, {0x611, 0x591}};
  const ScanResult first = scan_bus(nodes, {1'000, 10, SdoChannel::kFirst});
  ASSERT_EQ(first.nodes.size(), 1u);
  EXPECT_EQ(first.nodes[0].node, 17);
  EXPECT_FALSE(nodes.requests.contains(0x690));
  nodes.requests.clear();
  const ScanResult second = scan_bus(nodes, {1'000, 10, SdoChannel::kSecond});
  ASSERT_EQ(second.nodes.size(), 1u);
  EXPECT_EQ(second.nodes[0].node, 16);
  EXPECT_FALSE(nodes.requests.contains(0x611));
}

// A busy machine: what was asked first is lost.
TEST(Scan, AsksAgainWhileNothingAnswers) {
  Nodes nodes;
  nodes.servers = {{0x690, 0x6A4}};
  nodes.deaf = 300;
  const ScanResult result = scan_bus(nodes, kShort);
  ASSERT_EQ(result.nodes.size(), 1u);
  EXPECT_EQ(result.nodes[0].node, 16);
}

TEST(FindNode, FindsTheNodeWithAnIdByAnswersAndHeartbeats) {
  Nodes nodes;
  nodes.servers = {{0x690, 0x6A4}, {0x611, 0x591}, {0x605, 0x585}};
  for (const std::uint8_t node : {std::uint8_t{16}, std::uint8_t{17}, std::uint8_t{5}}) {
    const auto found = find_node(nodes, node, 5'000);
    ASSERT_TRUE(found) << int{node};
    EXPECT_EQ(found->node, node);
    EXPECT_EQ(found->identity[0], 0x20192u);
  }
  EXPECT_FALSE(nodes.requests.contains(0x610));  // the controller's channel of drive 16
  nodes.requests.clear();
  nodes.arrive({.identifier = 0x710, .size = 1, .data = {5}});
  EXPECT_FALSE(find_node(nodes, 6, 5'000));
  EXPECT_EQ(nodes.requests, std::set<std::uint16_t>{0x606});
  nodes.arrive({.identifier = 0x706, .size = 1, .data = {4}});
  const auto stopped = find_node(nodes, 6, 5'000);
  ASSERT_TRUE(stopped);
  EXPECT_FALSE(stopped->answers_sdo);
}

TEST(Scan, SaysWhatPassedWhereNothingAnswers) {
  Nodes nodes;
  const ScanResult silent = scan_bus(nodes, kShort);
  EXPECT_TRUE(silent.nodes.empty());
  EXPECT_TRUE(sighting_text(silent).starts_with("no frame passed within ")) << sighting_text(silent);
  for (std::uint16_t i = 0; i < 10; ++i) nodes.arrive({.identifier = static_cast<std::uint16_t>(0x181 + i)});
  const std::string text = sighting_text(scan_bus(nodes, kShort));
  EXPECT_TRUE(text.starts_with("10 frames passed within ")) << text;
  EXPECT_TRUE(text.ends_with("the identifiers 181, 182, 183, 184, 185, 186, 187, 188 and 2 others")) << text;
}

}  // namespace
}  // namespace koboshi::bus
