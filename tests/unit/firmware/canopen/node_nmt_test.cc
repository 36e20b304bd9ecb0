#include <gtest/gtest.h>

#include <cstddef>
#include <initializer_list>
#include <set>
#include <span>
#include <vector>

#include "tests/unit/firmware/canopen/test_node.h"

namespace koboshi::canopen {
namespace {

using enum NmtState;

std::set<std::uint16_t> identifiers(const TestNode& device) {
  std::set<std::uint16_t> heard;
  const auto add = [&heard](std::uint16_t identifier) { heard.insert(identifier); };
  device.node.for_each_identifier(add);
  device.services.for_each_identifier(add);
  return heard;
}

// The identifiers that a node with this id receives after a reset: NMT, SYNC, TIME, two RPDOs, SDO, LSS.
const std::set<std::uint16_t> kHeardAfterReset{0x000, 0x080, 0x100, 0x210, 0x310, 0x610, 0x7E5};

TEST(NodeIdentifiers, AreThoseOfTheFramesThatItActsOn) {
  TestNode device(0x10, kTestDevice);
  device.start(0x10, 0);
  EXPECT_EQ(identifiers(device), kHeardAfterReset);
  struct Write {
    ObjectAddress address;
    std::uint32_t value;
    std::size_t size;
    std::vector<std::uint16_t> gone;
    std::vector<std::uint16_t> new_ones;
  };
  std::set<std::uint16_t> expected = kHeardAfterReset;
  for (const Write& write : std::vector<Write>{{{0x1005, 0}, 0x81, 4, {0x080}, {0x081}},
                                               {{0x1012, 0}, 0x100, 4, {0x100}, {}},
                                               {{0x1012, 0}, 0x8000'0250, 4, {}, {0x250}},
                                               {{0x1016, 1}, 0x0005'0064, 4, {}, {0x705}},
                                               {{0x1016, 1}, 0x0005'0000, 4, {0x705}, {}},
                                               {{0x1201, 2}, 0x6A0, 4, {}, {}},
                                               {{0x1201, 1}, 0x690, 4, {}, {0x690}},
                                               {{0x1400, 1}, 0x8000'0210, 4, {0x210}, {}},
                                               {{0x1400, 1}, 0x211, 4, {}, {0x211}},
                                               {{0x1401, 1}, 0x8000'0310, 4, {0x310}, {}}}) {
    const std::uint32_t before = device.node.configuration();
    ASSERT_EQ(device.node.write_object(write.address, write.value, write.size), AbortCode::kNone)
        << std::hex << write.address.index;
    for (const std::uint16_t identifier : write.gone) expected.erase(identifier);
    expected.insert(write.new_ones.begin(), write.new_ones.end());
    EXPECT_EQ(identifiers(device), expected) << std::hex << write.address.index;
    EXPECT_NE(device.node.configuration(), before);
  }
  const std::uint32_t before = device.node.configuration();
  device.hear(can_frame(0x000, {0x82, 0x10}), 0);
  EXPECT_EQ(identifiers(device), kHeardAfterReset);
  EXPECT_NE(device.node.configuration(), before);
}

// A frame that is not among them changes nothing, and nothing answers it.
TEST(NodeIdentifiers, LeaveOutOnlyFramesWithoutEffect) {
  TestNode device(0x10, kTestDevice);
  device.start(0x10, 0);
  device.node.command(NmtCommand::kStart, 0);
  ASSERT_EQ(device.node.write_object({0x1016, 1}, 0x0005'0064, 4), AbortCode::kNone);
  const std::set<std::uint16_t> heard = identifiers(device);
  const auto state = [&device] {
    const auto bytes = std::as_bytes(std::span(&device.node, 1));
    const auto services = std::as_bytes(std::span(&device.services, 1));
    std::vector<std::byte> all(bytes.begin(), bytes.end());
    all.insert(all.end(), services.begin(), services.end());
    return all;
  };
  for (std::uint16_t identifier = 0; identifier < 0x800; ++identifier) {
    if (heard.contains(identifier)) continue;
    for (const std::initializer_list<unsigned> bytes :
         {std::initializer_list<unsigned>{}, {5}, {0, 0x10, 1, 0, 0, 0, 0, 0}}) {
      const auto before = state();
      EXPECT_TRUE(device.ask(can_frame(identifier, bytes), 1'000).empty());
      EXPECT_EQ(state(), before) << std::hex << identifier;
    }
  }
}

TEST(NodeNmt, BootsUpIntoPreOperational) {
  TestNode device;
  device.node.start(0);
  EXPECT_EQ(device.sink.take(), std::vector{can_frame(0x710, {0x00})});
  EXPECT_EQ(device.node.state(), kPreOperational);
  EXPECT_EQ(device.resets, std::vector{NmtCommand::kResetNode});
  EXPECT_EQ(device.states, std::vector{kPreOperational});
}

TEST(NodeNmt, IsSilentAndDeafBeforeItsStart) {
  TestNode device;
  device.node.on_frame(can_frame(0x000, {0x01, 0x00}), 0);
  device.node.on_frame(can_frame(0x610, {0x40, 0x00, 0x10, 0x00, 0, 0, 0, 0}), 0);
  device.node.process(1'000'000);
  EXPECT_TRUE(device.sink.take().empty());
  EXPECT_EQ(device.node.state(), kInitialising);
}

struct Transition {
  NmtState from;
  unsigned command;
  NmtState to;
};

// CiA 301, figure 48 and table 38.
constexpr Transition kTransitions[] = {
    {kPreOperational, 1, kOperational},
    {kPreOperational, 2, kStopped},
    {kPreOperational, 128, kPreOperational},
    {kPreOperational, 129, kPreOperational},
    {kPreOperational, 130, kPreOperational},
    {kOperational, 1, kOperational},
    {kOperational, 2, kStopped},
    {kOperational, 128, kPreOperational},
    {kOperational, 129, kPreOperational},
    {kOperational, 130, kPreOperational},
    {kStopped, 1, kOperational},
    {kStopped, 2, kStopped},
    {kStopped, 128, kPreOperational},
    {kStopped, 129, kPreOperational},
    {kStopped, 130, kPreOperational},
};

void bring_to(TestNode& device, NmtState state) {
  device.node.start(0);
  if (state == kOperational) device.node.command(NmtCommand::kStart, 0);
  if (state == kStopped) device.node.command(NmtCommand::kStop, 0);
  device.sink.frames.clear();
  device.resets.clear();
  ASSERT_EQ(device.node.state(), state);
}

TEST(NodeNmt, ObeysEveryCommandInEveryState) {
  for (const Transition& transition : kTransitions) {
    for (const unsigned addressee : {0x00u, 0x10u}) {
      SCOPED_TRACE(testing::Message()
                   << "state " << int(transition.from) << " command " << transition.command);
      TestNode device;
      bring_to(device, transition.from);
      const auto sent = device.ask(can_frame(0x000, {transition.command, addressee}));
      EXPECT_EQ(device.node.state(), transition.to);
      const bool resets = transition.command >= 129;
      EXPECT_EQ(sent, resets ? std::vector{can_frame(0x710, {0x00})} : std::vector<hal::CanFrame>{});
      EXPECT_EQ(device.resets.size(), resets ? 1u : 0u);
      if (resets) {
        EXPECT_EQ(static_cast<unsigned>(device.resets.at(0)), transition.command);
      }
    }
  }
}

TEST(NodeNmt, IgnoresCommandsToOthersAndMalformedOnes) {
  TestNode device;
  bring_to(device, kPreOperational);
  device.node.on_frame(can_frame(0x000, {0x01, 0x11}), 0);
  device.node.on_frame(can_frame(0x000, {0x01}), 0);
  device.node.on_frame(can_frame(0x000, {0x07, 0x10}), 0);
  EXPECT_EQ(device.node.state(), kPreOperational);
}

TEST(NodeNmt, ServesSdoInPreOperationalAndOperationalOnly) {
  const hal::CanFrame request = can_frame(0x610, {0x40, 0x00, 0x10, 0x00, 0, 0, 0, 0});
  for (const NmtState state : {kPreOperational, kOperational, kStopped}) {
    TestNode device;
    bring_to(device, state);
    EXPECT_EQ(device.ask(request).size(), state == kStopped ? 0u : 1u) << int(state);
  }
}

TEST(NodeNmt, ExchangesPdosInOperationalOnly) {
  for (const NmtState state : {kPreOperational, kOperational, kStopped}) {
    SCOPED_TRACE(int(state));
    TestNode device;
    bring_to(device, state);
    device.node.on_frame(can_frame(0x310, {0x06, 0x00}), 0);
    device.node.trigger_tpdo(1, 0);
    const auto after_sync = device.ask(can_frame(0x080, {}));
    EXPECT_EQ(device.values.controlword, state == kOperational ? 6 : 0);
    EXPECT_EQ(after_sync.size(), state == kOperational ? 1u : 0u);
    EXPECT_EQ(device.syncs, state == kStopped ? 0 : 1);
  }
}

TEST(NodeNmt, KeepsItsHeartbeatInEveryState) {
  for (const NmtState state : {kPreOperational, kOperational, kStopped}) {
    TestNode device;
    device.node.start(0);
    ASSERT_EQ(device.node.write_object({0x1017, 0}, 10, 2), AbortCode::kNone);
    if (state == kOperational) device.node.command(NmtCommand::kStart, 0);
    if (state == kStopped) device.node.command(NmtCommand::kStop, 0);
    device.sink.frames.clear();
    device.node.process(10'000);
    EXPECT_EQ(device.sink.take(), std::vector{can_frame(0x710, {static_cast<unsigned>(state)})});
  }
}

TEST(NodeNmt, ResetCommunicationRestoresCommunicationAndKeepsTheErrors) {
  TestNode device;
  device.make_operational();
  device.node.raise_error(0x2310, error_register::kCurrent);
  ASSERT_EQ(device.node.write_object({0x1017, 0}, 10, 2), AbortCode::kNone);
  ASSERT_EQ(device.node.write_object({0x1400, 1}, 0x80000210, 4), AbortCode::kNone);
  device.node.on_frame(can_frame(0x000, {0x82, 0x10}), 0);
  ObjectValue value;
  ASSERT_EQ(device.node.read_object({0x1017, 0}, value), AbortCode::kNone);
  EXPECT_EQ(value.number(), 0u);
  ASSERT_EQ(device.node.read_object({0x1400, 1}, value), AbortCode::kNone);
  EXPECT_EQ(value.number(), 0x210u);
  EXPECT_TRUE(device.node.errors().active(0x2310));
  device.node.on_frame(can_frame(0x000, {0x81, 0x10}), 0);
  EXPECT_FALSE(device.node.errors().active(0x2310));
}

TEST(NodeNmt, StoppedEndsAnSdoTransfer) {
  TestNode device;
  bring_to(device, kPreOperational);
  EXPECT_EQ(device.ask(can_frame(0x610, {0x40, 0x08, 0x10, 0, 0, 0, 0, 0})).size(), 1u);
  device.node.command(NmtCommand::kStop, 0);
  device.node.process(2 * SdoServer::kTimeout_us);
  EXPECT_TRUE(device.sink.take().empty());
}

TEST(NodeNmt, ResetForgetsTheHeartbeatConsumers) {
  TestNode device;
  bring_to(device, kPreOperational);
  ASSERT_EQ(device.node.write_object({0x1016, 1}, (0x01u << 16) | 20, 4), AbortCode::kNone);
  device.node.command(NmtCommand::kResetCommunication, 0);
  EXPECT_EQ(device.node.heartbeats().find(0x01), nullptr);
  device.node.on_frame(can_frame(0x701, {0x05}), 0);
  EXPECT_TRUE(device.heartbeats.empty());
}

TEST(NodeNmt, ReportsAnInvalidDescription) {
  static constexpr PdoConfiguration kImpossible[] = {{.cob_id = 0x180, .mapping = {mapping(0x2001, 0, 8)}}};
  NodeDescription description = kTestDescription;
  description.tpdos = kImpossible;
  TestNode device(0x10, description);
  device.node.start(0);
  EXPECT_TRUE(device.node.errors().active(error_code::kDataSet));
  TestNode sound;
  sound.node.start(0);
  EXPECT_EQ(sound.node.errors().error_register(), 0);
}

TEST(NodeNmt, ReportsAnInvalidRpdoOfItsDescription) {
  static constexpr PdoConfiguration kImpossible[] = {{.cob_id = 0x200, .mapping = {mapping(0x6041, 0, 16)}},
                                                     {.cob_id = 0x201, .mapping = {mapping(0x6040, 0, 16)}}};
  NodeDescription description = kTestDescription;
  description.rpdos = kImpossible;
  TestNode device(0x10, description);
  device.node.start(0);
  EXPECT_TRUE(device.node.errors().active(error_code::kDataSet));
}

}  // namespace
}  // namespace koboshi::canopen
