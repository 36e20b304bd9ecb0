#include <gtest/gtest.h>

#include <utility>
#include <vector>

#include "tests/unit/firmware/canopen/storing_device.h"

namespace koboshi::canopen {
namespace {

TEST_F(StoredParametersTest, VerifiesASavedConfiguration) {
  ASSERT_EQ(device->write({0x2000, 1}, 1, 4), AbortCode::kNone);
  ASSERT_EQ(device->write({0x1020, 1}, 15'000, 4), AbortCode::kNone);
  ASSERT_EQ(device->write({0x1020, 2}, 43'200'000, 4), AbortCode::kNone);
  EXPECT_EQ(device->read(0x1020), 2u);
  ASSERT_EQ(device->save(), AbortCode::kNone);
  restart();
  EXPECT_EQ(device->read(0x1020, 1), 15'000u);
  EXPECT_EQ(device->read(0x1020, 2), 43'200'000u);
}

TEST_F(StoredParametersTest, DoesNotVerifyAChangedConfiguration) {
  const std::vector<std::pair<ObjectAddress, std::uint32_t>> changes{
      {{0x2000, 1}, 7}, {{0x6060, 0}, 1}, {{0x1017, 0}, 50}, {{0x1801, 2}, 3}, {{0x1A01, 0}, 1}};
  for (const auto& [address, value] : changes) {
    ASSERT_EQ(device->write({0x1801, 1}, 0xC000'0290, 4), AbortCode::kNone);
    ASSERT_EQ(device->write({0x1A01, 1}, 0x6064'0020, 4), AbortCode::kNone);
    ASSERT_EQ(device->write({0x1020, 1}, 15'000, 4), AbortCode::kNone);
    ASSERT_EQ(device->write({0x1020, 2}, 1, 4), AbortCode::kNone);
    ASSERT_EQ(device->write(address, device->read(address.index, address.subindex), 0), AbortCode::kNone);
    EXPECT_EQ(device->read(0x1020, 1), 15'000u) << "the same value is no change";
    ASSERT_EQ(device->write(address, value, 0), AbortCode::kNone) << std::hex << address.index;
    EXPECT_EQ(device->read(0x1020, 1), 0u) << std::hex << address.index;
    EXPECT_EQ(device->read(0x1020, 2), 0u) << std::hex << address.index;
  }
}

TEST_F(StoredParametersTest, StillVerifiesAfterProcessValuesAndRefusals) {
  ASSERT_EQ(device->write({0x1020, 1}, 15'000, 4), AbortCode::kNone);
  ASSERT_EQ(device->write({0x6040, 0}, 6, 2), AbortCode::kNone);
  EXPECT_EQ(device->write({0x6060, 0}, 99, 1), AbortCode::kValueTooHigh);
  EXPECT_EQ(device->write({0x1003, 0}, 0, 1), AbortCode::kNone);
  EXPECT_EQ(device->save(), AbortCode::kNone);
  EXPECT_EQ(device->read(0x1020, 1), 15'000u);
}

TEST_F(StoredParametersTest, DoesNotVerifyAfterARestore) {
  ASSERT_EQ(device->write({0x1020, 1}, 15'000, 4), AbortCode::kNone);
  ASSERT_EQ(device->save(), AbortCode::kNone);
  ASSERT_EQ(device->load(), AbortCode::kNone);
  device->node.command(NmtCommand::kResetNode, 1'000);
  EXPECT_EQ(device->read(0x1020, 1), 0u);
}

TEST(VerifyConfiguration, IsAServiceOfDevices) {
  TestNode without;
  without.node.start(0);
  ObjectValue value;
  EXPECT_EQ(without.node.read_object({0x1020, 1}, value), AbortCode::kObjectDoesNotExist);
}

}  // namespace
}  // namespace koboshi::canopen
