#include <vector>

#include <gtest/gtest.h>

#include "tests/unit/firmware/canopen/test_node.h"

// A node as LSS slave: effects of its node id on the rest of the node.
namespace koboshi::canopen {
namespace {

hal::CanFrame lss(std::initializer_list<unsigned> bytes) {
  hal::CanFrame frame = can_frame(0x7E5, bytes);
  frame.size = 8;
  return frame;
}

std::vector<std::uint16_t> identifiers(const std::vector<hal::CanFrame>& frames) {
  std::vector<std::uint16_t> made;
  for (const hal::CanFrame& frame : frames) made.push_back(frame.identifier);
  return made;
}

TEST(NodeLss, IsAServiceOfDevices) {
  TestNode without;
  without.make_operational();
  EXPECT_TRUE(without.ask(lss({0x04, 1})).empty());
  EXPECT_TRUE(without.ask(lss({0x5E})).empty());
}

TEST(NodeLss, AnswersInEveryState) {
  TestNode owner(0x10, kTestDevice);
  owner.start(0x10, 0);
  for (const NmtCommand command : {NmtCommand::kStart, NmtCommand::kStop, NmtCommand::kEnterPreOperational}) {
    owner.node.command(command, 0);
    owner.ask(lss({0x04, 1}));
    const auto answers = owner.ask(lss({0x5E}));
    ASSERT_EQ(answers.size(), 1u);
    EXPECT_EQ(answers[0].data[1], 0x10);
    owner.ask(lss({0x04, 0}));
  }
}

// Whatever bytes the frame's buffer holds: a remote frame has no data.
TEST(NodeLss, IgnoresRemoteFrames) {
  TestNode owner(0x10, kTestDevice);
  owner.start(0x10, 0);
  hal::CanFrame remote = lss({0x04, 1});
  remote.remote = true;
  owner.ask(remote);
  EXPECT_TRUE(owner.ask(lss({0x5E})).empty());
  owner.ask(lss({0x04, 1}));
  EXPECT_EQ(owner.ask(lss({0x5E})).size(), 1u);
  remote = lss({0x5E});
  remote.remote = true;
  EXPECT_TRUE(owner.ask(remote).empty());
}

TEST(NodeLss, AppliesANewIdAtTheNextReset) {
  TestNode owner(0x10, kTestDevice);
  owner.start(0x10, 0);
  owner.node.command(NmtCommand::kStart, 0);
  owner.ask(lss({0x04, 1}));
  owner.ask(lss({0x11, 0x22}));
  EXPECT_TRUE(owner.ask(lss({0x04, 0})).empty());
  EXPECT_EQ(owner.node.node_id(), 0x10);
  const auto boot = owner.ask(can_frame(0x000, {0x82, 0x10}));
  EXPECT_EQ(boot, std::vector{can_frame(0x722, {0x00})});
  EXPECT_EQ(owner.node.node_id(), 0x22);
  EXPECT_EQ(owner.node_ids.back(), 0x22);
  ObjectValue value;
  for (const auto& [address, expected] : std::vector<std::pair<ObjectAddress, std::uint32_t>>{
           {{0x1014, 0}, 0xA2}, {{0x1200, 1}, 0x622}, {{0x1400, 1}, 0x222}, {{0x1800, 1}, 0x4000'01A2}}) {
    ASSERT_EQ(owner.node.read_object(address, value), AbortCode::kNone);
    EXPECT_EQ(value.number(), expected);
  }
  EXPECT_EQ(identifiers(owner.ask(can_frame(0x622, {0x40, 0x00, 0x10, 0, 0, 0, 0, 0}))),
            std::vector<std::uint16_t>{0x5A2});
}

TEST(NodeLss, StoresTheConfiguredId) {
  TestNode owner(0x10, kTestDevice);
  owner.start(0x10, 0);
  owner.node.command(NmtCommand::kStart, 0);
  owner.ask(lss({0x04, 1}));
  owner.ask(lss({0x11, 0x22}));
  owner.verdict = AbortCode::kBusy;
  EXPECT_TRUE(owner.ask(lss({0x17})).empty());
  owner.services.process(owner.node);
  owner.verdict = AbortCode::kNone;
  owner.services.process(owner.node);
  ASSERT_FALSE(owner.sink.frames.empty());
  EXPECT_EQ(owner.sink.frames.back().identifier, 0x7E4);
  EXPECT_EQ(owner.sink.frames.back().data[0], 0x17);
  EXPECT_EQ(owner.sink.frames.back().data[1], 0);
  EXPECT_EQ(owner.stored_node_ids, (std::vector<std::uint8_t>{0x22, 0x22, 0x22}));
  owner.services.process(owner.node);
  EXPECT_EQ(owner.stored_node_ids.size(), 3u);
}

TEST(NodeLss, IsSilentWithoutAnId) {
  TestNode owner(kUnconfiguredNodeId, kTestDevice);
  owner.start(kUnconfiguredNodeId, 0);
  EXPECT_EQ(owner.resets, std::vector{NmtCommand::kResetNode});
  owner.node.process(5'000'000);
  EXPECT_TRUE(owner.sink.frames.empty());
  EXPECT_EQ(owner.node.state(), NmtState::kInitialising);
  EXPECT_TRUE(owner.ask(can_frame(0x000, {0x01, 0x00})).empty());
  EXPECT_EQ(owner.node.state(), NmtState::kInitialising);
  EXPECT_TRUE(owner.ask(can_frame(0x67F, {0x40, 0x00, 0x10, 0, 0, 0, 0, 0})).empty());
  EXPECT_EQ(identifiers(owner.ask(lss({0x4C}))), std::vector<std::uint16_t>{0x7E4});
}

TEST(NodeLss, BootsWithTheIdItIsGiven) {
  TestNode owner(kUnconfiguredNodeId, kTestDevice);
  owner.start(kUnconfiguredNodeId, 0);
  owner.ask(lss({0x04, 1}));
  owner.ask(lss({0x11, 0x22}));
  EXPECT_EQ(owner.ask(lss({0x04, 0}), 7), std::vector{can_frame(0x722, {0x00})});
  EXPECT_EQ(owner.node.state(), NmtState::kPreOperational);
  EXPECT_EQ(owner.node.node_id(), 0x22);
}

TEST(NodeLss, WaitsAgainWithoutAnId) {
  TestNode owner(kUnconfiguredNodeId, kTestDevice);
  owner.start(kUnconfiguredNodeId, 0);
  owner.ask(lss({0x04, 1}));
  EXPECT_TRUE(owner.ask(lss({0x04, 0})).empty());
  EXPECT_EQ(owner.node.state(), NmtState::kInitialising);
}

TEST(NodeLss, LosesItsIdWithAResetOfTheCommunication) {
  TestNode owner(0x10, kTestDevice);
  owner.start(0x10, 0);
  owner.node.command(NmtCommand::kStart, 0);
  owner.ask(lss({0x04, 1}));
  owner.ask(lss({0x11, 0xFF}));
  EXPECT_TRUE(owner.ask(can_frame(0x000, {0x82, 0x10})).empty());
  EXPECT_EQ(owner.node.node_id(), kUnconfiguredNodeId);
  EXPECT_EQ(owner.node.state(), NmtState::kInitialising);
}

// An id that is active, or waits for its activation, and is not stored.
TEST(NodeLss, ReturnsToTheStoredIdWithAResetOfTheNode) {
  for (const bool active : {false, true}) {
    TestNode owner(0x10, kTestDevice);
    owner.start(0x10, 0);
    owner.node.command(NmtCommand::kStart, 0);
    owner.ask(lss({0x04, 1}));
    owner.ask(lss({0x11, 0x22}));
    owner.ask(lss({0x04, 0}));
    if (active) owner.ask(can_frame(0x000, {0x82, 0x00}));
    EXPECT_EQ(owner.node.node_id(), active ? 0x22 : 0x10);
    EXPECT_EQ(owner.ask(can_frame(0x000, {0x81, 0x00})), std::vector{can_frame(0x710, {0x00})});
    EXPECT_EQ(owner.node.node_id(), 0x10);
    EXPECT_EQ(owner.node_ids.back(), 0x10);
    EXPECT_EQ(owner.ask(can_frame(0x000, {0x82, 0x00})), std::vector{can_frame(0x710, {0x00})});
  }
}

TEST(NodeLss, KeepsAStoredIdOverAResetOfTheNode) {
  TestNode owner(0x10, kTestDevice);
  owner.start(0x10, 0);
  owner.ask(lss({0x04, 1}));
  owner.ask(lss({0x11, 0x22}));
  owner.verdict = AbortCode::kBusy;
  owner.ask(lss({0x17}));
  owner.ask(lss({0x11, 0x33}));  // is not the one to store
  owner.verdict = AbortCode::kNone;
  owner.services.process(owner.node);
  EXPECT_EQ(owner.stored_node_ids.back(), 0x22);
  EXPECT_EQ(owner.ask(can_frame(0x000, {0x81, 0x00})), std::vector{can_frame(0x722, {0x00})});
}

TEST(NodeLss, ReturnsToTheOldIdIfTheNewOneCannotBeStored) {
  TestNode owner(0x10, kTestDevice);
  owner.start(0x10, 0);
  owner.ask(lss({0x04, 1}));
  owner.ask(lss({0x11, 0x22}));
  owner.verdict = AbortCode::kHardwareError;
  owner.ask(lss({0x17}));
  EXPECT_EQ(owner.ask(can_frame(0x000, {0x81, 0x00})), std::vector{can_frame(0x710, {0x00})});
}

TEST(NodeLss, StartsWithTheIdThatWasStored) {
  TestNode owner(0x10, kTestDevice);
  owner.start(0x33, 0);
  EXPECT_EQ(owner.sink.frames, std::vector{can_frame(0x733, {0x00})});
}

}  // namespace
}  // namespace koboshi::canopen
