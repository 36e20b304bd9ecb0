#include <gtest/gtest.h>

#include "tests/unit/firmware/canopen/test_node.h"

namespace koboshi::canopen {
namespace {

TEST(NodeRpdo, SynchronousDataTakeEffectAtTheNextSync) {
  TestNode device;
  device.make_operational();
  device.node.on_frame(can_frame(0x210, {0x0F, 0x00, 0x18, 0xFC, 0xFF, 0xFF}), 0);
  EXPECT_EQ(device.values.controlword, 0);
  EXPECT_TRUE(device.rpdos.empty());
  device.node.on_frame(kSync, 100);
  EXPECT_EQ(device.values.controlword, 0x000F);
  EXPECT_EQ(device.values.target, -1000);
  EXPECT_EQ(device.rpdos, std::vector<std::size_t>{0});
  device.node.on_frame(kSync, 200);
  EXPECT_EQ(device.rpdos.size(), 1u);
}

TEST(NodeRpdo, TheLastOneBeforeASyncIsUsed) {
  TestNode device;
  device.make_operational();
  device.node.on_frame(can_frame(0x210, {0x01, 0, 0, 0, 0, 0}), 0);
  device.node.on_frame(can_frame(0x210, {0x02, 0, 0, 0, 0, 0}), 0);
  device.node.on_frame(kSync, 0);
  EXPECT_EQ(device.values.controlword, 2);
}

TEST(NodeRpdo, EventDrivenDataTakeEffectAtOnce) {
  TestNode device;
  device.make_operational();
  device.node.on_frame(can_frame(0x310, {0x07, 0x00}), 0);
  EXPECT_EQ(device.values.controlword, 7);
  EXPECT_EQ(device.rpdos, std::vector<std::size_t>{1});
}

TEST(NodeRpdo, LeavingOperationalDropsPendingData) {
  TestNode device;
  device.make_operational();
  device.node.on_frame(can_frame(0x210, {0x0F, 0, 0, 0, 0, 0}), 0);
  device.node.command(NmtCommand::kEnterPreOperational, 0);
  device.node.command(NmtCommand::kStart, 0);
  device.node.on_frame(kSync, 0);
  EXPECT_EQ(device.values.controlword, 0);
}

TEST(NodeRpdo, DestroyingOrReconfiguringDropsPendingData) {
  for (const bool reconfigure : {false, true}) {
    TestNode device;
    device.make_operational();
    device.node.on_frame(can_frame(0x210, {0x0F, 0, 0, 0, 0, 0}), 0);
    ASSERT_EQ(reconfigure ? device.node.configure_rpdo(0, kTestRpdos[0])
                          : device.node.write_object({0x1400, 1}, 0x80000210, 4),
              AbortCode::kNone);
    device.node.on_frame(kSync, 0);
    EXPECT_EQ(device.values.controlword, 0);
  }
}

TEST(NodeRpdo, TooShortIsRejectedAndReportedOnce) {
  TestNode device;
  device.make_operational();
  const hal::CanFrame short_frame = can_frame(0x210, {0x0F, 0x00, 0x01});
  EXPECT_EQ(device.ask(short_frame), std::vector{can_frame(0x090, {0x10, 0x82, 0x11, 1, 0, 0, 0, 0})});
  EXPECT_TRUE(device.ask(short_frame).empty());
  device.node.on_frame(kSync, 0);
  EXPECT_EQ(device.values.controlword, 0);
  EXPECT_EQ(device.ask(can_frame(0x210, {0x0F, 0, 0, 0, 0, 0})),
            std::vector{can_frame(0x090, {0, 0, 0, 0, 0, 0, 0, 0})});
}

// A PDO that is configured anew has received nothing wrong.
TEST(NodeRpdo, ItsErrorEndsWithANewConfiguration) {
  TestNode device;
  device.make_operational();
  device.ask(can_frame(0x210, {0x0F, 0x00, 0x01}));
  ASSERT_TRUE(device.node.errors().active(error_code::kPdoTooShort));
  ASSERT_EQ(device.node.write_object({0x1400, 1}, 0x8000'0210, 4), AbortCode::kNone);
  EXPECT_FALSE(device.node.errors().active(error_code::kPdoTooShort));
}

TEST(NodeRpdo, TooLongIsProcessedAndReported) {
  TestNode device;
  device.make_operational();
  EXPECT_EQ(device.ask(can_frame(0x310, {0x07, 0x00, 0xAA})),
            std::vector{can_frame(0x090, {0x20, 0x82, 0x11, 2, 0, 0, 0, 0})});
  EXPECT_EQ(device.values.controlword, 7);
  EXPECT_EQ(device.values.target, 0);
}

// The target is limited to [-1000, 1000].
TEST(NodeRpdo, IgnoresAValueThatItsObjectDoesNotTakeAndReportsItOnce) {
  TestNode device;
  device.make_operational();
  device.values.target = 7;
  device.ask(can_frame(0x210, {0x0F, 0x00, 0xE9, 0x03, 0, 0}));
  EXPECT_EQ(device.ask(kSync).front(), can_frame(0x090, {0x20, 0x63, 0x01, 0x7A, 0x60, 0, 1, 0}));
  EXPECT_EQ(device.values.controlword, 0x0F);  // the rest of the PDO
  EXPECT_EQ(device.values.target, 7);
  EXPECT_EQ(device.rpdos, std::vector<std::size_t>{0});
  device.ask(can_frame(0x210, {0x0F, 0x00, 0x17, 0xFC, 0xFF, 0xFF}));
  EXPECT_EQ(device.ask(kSync).size(), 1u);  // the TPDO alone
  EXPECT_EQ(device.values.target, 7);
  device.ask(can_frame(0x210, {0x0F, 0x00, 0x18, 0xFC, 0xFF, 0xFF}));
  EXPECT_EQ(device.ask(kSync).front(), can_frame(0x090, {0, 0, 0, 0, 0, 0, 0, 0}));
  EXPECT_EQ(device.values.target, -1000);
}

TEST(NodeRpdo, ReportsEachObjectThatRefusesItsValue) {
  TestNode device;
  device.make_operational();
  ASSERT_EQ(device.node.write_object({0x1402, 2}, 255, 1), AbortCode::kNone);
  ASSERT_EQ(device.node.configure_rpdo(2, {.cob_id = 0x410, .mapping = {mapping(0x607A, 0, 32)}}),
            AbortCode::kNone);
  device.node.raise_error(0x6320, 0);  // by the owner, for a reason of its own
  device.sink.take();
  EXPECT_EQ(device.ask(can_frame(0x410, {0xFF, 0xFF, 0xFF, 0x7F})),
            std::vector{can_frame(0x090, {0x20, 0x63, 0x01, 0x7A, 0x60, 0, 3, 0})});
  EXPECT_TRUE(device.ask(can_frame(0x410, {0, 0, 0, 0})).empty());
  EXPECT_TRUE(device.node.errors().active(0x6320));
  device.node.clear_error(0x6320);
  EXPECT_FALSE(device.node.errors().active(0x6320));
}

// Returns the entries of 0x1003, the newest first.
std::vector<std::uint32_t> history(const TestNode& device) {
  std::vector<std::uint32_t> entries;
  ObjectValue value;
  for (std::uint8_t i = 1; device.node.errors().read_history(i, value) == AbortCode::kNone; ++i)
    entries.push_back(value.number());
  return entries;
}

// Two of one PDO refuse at once, then one of them, then both: each has a message, and an entry of the error
// history, when its refusal begins.
TEST(NodeRpdo, ReportsEveryObjectOfOnePdoThatRefusesItsValue) {
  TestNode device;
  device.make_operational();
  ASSERT_EQ(device.node.write_object({0x1402, 2}, 255, 1), AbortCode::kNone);
  ASSERT_EQ(device.node.configure_rpdo(
                2, {.cob_id = 0x410, .mapping = {mapping(0x607A, 0, 32), mapping(0x6060, 0, 8)}}),
            AbortCode::kNone);
  device.sink.take();
  const hal::CanFrame target = can_frame(0x090, {0x20, 0x63, 0x01, 0x7A, 0x60, 0, 3, 0});
  const hal::CanFrame mode = can_frame(0x090, {0x20, 0x63, 0x01, 0x60, 0x60, 0, 3, 0});
  const hal::CanFrame both = can_frame(0x410, {0xFF, 0xFF, 0xFF, 0x7F, 99});
  EXPECT_EQ(device.ask(both), (std::vector{target, mode}));
  EXPECT_EQ(history(device), (std::vector{0x6060'6320u, 0x607A'6320u}));
  EXPECT_TRUE(device.ask(both).empty());
  EXPECT_TRUE(device.ask(can_frame(0x410, {0, 0, 0, 0, 99})).empty());
  EXPECT_EQ(device.ask(both), std::vector{target});
  EXPECT_EQ(history(device), (std::vector{0x607A'6320u, 0x6060'6320u, 0x607A'6320u}));
  EXPECT_EQ(device.ask(can_frame(0x410, {0, 0, 0, 0, 1})),
            std::vector{can_frame(0x090, {0, 0, 0, 0, 0, 0, 0, 0})});
  EXPECT_EQ(device.ask(both), (std::vector{target, mode}));
}

TEST(NodeRpdo, RejectsAnIdentifierInUse) {
  TestNode device;
  device.make_operational();
  ASSERT_EQ(device.node.write_object({0x1401, 1}, 0x8000'0310, 4), AbortCode::kNone);
  EXPECT_EQ(device.node.write_object({0x1401, 1}, 0x8000'0210, 4), AbortCode::kNone);  // not valid
  EXPECT_EQ(device.node.write_object({0x1401, 1}, 0x0000'0210, 4), AbortCode::kParameterIncompatibility);
  EXPECT_EQ(device.node.write_object({0x1400, 1}, 0x0000'0210, 4), AbortCode::kNone);  // unchanged value
  ASSERT_EQ(device.node.write_object({0x1400, 1}, 0x8000'0210, 4), AbortCode::kNone);
  EXPECT_EQ(device.node.write_object({0x1401, 1}, 0x0000'0210, 4), AbortCode::kNone);
  device.node.on_frame(can_frame(0x210, {7, 0}), 0);
  EXPECT_EQ(device.rpdos, std::vector<std::size_t>{1});
}

TEST(NodeRpdo, IgnoresRemoteFrames) {
  TestNode device;
  device.make_operational();
  hal::CanFrame remote = can_frame(0x310, {0x07, 0x00});
  remote.remote = true;
  EXPECT_TRUE(device.ask(remote).empty());
  EXPECT_EQ(device.values.controlword, 0);
}

TEST(NodeTpdo, AnswersNoRemoteFrameForAnyIdentifier) {
  TestNode device;
  device.make_operational();
  hal::CanFrame remote = can_frame(0x190, {});
  remote.remote = true;
  for (const std::uint32_t cob_id : {0x4000'0190u, 0x0000'0190u}) {
    ASSERT_EQ(device.node.write_object({0x1800, 1}, cob_id, 4), AbortCode::kNone);
    EXPECT_TRUE(device.ask(remote).empty());
  }
}

TEST(NodeTpdo, AnswersTheSyncWithValuesThatTheOwnerUpdatesInIt) {
  TestNode device;
  device.make_operational();
  device.next_statusword = 0x0237;
  device.values.position = -2;
  device.values.torque = 0x0102;
  EXPECT_EQ(device.ask(kSync),
            std::vector{can_frame(0x190, {0x37, 0x02, 0xFE, 0xFF, 0xFF, 0xFF, 0x02, 0x01})});
}

TEST(NodeTpdo, AnswersEveryNthSync) {
  TestNode device;
  device.make_operational();
  ASSERT_EQ(device.node.write_object({0x1800, 2}, 3, 1), AbortCode::kNone);
  std::string answered;
  for (int i = 0; i < 9; ++i) answered += device.ask(kSync).empty() ? '.' : 'x';
  EXPECT_EQ(answered, "..x..x..x");
}

TEST(NodeTpdo, TypeZeroAnswersTheSyncAfterAnEvent) {
  TestNode device;
  device.make_operational();
  ASSERT_EQ(device.node.write_object({0x1800, 2}, 0, 1), AbortCode::kNone);
  EXPECT_TRUE(device.ask(kSync).empty());
  device.node.trigger_tpdo(0, 0);
  EXPECT_TRUE(device.sink.take().empty());
  EXPECT_EQ(device.ask(kSync).size(), 1u);
  EXPECT_TRUE(device.ask(kSync).empty());
}

TEST(NodeTpdo, EventsAreSentAtOnce) {
  TestNode device;
  device.make_operational();
  device.values.statusword = 0x1234;
  device.node.trigger_tpdo(1, 0);
  EXPECT_EQ(device.sink.take(), std::vector{can_frame(0x290, {0x34, 0x12})});
  device.node.trigger_tpdo(2, 0);  // not valid
  device.node.trigger_tpdo(99, 0);
  EXPECT_TRUE(device.sink.take().empty());
}

// --- Value changes as events

TEST(NodeTpdo, IsRetriedAfterAFullFifo) {
  TestNode device;
  device.make_operational();
  device.sink.room = 0;
  for (int i = 0; i < 4; ++i) device.node.trigger_tpdo(1, 0);
  EXPECT_EQ(device.node.backlog(), 4u);
  device.values.statusword = 5;
  device.node.trigger_tpdo(1, 0);
  EXPECT_EQ(device.node.lost_frames(), 1u);
  device.sink.room = 100;
  device.node.process(1'000);
  const auto sent = device.sink.take();
  ASSERT_EQ(sent.size(), 5u);
  EXPECT_EQ(sent.back(), can_frame(0x290, {0x05, 0x00}));
}

TEST(NodeTpdo, IsNotSentWhileInvalid) {
  TestNode device;
  device.make_operational();
  ASSERT_EQ(device.node.write_object({0x1800, 1}, 0xC0000190, 4), AbortCode::kNone);
  EXPECT_TRUE(device.ask(kSync).empty());
  ASSERT_EQ(device.node.write_object({0x1801, 5}, 10, 2), AbortCode::kNone);
  ASSERT_EQ(device.node.write_object({0x1801, 1}, 0xC0000290, 4), AbortCode::kNone);
  device.node.process(1'000'000);
  EXPECT_TRUE(device.sink.take().empty());
}

// The standard sequence (CiA 301, 7.5.2.36): destroy, disable, map, enable, create; sent over SDO.
TEST(NodeTpdo, IsRemappedByTheStandardSequence) {
  TestNode device;
  device.make_operational();
  const hal::CanFrame sequence[] = {
      can_frame(0x610, {0x23, 0x00, 0x18, 0x01, 0x90, 0x01, 0x00, 0xC0}),  // 0x1800:1 invalid
      can_frame(0x610, {0x2F, 0x00, 0x1A, 0x00, 0x00, 0x00, 0x00, 0x00}),  // 0x1A00:0 = 0
      can_frame(0x610, {0x23, 0x00, 0x1A, 0x01, 0x20, 0x00, 0x64, 0x60}),  // 0x6064 first
      can_frame(0x610, {0x23, 0x00, 0x1A, 0x02, 0x10, 0x00, 0x41, 0x60}),  // then 0x6041
      can_frame(0x610, {0x2F, 0x00, 0x1A, 0x00, 0x02, 0x00, 0x00, 0x00}),  // 0x1A00:0 = 2
      can_frame(0x610, {0x2F, 0x00, 0x18, 0x02, 0x01, 0x00, 0x00, 0x00}),  // every SYNC
      can_frame(0x610, {0x23, 0x00, 0x18, 0x01, 0x91, 0x01, 0x00, 0x40}),  // valid, another identifier
  };
  for (const hal::CanFrame& request : sequence) {
    const auto response = device.ask(request);
    ASSERT_EQ(response.size(), 1u);
    ASSERT_EQ(response[0].data[0], 0x60);
  }
  device.values.position = 0x01020304;
  device.next_statusword = 0x0506;
  EXPECT_EQ(device.ask(kSync), std::vector{can_frame(0x191, {0x04, 0x03, 0x02, 0x01, 0x06, 0x05})});
}

TEST(NodeRpdo, IsRemappedWithAGap) {
  TestNode device;
  device.make_operational();
  ASSERT_EQ(device.node.write_object({0x1401, 1}, 0x80000310, 4), AbortCode::kNone);
  ASSERT_EQ(device.node.write_object({0x1601, 0}, 0, 1), AbortCode::kNone);
  ASSERT_EQ(device.node.write_object({0x1601, 1}, mapping(0x0006, 0, 16), 4), AbortCode::kNone);
  ASSERT_EQ(device.node.write_object({0x1601, 2}, mapping(0x6040, 0, 16), 4), AbortCode::kNone);
  ASSERT_EQ(device.node.write_object({0x1601, 0}, 2, 1), AbortCode::kNone);
  ASSERT_EQ(device.node.write_object({0x1401, 1}, 0x333, 4), AbortCode::kNone);
  device.node.on_frame(can_frame(0x310, {1, 2, 3, 4}), 0);
  EXPECT_EQ(device.values.controlword, 0);
  device.node.on_frame(can_frame(0x333, {1, 2, 3, 4}), 0);
  EXPECT_EQ(device.values.controlword, 0x0403);
}

}  // namespace
}  // namespace koboshi::canopen
