#include "tools/teleop/map.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

namespace koboshi::tools {
namespace {

using testing::Each;
using testing::Not;

constexpr double kQuarterTurn = 0.5 * std::numbers::pi;

TEST(TrailMap, ShowsForwardUpAndLeftLeft) {
  TrailMap map;
  for (int i = 0; i <= 10; ++i) map.move_to({0.06 * i, 0.0, 0.0});           // 0.6 m ahead
  for (int i = 0; i <= 10; ++i) map.move_to({0.6, 0.05 * i, kQuarterTurn});  // 0.5 m to the left
  const std::vector<std::string> expected{"+-----------------+",             //
                                          "|                 |",             //
                                          "|                 |",             //
                                          "|                 |",             //
                                          "|                 |",             //
                                          "|        <.....   |",             //
                                          "|             .   |",             //
                                          "|             .   |",             //
                                          "|             o   |",             //
                                          "|                 |",             //
                                          "+- 17 x 0.1 m ----+"};
  EXPECT_EQ(map.lines(false), expected);
  EXPECT_EQ(map.lines(true)[5], "|        x.....   |");
}

TEST(TrailMap, ShowsTheHeading) {
  const auto letter = [](double heading_rad) {
    TrailMap map;
    map.move_to({3.0, -2.0, heading_rad});
    return map.lines(false)[TrailMap::kRows / 2][TrailMap::kColumns / 2];
  };
  EXPECT_EQ(letter(0.1), '^');
  EXPECT_EQ(letter(kQuarterTurn), '<');
  EXPECT_EQ(letter(-kQuarterTurn), '>');
  EXPECT_EQ(letter(3.0), 'v');
  EXPECT_EQ(letter(-3.0), 'v');
}

TEST(TrailMap, KeepsItsSizeForAnyDistance) {
  TrailMap map;
  for (int i = 0; i < 5000; ++i) map.move_to({0.1 * i, 0.05 * i, 0.0});
  const auto lines = map.lines(false);
  EXPECT_EQ(lines.size(), TrailMap::kRows);
  EXPECT_THAT(lines, Each(testing::SizeIs(TrailMap::kColumns)));
  EXPECT_THAT(lines, Each(Not(testing::HasSubstr("o")))) << "the start is out of sight";
}

TEST(PutBeside, TruncatesTheExistingText) {
  std::vector<std::string> lines{"title", "short", "a line that is too long", "end"};
  put_beside(lines, 1, 8, {"|1|", "|2|", "|3|", "|4|"});
  EXPECT_EQ(lines, (std::vector<std::string>{"title", "short   |1|", "a line t|2|", "end     |3|"}));
}

}  // namespace
}  // namespace koboshi::tools
