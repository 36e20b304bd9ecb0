#include <gtest/gtest.h>

#include "tests/unit/firmware/canopen/test_node.h"

namespace koboshi::canopen {
namespace {

class NodeObjects : public testing::Test {
 protected:
  void SetUp() override { device_.make_operational(); }
  std::uint32_t read(std::uint16_t index, std::uint8_t subindex) {
    ObjectValue value;
    EXPECT_EQ(device_.node.read_object({index, subindex}, value), AbortCode::kNone);
    return value.number();
  }
  AbortCode write(std::uint16_t index, std::uint8_t subindex, std::uint32_t value, std::size_t size) {
    return device_.node.write_object({index, subindex}, value, size);
  }

  TestNode device_;
};

TEST_F(NodeObjects, HaveTheirLengthInSubindexZero) {
  struct Length {
    std::uint16_t index;
    std::uint32_t highest;
  };
  constexpr Length kLengths[] = {{0x1010, 4}, {0x1011, 4}, {0x1016, 3}, {0x1018, 4}, {0x1029, 1},
                                 {0x1200, 2}, {0x1201, 3}, {0x1400, 5}, {0x1800, 6}};
  for (const Length& length : kLengths) {
    SCOPED_TRACE(length.index);
    EXPECT_EQ(read(length.index, 0), length.highest);
    EXPECT_EQ(write(length.index, 0, 1, 1), AbortCode::kWriteOfReadOnly);
    ObjectValue value;
    const auto beyond = static_cast<std::uint8_t>(length.highest + 1);
    EXPECT_EQ(device_.node.read_object({length.index, beyond}, value), AbortCode::kSubindexDoesNotExist);
    EXPECT_EQ(write(length.index, beyond, 1, 1), AbortCode::kSubindexDoesNotExist);
  }
}

TEST_F(NodeObjects, AreReadOnlyIfTheyDescribeTheDevice) {
  for (const std::uint16_t index :
       std::initializer_list<std::uint16_t>{0x1000, 0x1001, 0x1008, 0x1009, 0x100A}) {
    EXPECT_EQ(write(index, 0, 1, 1), AbortCode::kWriteOfReadOnly) << index;
  }
  EXPECT_EQ(write(0x1003, 1, 0, 4), AbortCode::kWriteOfReadOnly);
  EXPECT_EQ(write(0x1018, 1, 0, 4), AbortCode::kWriteOfReadOnly);
  EXPECT_EQ(write(0x1200, 1, 0, 4), AbortCode::kWriteOfReadOnly);
}

TEST_F(NodeObjects, DoNotExistWithoutAName) {
  NodeDescription description = kTestDescription;
  description.hardware_version = {};
  TestNode nameless(0x10, description);
  nameless.make_operational();
  ObjectValue value;
  EXPECT_EQ(nameless.node.read_object({0x1009, 0}, value), AbortCode::kObjectDoesNotExist);
}

TEST_F(NodeObjects, StoreAndRestoreAskTheOwner) {
  EXPECT_EQ(read(0x1010, 4), 0u);
  NodeDescription description = kTestDescription;
  description.stored_groups = group_bit(ParameterGroup::kAll) | group_bit(ParameterGroup::kManufacturer);
  TestNode storing(0x10, description);
  storing.make_operational();
  ObjectValue value;
  ASSERT_EQ(storing.node.read_object({0x1010, 1}, value), AbortCode::kNone);
  EXPECT_EQ(value.number(), 1u);
  EXPECT_EQ(storing.node.write_object({0x1010, 1}, 0x65766173, 4), AbortCode::kNone);
  EXPECT_EQ(storing.node.write_object({0x1011, 4}, 0x64616F6C, 4), AbortCode::kNone);
  EXPECT_EQ(storing.node.write_object({0x1010, 2}, 0x65766173, 4), AbortCode::kCannotTransfer);
  ASSERT_EQ(storing.node.read_object({0x1010, 2}, value), AbortCode::kNone);
  EXPECT_EQ(value.number(), 0u);
  EXPECT_EQ(storing.stored, std::vector{ParameterGroup::kAll});
  EXPECT_EQ(storing.restored, std::vector{ParameterGroup::kManufacturer});
}

// The sub-index comes from the bus. Above 31 it must not be used as a bit index (found by the sanitizer).
TEST_F(NodeObjects, HaveOnlyTheirParameterGroups) {
  ObjectValue value;
  for (int subindex = 5; subindex < 256; ++subindex) {
    for (const std::uint16_t index : {std::uint16_t{0x1010}, std::uint16_t{0x1011}}) {
      const ObjectAddress address{index, static_cast<std::uint8_t>(subindex)};
      ASSERT_EQ(device_.node.read_object(address, value), AbortCode::kSubindexDoesNotExist);
      ASSERT_EQ(device_.node.write_object(address, 0x65766173, 4), AbortCode::kSubindexDoesNotExist);
    }
  }
}

TEST_F(NodeObjects, AnOwnerThatCannotStoreRefuses) {
  class : public NodeApplication {
  } application;
  RecordingSink sink;
  NodeMemory<4, 4, 3, 4> memory;
  TestValues values;
  Node node(kTestDescription, {.node_id = 1, .values = std::as_writable_bytes(std::span(&values, 1))},
            memory.buffers(), sink, application);
  node.start(0);
  EXPECT_EQ(node.write_object({0x1010, 1}, 0x65766173, 4), AbortCode::kCannotTransfer);
  EXPECT_EQ(node.write_object({0x1011, 1}, 0x64616F6C, 4), AbortCode::kCannotTransfer);
  ObjectValue value;
  EXPECT_EQ(node.read_object({0x2100, 1}, value), AbortCode::kUnsupportedAccess);
  EXPECT_EQ(node.write_object({0x2100, 1}, 0, 0), AbortCode::kUnsupportedAccess);
}

// --- The second SDO channel

const hal::CanFrame kReadModes = can_frame(0x6A0, {0x40, 0x02, 0x65, 0, 0, 0, 0, 0});

TEST_F(NodeObjects, SecondSdoIsDisabledUntilItIsGivenIdentifiers) {
  EXPECT_EQ(read(0x1201, 1), kCobIdInvalid);
  EXPECT_TRUE(device_.ask(kReadModes).empty());
  EXPECT_EQ(write(0x1201, 1, 0x610, 4), AbortCode::kInvalidValue);
  ASSERT_EQ(write(0x1201, 1, 0x6A0, 4), AbortCode::kNone);
  EXPECT_TRUE(device_.ask(kReadModes).empty());
  ASSERT_EQ(write(0x1201, 2, 0x6A1, 4), AbortCode::kNone);
  EXPECT_EQ(device_.ask(kReadModes), std::vector{can_frame(0x6A1, {0x43, 0x02, 0x65, 0, 0x80, 0, 0, 0})});
  EXPECT_EQ(write(0x1201, 1, 0x6A2, 4), AbortCode::kInvalidValue);
  ASSERT_EQ(write(0x1201, 1, 0x8000'06A0, 4), AbortCode::kNone);
  EXPECT_TRUE(device_.ask(kReadModes).empty());
}

TEST_F(NodeObjects, SecondSdoMayBeGivenByTheDescription) {
  NodeDescription description = kTestDescription;
  description.second_sdo = {0x6A0, 0x6A1};
  TestNode device(0x10, description);
  device.make_operational();
  EXPECT_EQ(device.ask(kReadModes).size(), 1u);
  ASSERT_EQ(device.node.write_object({0x1201, 1}, kCobIdInvalid, 4), AbortCode::kNone);
  device.node.command(NmtCommand::kResetCommunication, 0);
  EXPECT_EQ(device.ask(kReadModes).size(), 1u);
}

TEST_F(NodeObjects, SdoChannelsTransferSideBySide) {
  NodeDescription description = kTestDescription;
  description.second_sdo = {0x6A0, 0x6A1};
  TestNode device(0x10, description);
  device.make_operational();
  device.ask(can_frame(0x610, {0x40, 0x08, 0x10, 0, 0, 0, 0, 0}));
  device.ask(can_frame(0x6A0, {0x40, 0x09, 0x10, 0, 0, 0, 0, 0}));
  EXPECT_EQ(device.ask(can_frame(0x610, {0x60, 0, 0, 0, 0, 0, 0, 0})),
            std::vector{can_frame(0x590, {0x00, 'K', 'o', 'b', 'o', 's', 'h', 'i'})});
  EXPECT_EQ(device.ask(can_frame(0x6A0, {0x60, 0, 0, 0, 0, 0, 0, 0})),
            std::vector{can_frame(0x6A1, {0x0D, 'A', 0, 0, 0, 0, 0, 0})});
}

TEST_F(NodeObjects, ADomainServesOneChannelAtATime) {
  NodeDescription description = kTestDescription;
  description.second_sdo = {0x6A0, 0x6A1};
  TestNode device(0x10, description);
  device.make_operational();
  device.bytes.bytes = counted_bytes(20);
  device.ask(can_frame(0x610, {0x40, 0x00, 0x21, 1, 0, 0, 0, 0}));
  EXPECT_EQ(device.ask(can_frame(0x6A0, {0x21, 0x00, 0x21, 3, 9, 0, 0, 0})),
            std::vector{can_frame(0x6A1, {0x80, 0x00, 0x21, 3, 0x22, 0, 0, 8})});
  EXPECT_EQ(device.bytes.open, 1);
  device.ask(can_frame(0x610, {0x80, 0x00, 0x21, 1, 0, 0, 0, 8}));
  EXPECT_EQ(device.ask(can_frame(0x6A0, {0x21, 0x00, 0x21, 3, 9, 0, 0, 0}))[0].data[0], 0x60);
}

// --- DOMAINs in segments

TEST_F(NodeObjects, DomainsAreReadAndWrittenInSegments) {
  const auto ask = [&](std::initializer_list<unsigned> bytes) {
    return device_.ask(can_frame(0x610, bytes)).at(0);
  };
  EXPECT_EQ(ask({0x21, 0x00, 0x21, 1, 9, 0, 0, 0}).data[0], 0x60);
  EXPECT_EQ(ask({0x00, 1, 2, 3, 4, 5, 6, 7}).data[0], 0x20);
  EXPECT_TRUE(device_.bytes.bytes.empty());
  EXPECT_EQ(ask({0x1B, 8, 9, 0, 0, 0, 0, 0}).data[0], 0x30);
  EXPECT_EQ(device_.bytes.bytes, (std::vector<std::uint8_t>{1, 2, 3, 4, 5, 6, 7, 8, 9}));
  device_.bytes.announces = false;
  EXPECT_EQ(ask({0x40, 0x00, 0x21, 1, 0, 0, 0, 0}), can_frame(0x590, {0x40, 0x00, 0x21, 1, 0, 0, 0, 0}));
  EXPECT_EQ(ask({0x60, 0, 0, 0, 0, 0, 0, 0}), can_frame(0x590, {0x00, 1, 2, 3, 4, 5, 6, 7}));
  EXPECT_EQ(ask({0x70, 0, 0, 0, 0, 0, 0, 0}), can_frame(0x590, {0x1B, 8, 9, 0, 0, 0, 0, 0}));
  EXPECT_EQ(ask({0x2B, 0x00, 0x21, 1, 5, 6, 0, 0}).data[0], 0x60);  // expedited
  EXPECT_EQ(device_.bytes.bytes, (std::vector<std::uint8_t>{5, 6}));
  EXPECT_EQ(device_.bytes.open, 0);
}

}  // namespace
}  // namespace koboshi::canopen
