#include "lab/tune/gait_search.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "base/text/text.h"
#include "lab/tune/gait_text.h"

namespace koboshi::lab {
namespace {

constexpr double kDuration_s = 10.0;

ScenarioTrial walked(double speed_m_per_s) {
  ScenarioTrial trial{.duration_s = kDuration_s, .foot_slip_max_m = 0.002};
  trial.walk.distance_m = 1.0;
  trial.walk.speed_m_per_s = speed_m_per_s;
  trial.walk.lateral_drift_m = 0.05;
  return trial;
}

ScenarioTrial drifted(ScenarioTrial trial, double drift_m) {
  trial.walk.lateral_drift_m = drift_m;
  return trial;
}

ScenarioTrial slid(ScenarioTrial trial, double slip_m) {
  trial.foot_slip_max_m = slip_m;
  return trial;
}

ScenarioTrial fallen(double after_s) {
  ScenarioTrial trial = walked(0.5);
  trial.outcome = Outcome::kFell;
  trial.duration_s = after_s;
  return trial;
}

TEST(Reward, RanksEveryWalkAboveEveryFall) {
  const ScenarioTrial worst_walk = slid(drifted(walked(0.0), -3.0), 0.02);
  EXPECT_GT(reward(walked(0.2), kDuration_s), reward(walked(0.1), kDuration_s));
  EXPECT_LT(reward(fallen(9.0), kDuration_s), 0.0);
  EXPECT_GT(reward(fallen(9.0), kDuration_s), reward(fallen(5.0), kDuration_s));
  EXPECT_GT(reward(walked(0.1), kDuration_s), reward(fallen(9.9), kDuration_s));
  EXPECT_GT(reward(worst_walk, kDuration_s), reward(fallen(5.0), kDuration_s));
  EXPECT_EQ(reward({.duration_s = kDuration_s}, kDuration_s), -1.0) << "it never walked";
}

TEST(Reward, CountsDriftAndSlip) {
  const double straight = reward(walked(0.2), kDuration_s);
  EXPECT_LT(reward(drifted(walked(0.2), 0.2), kDuration_s), straight);
  EXPECT_EQ(reward(drifted(walked(0.2), -0.05), kDuration_s), straight);
  EXPECT_LT(reward(slid(walked(0.2), 0.02), kDuration_s), straight);
}

// The start of a search must lie within its bounds, or it would begin elsewhere.
TEST(GaitParameters, HoldTheRobotsOwnGait) {
  const std::filesystem::path file = std::filesystem::path(KOBOSHI_SOURCE_DIR) / "robots/koboshi/gait.yaml";
  const std::string text = read_text_file(file, "a gait file");
  for (const SearchedNumber& number : gait_parameters()) {
    if (!has_number(text, number.path)) continue;
    EXPECT_GE(gait_number(text, number.path, file), number.low) << number.path;
    EXPECT_LE(gait_number(text, number.path, file), number.high) << number.path;
  }
}

TEST(SearchedNumbers, LieOnTheirGridsWithinTheirBounds) {
  const std::vector<SearchedNumber> numbers{{"a", 0.3, 1.0, 0.02, 0.65}, {"b", 0.0, 5.0, 0.3, 9.0}};
  EXPECT_EQ(start_of(numbers), (std::vector{(0.65 - 0.3) / (1.0 - 0.3), 1.0}));
  EXPECT_EQ(values_at(numbers, {0.513, 0.0}), (std::vector{0.66, 0.0}));
  EXPECT_EQ(values_at(numbers, {1.0, 1.0}), (std::vector{1.0, 5.0}));
}

}  // namespace
}  // namespace koboshi::lab
