#include "sim_board/input/text.h"

#include <gtest/gtest.h>

#include <array>
#include <numbers>
#include <vector>

namespace koboshi::sim {
namespace {

const std::vector<std::string> kVerbs{"enable", "play", "walk", "stop", "get_up"};

TEST(NearestName, IsTheNameThatDiffersLeast) {
  EXPECT_EQ(nearest_name("wlak", kVerbs), "walk");  // two letters have changed places
  EXPECT_EQ(nearest_name("stp", kVerbs), "stop");
  EXPECT_EQ(nearest_name("enabled", kVerbs), "enable");
  EXPECT_EQ(nearest_name("get-up", kVerbs), "get_up");
}

TEST(NearestName, IsEmptyWithoutASimilarName) {
  EXPECT_FALSE(nearest_name("nonsense", kVerbs));
  EXPECT_FALSE(nearest_name("", kVerbs));
  EXPECT_FALSE(nearest_name("walk", {}));
  EXPECT_FALSE(nearest_name(std::string(100'000, 'w'), kVerbs));
}

TEST(ExpectedNames, EndWithTheMostSimilar) {
  EXPECT_EQ(expected_names("wlak", kVerbs), "enable, play, walk, stop or get_up; the nearest is walk");
  EXPECT_EQ(expected_names("nonsense", kVerbs), "enable, play, walk, stop or get_up");
  EXPECT_EQ(expected_names("waalk", std::array<std::string, 1>{"walk"}), "walk");
}

TEST(ExpectedNames, AreTheMostSimilarOnlyForALongList) {
  std::vector<std::string> names(kVerbs);
  for (int i = 0; i < 20; ++i) names.push_back("joint_" + std::to_string(i));
  EXPECT_EQ(expected_names("wlak", names), "walk, the nearest of 25 names");
}

TEST(Texts, AreFormattedForReaders) {
  EXPECT_EQ(count_text(0, "fault"), "0 faults");
  EXPECT_EQ(count_text(1, "fault"), "1 fault");
  EXPECT_EQ(count_text(2, "fault"), "2 faults");
  EXPECT_EQ(degrees_text(2.61799400), "150");  // as a robot's file has it, 150.00000699 degrees
  EXPECT_EQ(degrees_text(-0.25 * std::numbers::pi), "-45");
}

}  // namespace
}  // namespace koboshi::sim
