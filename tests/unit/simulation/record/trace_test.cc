#include "simulation/record/trace.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <sstream>
#include <string>
#include <vector>

namespace koboshi::simulation {
namespace {

std::vector<std::uint64_t> cells(std::initializer_list<TraceValue> values) {
  std::vector<std::uint64_t> bits;
  for (const TraceValue& value : values) bits.push_back(value.bits);
  return bits;
}

TEST(Trace, NamesColumnsWithTheirUnits) {
  const TraceFormatter formatter({{"base_z", "m"}, {"behaviour", "", TraceKind::kInteger}});
  EXPECT_EQ(formatter.header(), "time_s,base_z_m,behaviour\n");
}

TEST(Trace, WritesTheShortestTextThatRoundTrips) {
  TraceFormatter formatter({{"a", "m"}, {"b", "", TraceKind::kInteger}});
  EXPECT_EQ(formatter.row(0, cells({0.1, 10'000'000})), "0,0.1,10000000\n");
  EXPECT_EQ(formatter.row(70'000, cells({-1.0 / 3.0, std::numeric_limits<std::int64_t>::min()})),
            "0.07,-0.3333333333333333,-9223372036854775808\n");
  EXPECT_EQ(formatter.row(12'000'001, cells({std::nan(""), -1})), "12.000001,,-1\n");
  const double smallest = -std::numeric_limits<double>::denorm_min();
  EXPECT_EQ(formatter.row(std::numeric_limits<std::uint64_t>::max(), cells({smallest, 0})),
            "18446744073709.551615,-5e-324,0\n");
}

TEST(Trace, WritesTheNamesOfValues) {
  static constexpr canopen::ValueName kNames[] = {{0, "boot"},
                                                  {7, "a state whose name is longer than any number"}};
  TraceFormatter formatter(
      {{"state", "", TraceKind::kInteger}, {"state_name", "", TraceKind::kInteger, kNames}});
  EXPECT_EQ(formatter.header(), "time_s,state,state_name\n");
  EXPECT_EQ(formatter.row(0, cells({0, 0})), "0,0,boot\n");
  EXPECT_EQ(formatter.row(0, cells({7, 7})), "0,7,a state whose name is longer than any number\n");
  EXPECT_EQ(formatter.row(0, cells({9, 9})), "0,9,\n");
}

// Rows of the longest names in every column. The C library aborts when the formatter's buffers are freed, if
// one of them was too short by the commas.
TEST(Trace, HoldsRowsOfTheLongestNames) {
  static constexpr canopen::ValueName kNames[] = {{0, "a state whose name is longer than any number"},
                                                  {1, "b state whose name is longer than any number"}};
  constexpr std::size_t kColumns = 400;
  for (const std::uint64_t first : {0u, 1u}) {
    TraceFormatter formatter(
        std::vector<TraceColumn>(kColumns, {"state_name", "", TraceKind::kInteger, kNames}));
    for (const std::uint64_t value : {first, 1 - first}) {
      std::string expected = "1844674407370.955161";
      for (std::size_t i = 0; i < kColumns; ++i) expected += ',' + std::string(kNames[value].name);
      EXPECT_EQ(formatter.row(1'844'674'407'370'955'161, std::vector<std::uint64_t>(kColumns, value)),
                expected + '\n');
    }
  }
}

TEST(Trace, RepeatsCellsBesideThoseThatChange) {
  TraceFormatter formatter({{"a", "m"}, {"b", "m"}, {"c", "", TraceKind::kInteger}});
  EXPECT_EQ(formatter.row(0, cells({0.125, 1.0 / 3.0, 7})), "0,0.125,0.3333333333333333,7\n");
  EXPECT_EQ(formatter.row(10'000, cells({0.125, 1.0 / 3.0, 7})), "0.01,0.125,0.3333333333333333,7\n");
  EXPECT_EQ(formatter.row(20'000, cells({2.0, 1.0 / 3.0, 7})), "0.02,2,0.3333333333333333,7\n");
  EXPECT_EQ(formatter.row(30'000, cells({2.0, std::nan(""), 7})), "0.03,2,,7\n");
  EXPECT_EQ(formatter.row(40'000, cells({0.0, std::nan(""), 7})), "0.04,0,,7\n");
  EXPECT_EQ(formatter.row(50'000, cells({-0.0, std::nan(""), 1'000'000})), "0.05,-0,,1000000\n");
  EXPECT_EQ(formatter.row(60'000, cells({-0.0, 0.5, 1'000'000})), "0.06,-0,0.5,1000000\n");
}

TEST(Trace, RoundTripsEveryDouble) {
  TraceFormatter formatter(std::vector<TraceColumn>{{"a", ""}});
  std::uint64_t bits = 1;
  for (int i = 0; i < 10000; ++i) {
    bits = bits * 6364136223846793005u + 1442695040888963407u;
    const double value = std::bit_cast<double>(bits);
    if (!std::isfinite(value)) continue;
    const std::string line(formatter.row(0, cells({value})));
    ASSERT_EQ(std::bit_cast<std::uint64_t>(std::strtod(line.c_str() + 2, nullptr)), bits) << line;
  }
}

}  // namespace
}  // namespace koboshi::simulation
