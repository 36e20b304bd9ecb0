#include "firmware/canopen/described_object.h"

#include <gtest/gtest.h>

#include "firmware/canopen/dictionary.h"

namespace koboshi::canopen {
namespace {

struct Values {
  std::uint8_t state = 0;
  std::int16_t rate[3] = {};
};

constexpr DescribedObject kState{object(0x2000, 0, KOBOSHI_FIELD(Values, state), Access::kReadOnly),
                                 {.name = "State"}};
constexpr DescribedObject kRates{
    object(0x2001, 1, KOBOSHI_FIELD(Values, rate[0]), Access::kReadOnly).repeated(3, 2),
    {.name = "Rate", .elements = kAxes}};
constexpr DescribedObject kTable[] = {kState, heading(0x2001, "Rates"), kRates};

TEST(DescribedObjects, BecomeRowsWithoutHeadings) {
  constexpr auto kRows = rows_of<kTable>();
  static_assert(kRows.size() == 2);
  static_assert(is_valid_table(kRows, sizeof(Values)));
  EXPECT_EQ(kRows[0].index, 0x2000);
  EXPECT_EQ(kRows[1].count, 3);
}

TEST(DescribedObjects, NeedNamesAndHeadings) {
  EXPECT_TRUE(is_described(kTable));
  DescribedObject table[] = {kState, heading(0x2001, "Rates"), kRates};
  table[0].text.name = {};
  EXPECT_FALSE(is_described(table));
  const DescribedObject headless[] = {kState, kRates};
  EXPECT_FALSE(is_described(headless));
}

TEST(DescribedObjects, NeedAsManyElementsAsTheRowHas) {
  DescribedObject table[] = {heading(0x2001, "Rates"), kRates};
  table[1].entry.count = 2;
  EXPECT_FALSE(is_described(table));
}

TEST(DescribedObjects, NeedADenominator) {
  DescribedObject table[] = {kState};
  table[0].text.unit = {"deg", 360, 0};
  EXPECT_FALSE(is_described(table));
}

}  // namespace
}  // namespace koboshi::canopen
