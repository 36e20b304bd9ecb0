#include "tools/lab/plot/columns.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "sim_board/input/error.h"
#include "tests/unit/sim_board/input/scratch_file.h"

namespace koboshi::tools {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

class CsvFile : public ::testing::Test {
 protected:
  static Columns read(const std::string& text, const std::vector<std::string>& names) {
    return read_columns(sim::ScratchFile("columns.csv", text).path(), names);
  }
  std::string refusal(const std::string& text, const std::vector<std::string>& names) {
    try {
      read(text, names);
    } catch (const sim::InputError& error) {
      return error.what();
    }
    return "";
  }
};

TEST_F(CsvFile, GivesTheColumnsThatAreAskedFor) {
  const Columns columns = read("time_s,a_m,b_rad\n0,1.5,-2e-3\n0.01,2.5,7\r\n", {"b_rad", "time_s", "b_rad"});
  EXPECT_EQ(columns.size(), 2u);
  EXPECT_THAT(columns.at("time_s"), ElementsAre(0.0, 0.01));
  EXPECT_THAT(columns.at("b_rad"), ElementsAre(-0.002, 7.0));
}

TEST_F(CsvFile, TakesAnEmptyCellForNoNumber) {
  const Columns columns = read("time_s,zmp_m\n0,\n1,2\n", {"zmp_m"});
  EXPECT_TRUE(std::isnan(columns.at("zmp_m")[0]));
  EXPECT_EQ(columns.at("zmp_m")[1], 2.0);
}

TEST_F(CsvFile, IsRefusedWithItsLine) {
  EXPECT_THAT(refusal("time_s,a\n0,1\n", {"b"}), HasSubstr(".csv:1: found no column b"));
  EXPECT_THAT(refusal("time_s,a\n0,1\n0\n", {"a"}), HasSubstr(".csv:3: found 1 cells, expected 2"));
  EXPECT_THAT(refusal("time_s,a\n0,1\n0,x\n", {"a"}), HasSubstr(".csv:3: found x, expected a number"));
  EXPECT_THAT(refusal("", {"a"}), HasSubstr("found no header"));
  EXPECT_THROW(read_columns("/no/such/file.csv", {}), sim::InputError);
}

TEST(Thinning, LeavesAShortCurveAlone) {
  const std::vector<double> x{0, 1, 2, 3};
  const std::vector<double> y{5, 4, 6, 1};
  EXPECT_THAT(thin(x, y, 4), ElementsAre(Point{0, 5}, Point{1, 4}, Point{2, 6}, Point{3, 1}));
  EXPECT_EQ(thin(x, y, 1000), thin(x, y, 4));
}

TEST(Thinning, KeepsTheExtremesOfEachRunInTheirOrder) {
  const std::vector<double> x{0, 1, 2, 3, 4, 5, 6, 7};
  const std::vector<double> y{0, 9, -3, 1, 2, -7, 4, 3};
  EXPECT_THAT(thin(x, y, 2), ElementsAre(Point{1, 9}, Point{2, -3}, Point{5, -7}, Point{6, 4}));
}

TEST(Thinning, BreaksTheLineWhereThereIsNoNumber) {
  const std::vector<double> x{0, 1, 2, 3, 4, 5};
  const std::vector<double> y{1, kNaN, kNaN, kNaN, 3, kNaN};
  const std::vector<Point> points = thin(x, y, 3);
  ASSERT_EQ(points.size(), 3u);
  EXPECT_EQ(points[0], (Point{0, 1}));
  EXPECT_TRUE(std::isnan(points[1].y));
  EXPECT_EQ(points[2], (Point{4, 3}));
}

TEST(Thinning, MakesNothingOfNothing) { EXPECT_TRUE(thin({}, {}, 10).empty()); }

}  // namespace
}  // namespace koboshi::tools
