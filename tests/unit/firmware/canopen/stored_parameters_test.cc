#include "firmware/canopen/node/stored_parameters.h"

#include <array>
#include <vector>

#include <gtest/gtest.h>

#include "tests/unit/firmware/canopen/storing_device.h"

namespace koboshi::canopen {
namespace {

TEST_F(StoredParametersTest, ReportsThatEachGroupIsSavedOnCommand) {
  for (const std::uint16_t index : std::to_array<std::uint16_t>({0x1010, 0x1011})) {
    EXPECT_EQ(device->read(index), 4u);
    for (std::uint8_t i = 1; i <= 4; ++i) EXPECT_EQ(device->read(index, i), 1u);
  }
}

TEST_F(StoredParametersTest, RequiresTheSignatures) {
  EXPECT_EQ(device->write({0x1010, 1}, kLoad, 4), AbortCode::kCannotTransfer);
  EXPECT_EQ(device->write({0x1011, 1}, kSave, 4), AbortCode::kCannotTransfer);
  EXPECT_EQ(device->write({0x1010, 0}, kSave, 1), AbortCode::kWriteOfReadOnly);
  EXPECT_EQ(device->write({0x1010, 5}, kSave, 4), AbortCode::kSubindexDoesNotExist);
}

TEST_F(StoredParametersTest, KeepsParametersAcrossAPowerCycle) {
  ASSERT_EQ(device->write({0x2000, 3}, 77, 4), AbortCode::kNone);
  ASSERT_EQ(device->write({0x6060, 0}, 0xFF, 1), AbortCode::kNone);
  ASSERT_EQ(device->write({0x1017, 0}, 250, 2), AbortCode::kNone);
  ASSERT_EQ(device->save(), AbortCode::kNone);
  restart();
  EXPECT_EQ(device->values.gains[2], 77u);
  EXPECT_EQ(device->values.mode, -1);
  EXPECT_EQ(device->read(0x1017), 250u);
}

TEST_F(StoredParametersTest, KeepsNoProcessValues) {
  ASSERT_EQ(device->write({0x6040, 0}, 6, 2), AbortCode::kNone);
  ASSERT_EQ(device->write({0x607A, 0}, 5, 4), AbortCode::kNone);
  ASSERT_EQ(device->save(), AbortCode::kNone);
  restart();
  EXPECT_EQ(device->values.controlword, 0);
  EXPECT_EQ(device->values.target, 0);
}

TEST_F(StoredParametersTest, DiscardsUnsavedValues) {
  ASSERT_EQ(device->write({0x2000, 3}, 77, 4), AbortCode::kNone);
  restart();
  EXPECT_EQ(device->values.gains[2], 0u);
}

TEST_F(StoredParametersTest, KeepsEveryKindOfCommunicationParameter) {
  const std::vector<std::pair<ObjectAddress, std::uint32_t>> wanted{
      {{0x1005, 0}, 0x90},        {{0x1019, 0}, 10},          {{0x1006, 0}, 20'000},
      {{0x1007, 0}, 500},         {{0x1012, 0}, 0x0000'0100}, {{0x1014, 0}, 0x8000'0090},
      {{0x1014, 0}, 0x0000'00A0}, {{0x1015, 0}, 30},          {{0x1016, 2}, 0x0001'0064},
      {{0x1017, 0}, 123},         {{0x1029, 1}, 2},           {{0x1201, 1}, 0x8000'0690},
      {{0x1201, 1}, 0x0000'06D0}, {{0x1201, 3}, 5},           {{0x1400, 1}, 0x8000'0210},
      {{0x1400, 2}, 1},           {{0x1400, 5}, 60},          {{0x1600, 1}, 0x6040'0010},
      {{0x1600, 2}, 0x607A'0020}, {{0x1600, 0}, 2},           {{0x1400, 1}, 0x0000'0210},
      {{0x1800, 1}, 0xC000'0190}, {{0x1800, 2}, 254},         {{0x1800, 3}, 100},
      {{0x1800, 5}, 40},          {{0x1800, 6}, 3},           {{0x1800, 1}, 0x4000'0191},
  };
  std::vector<std::uint32_t> expected;
  for (const auto& [address, value] : wanted) {
    ASSERT_EQ(device->write(address, value, 0), AbortCode::kNone) << std::hex << address.index;
  }
  for (const auto& [address, value] : wanted)
    expected.push_back(device->read(address.index, address.subindex));
  ASSERT_EQ(device->save(2), AbortCode::kNone);
  restart();
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    const ObjectAddress address = wanted[i].first;
    EXPECT_EQ(device->read(address.index, address.subindex), expected[i])
        << std::hex << address.index << " " << int{address.subindex};
  }
}

// Each direction of PDOs by itself, communication and mapping.
TEST_F(StoredParametersTest, KeepsThePdosOfEachDirection) {
  const auto objects = [](std::uint16_t communication, std::uint16_t mapping) {
    return std::vector<ObjectAddress>{{communication, 1}, {communication, 2}, {mapping, 0}, {mapping, 1}};
  };
  const auto values = [&](const std::vector<ObjectAddress>& addresses) {
    std::vector<std::uint32_t> read;
    for (const ObjectAddress& address : addresses)
      read.push_back(device->read(address.index, address.subindex));
    return read;
  };
  const auto receive = objects(0x1400, 0x1600);
  const auto transmit = objects(0x1800, 0x1A00);
  const auto default_receive = values(receive);
  const auto default_transmit = values(transmit);
  const auto change = [&](std::uint16_t communication, std::uint16_t mapping, std::uint8_t type,
                          std::uint32_t object, std::uint32_t cob_id) {
    for (const auto& [address, value] :
         std::vector<std::pair<ObjectAddress, std::uint32_t>>{{{communication, 1}, cob_id | 0x8000'0000},
                                                              {{communication, 2}, type},
                                                              {{mapping, 0}, 0},
                                                              {{mapping, 1}, object},
                                                              {{mapping, 2}, object},
                                                              {{mapping, 0}, 2},
                                                              {{communication, 1}, cob_id}})
      ASSERT_EQ(device->write(address, value, 0), AbortCode::kNone) << std::hex << address.index;
  };
  change(0x1400, 0x1600, 1, 0x6040'0010, 0x255);
  const auto changed_receive = values(receive);
  ASSERT_NE(changed_receive, default_receive);
  ASSERT_EQ(device->save(2), AbortCode::kNone);
  restart();
  EXPECT_EQ(values(receive), changed_receive);
  EXPECT_EQ(values(transmit), default_transmit);
  change(0x1800, 0x1A00, 254, 0x6064'0020, 0x4000'01D5);
  const auto changed_transmit = values(transmit);
  ASSERT_NE(changed_transmit, default_transmit);
  ASSERT_EQ(device->save(2), AbortCode::kNone);
  restart();
  EXPECT_EQ(values(receive), changed_receive);
  EXPECT_EQ(values(transmit), changed_transmit);
}

// An identifier in use changes only by way of a value that ends the use; two PDOs or two consumers exchange
// theirs only while both are off. Each of these sequences is possible, and so is its end state after a reset.
TEST_F(StoredParametersTest, KeepsParametersThatDependOnEachOther) {
  const std::vector<std::pair<ObjectAddress, std::uint32_t>> sequence{
      {{0x1012, 0}, 0x0000'0100}, {{0x1012, 0}, 0x8000'0190},  // TIME on another identifier
      {{0x1005, 0}, 0x0000'0081}, {{0x1005, 0}, 0x4000'0081},  // producer of SYNC
      {{0x1019, 0}, 10},          {{0x1006, 0}, 20'000},       // with a counter
      {{0x1016, 1}, 0x0001'0064}, {{0x1016, 2}, 0x0002'0064},
  };
  for (const auto& [address, value] : sequence) {
    ASSERT_EQ(device->write(address, value, 0), AbortCode::kNone) << std::hex << address.index;
  }
  ASSERT_EQ(device->save(2), AbortCode::kNone);
  restart();
  EXPECT_EQ(device->read(0x1012), 0x8000'0190u);
  EXPECT_EQ(device->read(0x1005), 0x4000'0081u);
  EXPECT_EQ(device->read(0x1019), 10u);
  EXPECT_EQ(device->read(0x1006), 20'000u);
  EXPECT_EQ(device->read(0x1016, 1), 0x0001'0064u);
  EXPECT_EQ(device->read(0x1016, 2), 0x0002'0064u);
}

TEST_F(StoredParametersTest, SavesEachGroupSeparately) {
  ASSERT_EQ(device->write({0x2000, 1}, 1, 4), AbortCode::kNone);
  ASSERT_EQ(device->write({0x6060, 0}, 2, 1), AbortCode::kNone);
  ASSERT_EQ(device->write({0x1017, 0}, 3, 2), AbortCode::kNone);
  ASSERT_EQ(device->save(3), AbortCode::kNone);
  restart();
  EXPECT_EQ(device->values.gains[0], 0u);
  EXPECT_EQ(device->values.mode, 2);
  EXPECT_EQ(device->read(0x1017), 0u);
  ASSERT_EQ(device->write({0x2000, 1}, 1, 4), AbortCode::kNone);
  ASSERT_EQ(device->write({0x6060, 0}, 5, 1), AbortCode::kNone);
  ASSERT_EQ(device->save(4), AbortCode::kNone);
  restart();
  EXPECT_EQ(device->values.gains[0], 1u);
  EXPECT_EQ(device->values.mode, 2);
}

TEST_F(StoredParametersTest, RestoresEachGroupWithTheNextReset) {
  ASSERT_EQ(device->write({0x2000, 1}, 1, 4), AbortCode::kNone);
  ASSERT_EQ(device->write({0x6060, 0}, 2, 1), AbortCode::kNone);
  ASSERT_EQ(device->write({0x1017, 0}, 3, 2), AbortCode::kNone);
  ASSERT_EQ(device->save(), AbortCode::kNone);
  ASSERT_EQ(device->load(2), AbortCode::kNone);
  EXPECT_EQ(device->read(0x1017), 3u);  // the old value until then
  device->node.command(NmtCommand::kResetCommunication, 1'000);
  EXPECT_EQ(device->read(0x1017), 0u);
  EXPECT_EQ(device->values.mode, 2);
  ASSERT_EQ(device->load(), AbortCode::kNone);
  EXPECT_EQ(device->values.mode, 2);
  device->node.command(NmtCommand::kResetNode, 2'000);
  EXPECT_EQ(device->values.mode, 0);
  EXPECT_EQ(device->values.gains[0], 0u);
}

TEST_F(StoredParametersTest, RestoresCommunicationParametersAtEitherReset) {
  ASSERT_EQ(device->write({0x2000, 1}, 1, 4), AbortCode::kNone);
  ASSERT_EQ(device->write({0x1017, 0}, 3, 2), AbortCode::kNone);
  ASSERT_EQ(device->save(), AbortCode::kNone);
  ASSERT_EQ(device->write({0x2000, 1}, 9, 4), AbortCode::kNone);
  ASSERT_EQ(device->write({0x1017, 0}, 9, 2), AbortCode::kNone);
  device->node.command(NmtCommand::kResetCommunication, 1'000);
  EXPECT_EQ(device->read(0x1017), 3u);
  EXPECT_EQ(device->values.gains[0], 9u);
  device->node.command(NmtCommand::kResetNode, 2'000);
  EXPECT_EQ(device->values.gains[0], 1u);
}

TEST_F(StoredParametersTest, DerivesIdentifiersFromItsNodeIdByDefault) {
  ASSERT_EQ(device->write({0x1017, 0}, 3, 2), AbortCode::kNone);
  ASSERT_EQ(device->save(), AbortCode::kNone);
  restart(0x20);
  EXPECT_EQ(device->read(0x1017), 3u);
  EXPECT_EQ(device->read(0x1014), 0xA0u);
  EXPECT_EQ(device->read(0x1201, 1), 0x6A0u);
  EXPECT_EQ(device->read(0x1800, 1), 0x4000'01A0u);
}

TEST_F(StoredParametersTest, WritesOnlyChangedItems) {
  ASSERT_EQ(device->write({0x2000, 1}, 1, 4), AbortCode::kNone);
  ASSERT_EQ(device->save(), AbortCode::kNone);
  EXPECT_EQ(device->parameters.store(ParameterGroup::kAll), AbortCode::kNone);  // completes at once
}

TEST_F(StoredParametersTest, WaitsForTheFlash) {
  flash.complete_by_finish();
  EXPECT_EQ(device->parameters.store(ParameterGroup::kAll), AbortCode::kBusy);
  for (int ms = 0; ms < 100; ++ms) device->pass_a_millisecond();
  EXPECT_EQ(device->parameters.store(ParameterGroup::kAll), AbortCode::kBusy);
}

// A reset interrupts a save at each possible time: all stored values are old or all are new, and the save
// stops.
TEST_F(StoredParametersTest, AbandonsASaveThatAResetInterrupts) {
  std::uint32_t stored = 0;  // the factory values
  for (int cut_ms = 0; cut_ms < 60; ++cut_ms) {
    for (std::uint8_t i = 1; i <= 3; ++i) {
      ASSERT_EQ(device->write({0x2000, i}, stored + 1, 4), AbortCode::kNone);
    }
    ASSERT_EQ(device->write({0x1800, 5}, 500, 2), AbortCode::kNone);  // a PDO that differs from its default
                                                                      // takes 16 records
    ASSERT_EQ(device->write({0x1020, 1}, stored + 1, 4), AbortCode::kNone);
    static_cast<void>(device->parameters.store(ParameterGroup::kAll));
    for (int ms = 0; ms < cut_ms; ++ms) device->pass_a_millisecond();
    device->node.command(NmtCommand::kResetNode, 0);
    for (int ms = 0; ms < 200; ++ms) device->pass_a_millisecond();
    restart();
    const std::uint32_t found = device->values.gains[0];
    EXPECT_TRUE(found == stored || found == stored + 1) << cut_ms;
    EXPECT_EQ(device->values.gains[2], found) << cut_ms;
    EXPECT_EQ(device->read(0x1020, 1), found) << cut_ms;
    stored = found;
  }
  EXPECT_GT(stored, 10u);
  EXPECT_EQ(device->save(), AbortCode::kNone);
}

// Power fails at each possible time: all stored values are old or all are new.
TEST_F(StoredParametersTest, KeepsTheOldValuesAtAPowerFailure) {
  const auto set = [this](std::uint32_t value) {
    for (std::uint8_t i = 1; i <= 3; ++i) {
      EXPECT_EQ(device->write({0x2000, i}, value, 4), AbortCode::kNone);
    }
    EXPECT_EQ(device->write({0x1017, 0}, value, 2), AbortCode::kNone);
  };
  std::uint32_t value = 1;
  set(value);
  ASSERT_EQ(device->save(), AbortCode::kNone);
  int cut_ms = 0;
  for (bool whole = false; !whole; ++cut_ms) {
    set(value + 1);
    AbortCode code = device->parameters.store(ParameterGroup::kAll);
    for (int ms = 0; ms < cut_ms && code == AbortCode::kBusy; ++ms) {
      device->pass_a_millisecond();
      code = device->parameters.store(ParameterGroup::kAll);
    }
    whole = code == AbortCode::kNone;
    restart();
    const std::uint32_t found = device->values.gains[0];
    EXPECT_TRUE(found == value || found == value + 1) << cut_ms;
    EXPECT_TRUE(!whole || found == value + 1);
    EXPECT_EQ(device->values.gains[1], found) << cut_ms;
    EXPECT_EQ(device->values.gains[2], found) << cut_ms;
    EXPECT_EQ(device->read(0x1017), found) << cut_ms;
    value = found;
  }
  EXPECT_GT(cut_ms, 10);
}

TEST_F(StoredParametersTest, ReportsFlashThatFails) {
  flash.fail_next();
  EXPECT_EQ(device->save(), AbortCode::kHardwareError);
}

// --- 0x1020, verify configuration

TEST_F(StoredParametersTest, ReportsAFailureToTheRequestThatFailed) {
  flash.fail_next();
  device->values.gains[0] = 7;
  ASSERT_EQ(device->node.write_object({0x1010, 4}, kSave, 4), AbortCode::kBusy);
  for (int ms = 0; ms < 100; ++ms) device->pass_a_millisecond();
  EXPECT_EQ(device->save(2), AbortCode::kNone);  // another client, another group
  EXPECT_EQ(device->node.write_object({0x1010, 4}, kSave, 4), AbortCode::kHardwareError);
  EXPECT_EQ(device->save(4), AbortCode::kNone);
}

}  // namespace
}  // namespace koboshi::canopen
