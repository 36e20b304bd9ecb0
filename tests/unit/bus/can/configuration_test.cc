#include "bus/can/configuration.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/bus/can/far_end.h"
#include "tests/unit/firmware/canopen/test_node.h"

namespace koboshi::bus {
namespace {

using canopen::ObjectAddress;

// A node at the other end of a cable.
class NodeOnCable final : public FarEnd {
 public:
  bool send(const hal::CanFrame& frame, std::uint64_t) override {
    for (const hal::CanFrame& answer : device.ask(frame)) answers_.push_back(answer);
    return true;
  }

  canopen::TestNode device{5, canopen::kTestDevice};
};

// Objects of a DCF: address, size and value.
class ConfigurationTest : public testing::Test {
 protected:
  ConfigurationTest() {
    cable.device.start(5, 0);
    cable.device.sink.take();
    file.is_dcf = true;
  }

  static std::vector<std::uint8_t> bytes(std::uint32_t value, std::size_t size) {
    std::vector<std::uint8_t> data(4);
    canopen::store_u32(data.data(), value);
    data.resize(size);
    return data;
  }
  void add(ObjectAddress address, std::size_t size, std::uint32_t value) {
    file.objects.push_back({.address = address,
                            .name = "object",
                            .writable = true,
                            .is_parameter = true,
                            .value = bytes(value, size)});
  }
  std::uint32_t number(ObjectAddress address) {
    std::vector<std::uint8_t> data = sdo.read(address);
    data.resize(4);
    return canopen::load_u32(data.data());
  }
  // Writes the file, and expects that the node then has each of its values.
  void write_all() {
    std::ranges::sort(file.objects, {}, &FileObject::address);
    const ConfigurationReport report = write_configuration(sdo, file);
    EXPECT_THAT(report.differences, testing::IsEmpty());
    EXPECT_EQ(report.compared, file.objects.size());
    file.objects.clear();
  }

  NodeOnCable cable;
  SdoTransfer sdo{cable, 5};
  DeviceFile file;
};

constexpr std::uint32_t kRpdo1 = canopen::kRpdo1Base + 5;
constexpr std::uint32_t kRpdo2 = kRpdo1 + canopen::kPdoStep;

TEST_F(ConfigurationTest, ExchangesTheIdentifiersOfTwoPdos) {
  add({0x1400, 1}, 4, kRpdo2);
  add({0x1600, 0}, 1, 1);
  add({0x1600, 1}, 4, 0x6040'0010);
  add({0x1401, 1}, 4, kRpdo1);
  add({0x1601, 0}, 1, 1);
  add({0x1601, 1}, 4, 0x6060'0008);
  write_all();
}

TEST_F(ConfigurationTest, ExchangesTwoHeartbeatConsumers) {
  add({0x1016, 1}, 4, 0x0001'0064);
  add({0x1016, 2}, 4, 0x0002'0064);
  write_all();
  add({0x1016, 1}, 4, 0x0002'0064);
  add({0x1016, 2}, 4, 0x0001'0064);
  write_all();
}

TEST_F(ConfigurationTest, ChangesIdentifiersInUse) {
  add({0x1014, 0}, 4, 0xB0);
  write_all();
  add({0x1005, 0}, 4, 0x4000'0080);
  add({0x1006, 0}, 4, 10'000);
  add({0x1012, 0}, 4, 0x8000'0100);
  write_all();
  add({0x1005, 0}, 4, 0x4000'0081);
  add({0x1012, 0}, 4, 0x8000'0099);
  write_all();
  EXPECT_EQ(number({0x1006, 0}), 10'000u);
}

TEST_F(ConfigurationTest, SetsTheSyncCounterWithThePeriod) {
  add({0x1006, 0}, 4, 10'000);
  add({0x1019, 0}, 1, 10);
  write_all();
  add({0x1006, 0}, 4, 20'000);
  add({0x1019, 0}, 1, 20);
  write_all();
  add({0x1019, 0}, 1, 30);
  write_all();
  EXPECT_EQ(number({0x1006, 0}), 20'000u) << "the file does not name it";
}

TEST_F(ConfigurationTest, WritesTheVerificationOfTheConfigurationLast) {
  add({0x1017, 0}, 2, 500);
  add({0x1020, 1}, 4, 15'000);
  add({0x1020, 2}, 4, 1'000);
  add({0x6060, 0}, 1, 8);
  write_all();
  add({0x1020, 1}, 4, 15'000);  // as it is, until the next write resets it
  add({0x1020, 2}, 4, 1'000);
  add({0x6060, 0}, 1, 7);
  write_all();
}

TEST_F(ConfigurationTest, WritesAMappingEntryWithoutItsCount) {
  add({0x1600, 2}, 4, 0x6060'0008);
  write_all();
  EXPECT_EQ(number({0x1600, 0}), 2u);
  EXPECT_EQ(number({0x1400, 1}), kRpdo1);
}

TEST_F(ConfigurationTest, RestoresWhatItReleasedInVain) {
  add({0x1014, 0}, 4, 0x101);  // restricted
  add({0x1019, 0}, 1, 1);      // no value of the counter
  const ConfigurationReport report = write_configuration(sdo, file);
  EXPECT_EQ(report.written, 0u);
  EXPECT_EQ(report.differences.size(), 4u);  // refused, and compared
  EXPECT_EQ(number({0x1014, 0}), 0x85u);
  EXPECT_EQ(number({0x1006, 0}), 0u);
}

// A PDO whose identifier is refused may have another mapping already.
TEST_F(ConfigurationTest, LeavesAPdoDisabledWhoseIdentifierIsRefused) {
  add({0x1400, 1}, 4, 0x101);
  add({0x1600, 0}, 1, 1);
  add({0x1600, 1}, 4, 0x6060'0008);
  const ConfigurationReport report = write_configuration(sdo, file);
  ASSERT_EQ(report.differences.size(), 2u);
  EXPECT_THAT(report.differences[0], testing::HasSubstr("1400:01 object: writing 0x00000101: SDO abort"));
  EXPECT_EQ(number({0x1400, 1}), kRpdo1 | canopen::kCobIdInvalid);
}

TEST_F(ConfigurationTest, WritesNothingThatTheNodeHas) {
  add({0x1014, 0}, 4, 0x85);
  add({0x1400, 1}, 4, kRpdo1);
  add({0x1600, 0}, 1, 2);
  const std::size_t before = cable.device.written.size();
  EXPECT_EQ(write_configuration(sdo, file).written, 0u);
  EXPECT_EQ(cable.device.written.size(), before);
}

}  // namespace
}  // namespace koboshi::bus
