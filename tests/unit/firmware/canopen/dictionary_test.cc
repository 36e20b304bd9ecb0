#include "firmware/canopen/dictionary.h"

#include <gtest/gtest.h>

#include <string>

#include "tests/unit/firmware/canopen/test_node.h"

namespace koboshi::canopen {
namespace {

class DictionaryTest : public testing::Test {
 protected:
  std::uint32_t read(ObjectAddress address) {
    ObjectValue value;
    EXPECT_EQ(dictionary_.read(address, value), AbortCode::kNone);
    return value.number();
  }
  AbortCode write(ObjectAddress address, std::uint32_t value, std::size_t size) {
    Location location;
    const AbortCode checked = dictionary_.check_write(address, value, size, location);
    if (checked == AbortCode::kNone) dictionary_.store(location, value);
    return checked;
  }

  TestValues values_;
  Dictionary dictionary_{kTestRows, std::as_writable_bytes(std::span(&values_, 1))};
};

TEST_F(DictionaryTest, ReadsTheOwnersValues) {
  values_.controlword = 0x1234;
  values_.position = -2;
  values_.torque = -3;
  values_.gains[2] = 0xDEADBEEF;
  EXPECT_EQ(read({0x6040, 0}), 0x1234u);
  EXPECT_EQ(read({0x6064, 0}), 0xFFFFFFFEu);
  EXPECT_EQ(read({0x6077, 0}), 0xFFFDu);  // two bytes in the byte order of the bus
  EXPECT_EQ(read({0x2000, 3}), 0xDEADBEEFu);
  EXPECT_EQ(read({0x6502, 0}), 0x80u);
}

TEST_F(DictionaryTest, ReportsTheHighestSubindexOfAnArray) {
  ObjectValue value;
  ASSERT_EQ(dictionary_.read({0x2000, 0}, value), AbortCode::kNone);
  EXPECT_EQ(value.number(), 3u);
  EXPECT_EQ(value.size(), 1u);
  EXPECT_EQ(write({0x2000, 0}, 3, 1), AbortCode::kWriteOfReadOnly);
}

TEST_F(DictionaryTest, WritesIntoTheOwnersValues) {
  EXPECT_EQ(write({0x6060, 0}, 0xFF, 1), AbortCode::kNone);
  EXPECT_EQ(values_.mode, -1);
  EXPECT_EQ(write({0x607A, 0}, static_cast<std::uint32_t>(-1000), 4), AbortCode::kNone);
  EXPECT_EQ(values_.target, -1000);
  EXPECT_EQ(write({0x2000, 2}, 77, 4), AbortCode::kNone);
  EXPECT_EQ(values_.gains[0], 0u);
  EXPECT_EQ(values_.gains[1], 77u);
  EXPECT_EQ(values_.gains[2], 0u);
}

TEST_F(DictionaryTest, ComparesLimitsWithTheObjectsSign) {
  EXPECT_EQ(write({0x607A, 0}, static_cast<std::uint32_t>(-1001), 4), AbortCode::kValueTooLow);
  EXPECT_EQ(write({0x607A, 0}, 1001, 4), AbortCode::kValueTooHigh);
  EXPECT_EQ(write({0x6060, 0}, 0xFE, 1), AbortCode::kValueTooLow);
  EXPECT_EQ(write({0x6060, 0}, 11, 1), AbortCode::kValueTooHigh);
  EXPECT_EQ(write({0x2002, 0}, 2, 1), AbortCode::kValueTooHigh);
  EXPECT_EQ(values_.target, 0);
  EXPECT_EQ(values_.mode, 0);
}

TEST_F(DictionaryTest, UsesTheObjectsSizeWhenNoneIsGiven) {
  EXPECT_EQ(write({0x6040, 0}, 0xAABBCCDD, 0), AbortCode::kNone);
  EXPECT_EQ(values_.controlword, 0xCCDD);
  EXPECT_EQ(values_.target, 0);
}

TEST_F(DictionaryTest, KeepsIndexAndSubindexErrorsApart) {
  ObjectValue value;
  const ObjectAddress no_index[] = {{0, 0},      {0x1FFF, 0}, {0x2003, 0},
                                    {0x6042, 0}, {0x6503, 0}, {0xFFFF, 0xFF}};
  for (const ObjectAddress address : no_index) {
    EXPECT_EQ(dictionary_.read(address, value), AbortCode::kObjectDoesNotExist) << address.index;
  }
  const ObjectAddress no_subindex[] = {{0x2000, 4}, {0x2000, 255}, {0x2001, 1}, {0x6502, 1}, {0x6040, 255}};
  for (const ObjectAddress address : no_subindex) {
    EXPECT_EQ(dictionary_.read(address, value), AbortCode::kSubindexDoesNotExist) << address.index;
  }
}

TEST_F(DictionaryTest, FindsNothingInAnEmptyTable) {
  const Dictionary empty({}, {});
  ObjectValue value;
  EXPECT_EQ(empty.read({0x2000, 0}, value), AbortCode::kObjectDoesNotExist);
}

TEST(DictionaryTable, IsCheckedForOrderOverlapAndBounds) {
  constexpr Field kFirst{DataType::kUnsigned32, 0};
  constexpr Entry kRow = object(0x2000, 1, kFirst, Access::kReadOnly);
  constexpr Entry kPair = kRow.repeated(2, 4);
  constexpr Entry kSecond = object(0x2000, 2, kFirst, Access::kReadOnly);
  static_assert(is_valid_table(std::array{kRow, kSecond}, 4));
  static_assert(!is_valid_table(std::array{kSecond, kRow}, 4));
  static_assert(!is_valid_table(std::array{kRow, kRow}, 4));
  static_assert(!is_valid_table(std::array{kPair, kSecond}, 8));
  static_assert(!is_valid_table(std::array{kPair}, 7));
  static_assert(is_valid_table(std::array{kPair}, 8));
}

TEST(ObjectValue, IsAnEmptyNumberAtFirst) {
  const ObjectValue value;
  EXPECT_EQ(value.number(), 0u);
  EXPECT_EQ(value.size(), 0u);
  EXPECT_FALSE(value.is_text());
  EXPECT_TRUE(value.bytes().empty());
}

// A row that gives nothing but its address: one read-only UNSIGNED32 without limits that no PDO carries.
TEST(DictionaryTable, HasRowsOfOneNumberUnlessTheySayOtherwise) {
  constexpr Entry kRow{.index = 0x2000};
  EXPECT_EQ(kRow.subindex, 0);
  EXPECT_EQ(kRow.count, 1);
  EXPECT_EQ(kRow.offset, 0);
  EXPECT_EQ(kRow.stride_bytes, 0);
  EXPECT_EQ(kRow.type, DataType::kUnsigned32);
  EXPECT_EQ(kRow.access, Access::kReadOnly);
  EXPECT_EQ(kRow.mappable, Mappable::kNo);
  EXPECT_FALSE(kRow.restricts());
  EXPECT_FALSE(kRow.kept);
  EXPECT_EQ(kRow.low, 0u);
  EXPECT_EQ(kRow.high, 0u);
  EXPECT_EQ(ObjectAddress(), (ObjectAddress{0, 0}));
  EXPECT_EQ(Location().entry, nullptr);
  EXPECT_EQ(Location().offset, 0);
}

TEST(ObjectValue, HoldsNumbersAndTexts) {
  ObjectValue value;
  value.set_number(0x11223344, 2);
  EXPECT_EQ(value.number(), 0x3344u);
  EXPECT_EQ(value.bytes().size(), 2u);
  EXPECT_EQ(value.bytes()[0], 0x44);
  value.set_text("dolls");
  EXPECT_TRUE(value.is_text());
  EXPECT_EQ(std::string(value.bytes().begin(), value.bytes().end()), "dolls");
}

}  // namespace
}  // namespace koboshi::canopen
