#include "tools/plot/columns.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>

#include "tests/support/temporary_folder.h"
#include "tools/plot/figure.h"

namespace koboshi::tools {
namespace {

using ::testing::ElementsAre;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

std::string csv_of(const Columns& columns, int digits) {
  const koboshi::test::TemporaryFolder folder;
  write_csv(columns, folder.path / "columns.csv", digits);
  std::ifstream stream(folder.path / "columns.csv");
  return {std::istreambuf_iterator<char>(stream), {}};
}

TEST(Columns, BecomeACsvFileWithEmptyCells) {
  Columns columns = make_columns({"time_s", "a_m"});
  add_row(columns, {0.0, 1.0 / 3.0});
  add_row(columns, {0.01, kNaN});
  EXPECT_EQ(csv_of(columns, 3), "time_s,a_m\n0,0.333\n0.01,\n");
  EXPECT_EQ(csv_of(columns, 0), "time_s,a_m\n0,0.3333333333333333\n0.01,\n");
}

TEST(Columns, AreFoundByName) {
  const Columns columns{{"time_s", {0.0, 1.0}}, {"a_m", {2.0, 3.0}}};
  EXPECT_THAT(values_of(columns, "a_m"), ElementsAre(2.0, 3.0));
  EXPECT_THROW(values_of(columns, "b_m"), PlotError);
}

TEST(Thinning, KeepsAShortCurveUnchanged) {
  const std::vector<double> x{0, 1, 2, 3};
  const std::vector<double> y{5, 4, 6, 1};
  EXPECT_THAT(thin(x, y, 4), ElementsAre(Point{0, 5}, Point{1, 4}, Point{2, 6}, Point{3, 1}));
  EXPECT_EQ(thin(x, y, 1000), thin(x, y, 4));
}

TEST(Thinning, KeepsTheExtremesOfEachIntervalInOrder) {
  const std::vector<double> x{0, 1, 2, 3, 4, 5, 6, 7};
  const std::vector<double> y{0, 9, -3, 1, 2, -7, 4, 3};
  EXPECT_THAT(thin(x, y, 2), ElementsAre(Point{1, 9}, Point{2, -3}, Point{5, -7}, Point{6, 4}));
}

TEST(Thinning, BreaksTheLineAtNaN) {
  const std::vector<double> x{0, 1, 2, 3, 4, 5};
  const std::vector<double> y{1, kNaN, kNaN, kNaN, 3, kNaN};
  const std::vector<Point> points = thin(x, y, 3);
  ASSERT_EQ(points.size(), 3u);
  EXPECT_EQ(points[0], (Point{0, 1}));
  EXPECT_TRUE(std::isnan(points[1].y));
  EXPECT_EQ(points[2], (Point{4, 3}));
}

TEST(Thinning, KeepsAnEmptyCurveEmpty) { EXPECT_TRUE(thin({}, {}, 10).empty()); }

}  // namespace
}  // namespace koboshi::tools
