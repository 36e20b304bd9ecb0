#include "firmware/canopen/pdo.h"

#include <gtest/gtest.h>

#include "tests/unit/firmware/canopen/test_node.h"

namespace koboshi::canopen {
namespace {

class PdoRecordTest : public testing::Test {
 protected:
  AbortCode map(PdoRecord& record, std::uint8_t subindex, std::uint32_t value) {
    return record.write_mapping(subindex, value, dictionary_);
  }
  static std::uint32_t communication(const PdoRecord& record, std::uint8_t subindex) {
    ObjectValue value;
    EXPECT_EQ(record.read_communication(subindex, value), AbortCode::kNone);
    return value.number();
  }

  TestValues values_;
  Dictionary dictionary_{kTestRows, std::as_writable_bytes(std::span(&values_, 1))};
  PdoRecord receive_{PdoDirection::kReceive};
  PdoRecord transmit_{PdoDirection::kTransmit};
};

TEST_F(PdoRecordTest, StartsInvalidAndUnmapped) {
  EXPECT_FALSE(receive_.valid());
  EXPECT_EQ(communication(receive_, 0), 5u);
  EXPECT_EQ(communication(transmit_, 0), 6u);
  EXPECT_EQ(receive_.size_bytes(), 0);
}

TEST_F(PdoRecordTest, ConfiguresItselfFromItsDescription) {
  ASSERT_EQ(transmit_.configure(kTestTpdos[0], 0x10, dictionary_), AbortCode::kNone);
  EXPECT_TRUE(transmit_.valid());
  EXPECT_EQ(communication(transmit_, 1), 0x40000190u);  // no remote requests
  EXPECT_EQ(communication(transmit_, 2), 1u);
  EXPECT_EQ(transmit_.size_bytes(), 8);
  ObjectValue value;
  ASSERT_EQ(transmit_.read_mapping(2, value), AbortCode::kNone);
  EXPECT_EQ(value.number(), 0x60640020u);
  ASSERT_EQ(transmit_.read_mapping(4, value), AbortCode::kNone);
  EXPECT_EQ(value.number(), 0u);
}

TEST_F(PdoRecordTest, RefusesRestrictedAndExtendedIdentifiers) {
  for (const std::uint32_t cob_id :
       {0x000u, 0x07Fu, 0x101u, 0x180u, 0x581u, 0x601u, 0x6E0u, 0x701u, 0x7FFu, 0x20000200u, 0x00000800u}) {
    EXPECT_EQ(receive_.write_communication(1, cob_id), AbortCode::kInvalidValue) << cob_id;
    EXPECT_EQ(transmit_.write_communication(1, cob_id | kCobIdNoRemote), AbortCode::kInvalidValue) << cob_id;
  }
}

// Masters that never send remote frames, such as lely-core's, write this value. The bit is not among those
// that require an invalid PDO (CiA 301, 7.5.2.37).
TEST_F(PdoRecordTest, KeepsAnIdentifierThatAllowsRemoteFramesAsItIsWritten) {
  ASSERT_EQ(transmit_.configure(kTestTpdos[0], 0x10, dictionary_), AbortCode::kNone);
  for (const std::uint32_t cob_id : {0x190u, 0x40000190u, 0x80000190u, 0x191u}) {
    EXPECT_EQ(transmit_.write_communication(1, cob_id), AbortCode::kNone) << cob_id;
    EXPECT_EQ(communication(transmit_, 1), cob_id);
    EXPECT_EQ(transmit_.valid(), cob_id != 0x80000190u);
  }
}

TEST_F(PdoRecordTest, ChangesIdentifierAndInhibitTimeOnlyWhileInvalid) {
  ASSERT_EQ(transmit_.configure(kTestTpdos[0], 0x10, dictionary_), AbortCode::kNone);
  EXPECT_EQ(transmit_.write_communication(1, 0x40000191), AbortCode::kInvalidValue);
  EXPECT_EQ(transmit_.write_communication(3, 10), AbortCode::kInvalidValue);
  EXPECT_EQ(transmit_.write_communication(5, 10), AbortCode::kNone);
  ASSERT_EQ(transmit_.write_communication(1, 0xC0000190), AbortCode::kNone);
  EXPECT_EQ(transmit_.write_communication(3, 10), AbortCode::kNone);
  EXPECT_EQ(transmit_.write_communication(1, 0x40000191), AbortCode::kNone);
  EXPECT_EQ(transmit_.inhibit_time_us(), 1'000u);
}

TEST_F(PdoRecordTest, AcceptsExactlyTheSupportedTransmissionTypes) {
  for (unsigned type = 0; type <= 255; ++type) {
    const bool served = type <= 240 || type >= 254;
    EXPECT_EQ(receive_.write_communication(2, type), served ? AbortCode::kNone : AbortCode::kInvalidValue);
    EXPECT_EQ(transmit_.write_communication(2, type), served ? AbortCode::kNone : AbortCode::kInvalidValue);
  }
}

TEST_F(PdoRecordTest, MapsOnlyWhileInvalidAndDisabled) {
  ASSERT_EQ(receive_.configure(kTestRpdos[0], 0x10, dictionary_), AbortCode::kNone);
  const std::uint32_t entry = mapping(0x6040, 0, 16);
  EXPECT_EQ(map(receive_, 0, 0), AbortCode::kUnsupportedAccess);
  EXPECT_EQ(map(receive_, 1, entry), AbortCode::kUnsupportedAccess);
  ASSERT_EQ(receive_.write_communication(1, 0x80000210), AbortCode::kNone);
  EXPECT_EQ(map(receive_, 1, entry), AbortCode::kUnsupportedAccess);
  EXPECT_EQ(map(receive_, 0, 0), AbortCode::kNone);
  EXPECT_EQ(map(receive_, 1, entry), AbortCode::kNone);
  EXPECT_EQ(map(receive_, 0, 1), AbortCode::kNone);
  EXPECT_EQ(receive_.size_bytes(), 2);
}

TEST_F(PdoRecordTest, AnEntryOfZeroRemovesTheMapping) {
  ASSERT_EQ(map(receive_, 1, mapping(0x6040, 0, 16)), AbortCode::kNone);
  ASSERT_EQ(map(receive_, 1, 0), AbortCode::kNone);
  ObjectValue value;
  ASSERT_EQ(receive_.read_mapping(1, value), AbortCode::kNone);
  EXPECT_EQ(value.number(), 0u);
  EXPECT_EQ(map(receive_, 0, 1), AbortCode::kObjectDoesNotExist);
}

// It would be an empty frame.
TEST_F(PdoRecordTest, StaysInvalidWithoutAnObject) {
  for (PdoRecord* const record : {&receive_, &transmit_}) {
    EXPECT_EQ(record->write_communication(1, 0x210), AbortCode::kParameterIncompatibility);
    EXPECT_FALSE(record->valid());
    EXPECT_EQ(record->write_communication(1, 0x8000'0210), AbortCode::kNone);
  }
  EXPECT_EQ(transmit_.configure({.cob_id = 0x190}, 0x10, dictionary_), AbortCode::kParameterIncompatibility);
  EXPECT_FALSE(transmit_.valid());
  ASSERT_EQ(map(receive_, 1, mapping(0x0005, 0, 8)), AbortCode::kNone);  // a gap is one
  ASSERT_EQ(map(receive_, 0, 1), AbortCode::kNone);
  EXPECT_EQ(receive_.write_communication(1, 0x210), AbortCode::kNone);
}

TEST_F(PdoRecordTest, StaysInvalidWithAnInvalidDescription) {
  ASSERT_EQ(receive_.configure(kTestRpdos[0], 0x10, dictionary_), AbortCode::kNone);
  PdoConfiguration wrong_type = kTestRpdos[0];
  wrong_type.transmission_type = 252;
  EXPECT_EQ(receive_.configure(wrong_type, 0x10, dictionary_), AbortCode::kInvalidValue);
  EXPECT_FALSE(receive_.valid());
}

TEST_F(PdoRecordTest, RejectsObjectsThatCannotBeMapped) {
  EXPECT_EQ(map(receive_, 1, mapping(0x0007, 1, 32)), AbortCode::kNotMappable);
  EXPECT_EQ(map(receive_, 1, mapping(0x6050, 0, 16)), AbortCode::kObjectDoesNotExist);
  EXPECT_EQ(map(receive_, 1, mapping(0x6040, 1, 16)), AbortCode::kSubindexDoesNotExist);
  EXPECT_EQ(map(receive_, 1, mapping(0x6041, 0, 16)), AbortCode::kNotMappable);
  EXPECT_EQ(map(transmit_, 1, mapping(0x6040, 0, 16)), AbortCode::kNotMappable);
  EXPECT_EQ(map(receive_, 1, mapping(0x6040, 0, 8)), AbortCode::kNotMappable);
  EXPECT_EQ(map(receive_, 1, mapping(0x2000, 0, 8)), AbortCode::kNotMappable);  // highest sub-index
  EXPECT_EQ(map(receive_, 1, mapping(0x0007, 0, 16)), AbortCode::kNotMappable);
  EXPECT_EQ(map(transmit_, 1, mapping(0x0007, 0, 32)), AbortCode::kNotMappable);
  EXPECT_EQ(map(receive_, 1, mapping(0x0008, 0, 32)), AbortCode::kObjectDoesNotExist);
  EXPECT_EQ(map(receive_, 9, mapping(0x6040, 0, 16)), AbortCode::kSubindexDoesNotExist);
}

TEST_F(PdoRecordTest, RefusesMoreThanEightBytesOrUnmappedEntries) {
  for (std::uint8_t i = 1; i <= 3; ++i)
    ASSERT_EQ(map(transmit_, i, mapping(0x2000, i, 32)), AbortCode::kNone);
  EXPECT_EQ(map(transmit_, 0, 3), AbortCode::kPdoLengthExceeded);
  EXPECT_EQ(map(transmit_, 0, 9), AbortCode::kPdoLengthExceeded);
  EXPECT_EQ(map(transmit_, 0, 4), AbortCode::kObjectDoesNotExist);
  EXPECT_EQ(map(transmit_, 0, 2), AbortCode::kNone);
  EXPECT_EQ(transmit_.size_bytes(), 8);
}

TEST_F(PdoRecordTest, MapsUpToEightObjects) {
  constexpr std::uint32_t kDummyUnsigned8 = mapping(0x0005, 0, 8);
  for (std::uint8_t i = 1; i <= 8; ++i) ASSERT_EQ(map(receive_, i, kDummyUnsigned8), AbortCode::kNone);
  EXPECT_EQ(map(receive_, 9, kDummyUnsigned8), AbortCode::kSubindexDoesNotExist);
  EXPECT_EQ(map(receive_, 0, 8), AbortCode::kNone);
  EXPECT_EQ(receive_.size_bytes(), 8);
}

TEST_F(PdoRecordTest, HasTheSubindicesOfItsDirection) {
  EXPECT_EQ(receive_.write_communication(0, 2), AbortCode::kWriteOfReadOnly);
  EXPECT_EQ(receive_.write_communication(5, 100), AbortCode::kNone);
  for (const std::uint8_t subindex : std::initializer_list<std::uint8_t>{3, 4, 6, 7}) {
    EXPECT_EQ(receive_.write_communication(subindex, 2), AbortCode::kSubindexDoesNotExist);
  }
  EXPECT_EQ(transmit_.write_communication(6, 240), AbortCode::kNone);
  EXPECT_EQ(transmit_.write_communication(6, 241), AbortCode::kInvalidValue);
  for (const std::uint8_t subindex : std::initializer_list<std::uint8_t>{4, 7}) {
    EXPECT_EQ(transmit_.write_communication(subindex, 2), AbortCode::kSubindexDoesNotExist);
  }
}

TEST_F(PdoRecordTest, PacksAndUnpacksLittleEndian) {
  ASSERT_EQ(receive_.configure(kTestRpdos[0], 0x10, dictionary_), AbortCode::kNone);
  const std::uint8_t received[] = {0x34, 0x12, 0x18, 0xFC, 0xFF, 0xFF};
  EXPECT_EQ(receive_.unpack(dictionary_, received), 0);
  EXPECT_EQ(values_.controlword, 0x1234);
  EXPECT_EQ(values_.target, -1000);
  ASSERT_EQ(transmit_.configure(kTestTpdos[0], 0x10, dictionary_), AbortCode::kNone);
  values_.statusword = 0xA1B2;
  values_.position = 0x01020304;
  values_.torque = -1;
  std::uint8_t sent[8] = {};
  transmit_.pack(dictionary_, sent);
  EXPECT_EQ(std::vector(sent, sent + 8), (std::vector<std::uint8_t>{0xB2, 0xA1, 4, 3, 2, 1, 0xFF, 0xFF}));
}

}  // namespace
}  // namespace koboshi::canopen
