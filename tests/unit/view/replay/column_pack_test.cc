#include "view/replay/column_pack.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace koboshi::view {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

TEST(ColumnPack, IntegersComeBackExactly) {
  const std::vector<std::vector<std::int64_t>> columns = {
      {},
      {0, 0, 0},
      {-1, 0, 1, 255, -256, 65536},
      {10'000, 20'000, 30'000, 40'000},        // times
      {3'600'000'000'000, 3'600'000'010'000},  // times of a long run
      {-(std::int64_t{1} << 50), std::int64_t{1} << 50, 0},
  };
  ColumnPack pack;
  std::vector<nlohmann::ordered_json> packed;
  for (const auto& column : columns) packed.push_back(pack.integers(column));
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const std::vector<double> expected(columns[i].begin(), columns[i].end());
    EXPECT_EQ(unpack(packed[i], pack.bytes()), expected) << "column " << i;
  }
}

TEST(ColumnPack, NumbersAreRoundedByHalfAQuantumAtMost) {
  std::vector<float> values;
  for (int i = 0; i < 1000; ++i) values.push_back(3.0F * std::sin(0.01F * static_cast<float>(i)));
  for (const double quantum : {1e-5, 2e-5, 1e-3, 0.5}) {
    ColumnPack pack;
    const auto column = pack.numbers(values, quantum);
    const auto unpacked = unpack(column, pack.bytes());
    ASSERT_EQ(unpacked.size(), values.size());
    for (std::size_t i = 0; i < values.size(); ++i)
      EXPECT_NEAR(unpacked[i], static_cast<double>(values[i]), 0.5001 * quantum);
  }
}

TEST(ColumnPack, MissingValuesStayMissing) {
  ColumnPack pack;
  const std::vector<float> values = {kNaN, -2.0F, kNaN, 5.0F, std::numeric_limits<float>::infinity()};
  const auto column = pack.numbers(values, 1.0);
  const auto unpacked = unpack(column, pack.bytes());
  ASSERT_EQ(unpacked.size(), 5U);
  EXPECT_TRUE(std::isnan(unpacked[0]));
  EXPECT_EQ(unpacked[1], -2.0);
  EXPECT_TRUE(std::isnan(unpacked[2]));
  EXPECT_EQ(unpacked[3], 5.0);
  EXPECT_TRUE(std::isnan(unpacked[4]));
}

// Numbers that change evenly cost one byte or less each: the prediction fits.
TEST(ColumnPack, SmoothColumnsAreSmall) {
  std::vector<std::int64_t> times;
  for (std::int64_t i = 0; i < 1000; ++i) times.push_back(10'000 * (i + 1));
  ColumnPack pack;
  const auto column = pack.integers(times);
  EXPECT_EQ(column["order"], 2);
  EXPECT_EQ(column["planes"], 2);  // of the first number
  std::int64_t other_than_zero = 0;
  for (const char byte : pack.bytes()) other_than_zero += byte != 0 ? 1 : 0;
  EXPECT_LE(other_than_zero, 4);
}

TEST(PlotQuantum, HasFiveSignificantDigitsOfTheLargestMagnitude) {
  EXPECT_DOUBLE_EQ(plot_quantum(std::vector{1.5F, -0.2F}), 1e-5);
  EXPECT_DOUBLE_EQ(plot_quantum(std::vector{0.001F, -0.02F}), 1e-7);
  EXPECT_DOUBLE_EQ(plot_quantum(std::vector{kNaN, 250.5F}), 1e-3);
  EXPECT_DOUBLE_EQ(plot_quantum(std::vector{3.0F, kNaN, -7.0F}), 1.0);  // integers
  EXPECT_DOUBLE_EQ(plot_quantum(std::vector<float>{}), 1.0);
}

}  // namespace
}  // namespace koboshi::view
