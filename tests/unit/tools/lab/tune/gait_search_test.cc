#include "tools/lab/tune/gait_search.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "sim_board/input/text.h"

namespace koboshi::tools {
namespace {

constexpr double kDuration_s = 10.0;

Values walked(double speed_m_per_s) {
  return {{"lost", 0.0},
          {"duration_s", kDuration_s},
          {"distance_m", 1.0},
          {"speed_m_per_s", speed_m_per_s},
          {"lateral_drift_m", 0.05},
          {"foot_slip_max_m", 0.002}};
}

Values with(Values values, const std::string& name, double value) {
  values[name] = value;
  return values;
}

Values fallen(double after_s) { return with(with(walked(0.5), "lost", 1.0), "duration_s", after_s); }

TEST(Reward, PutsEveryWalkBeforeEveryFall) {
  const Values worst_walk = with(with(walked(0.0), "lateral_drift_m", -3.0), "foot_slip_max_m", 0.02);
  EXPECT_GT(reward(walked(0.2), kDuration_s), reward(walked(0.1), kDuration_s));
  EXPECT_LT(reward(fallen(9.0), kDuration_s), 0.0);
  EXPECT_GT(reward(fallen(9.0), kDuration_s), reward(fallen(5.0), kDuration_s));
  EXPECT_GT(reward(walked(0.1), kDuration_s), reward(fallen(9.9), kDuration_s));
  EXPECT_GT(reward(worst_walk, kDuration_s), reward(fallen(5.0), kDuration_s));
  EXPECT_EQ(reward({{"lost", 0.0}, {"duration_s", kDuration_s}}, kDuration_s), -1.0);
}

TEST(Reward, CountsDriftAndSlip) {
  const double straight = reward(walked(0.2), kDuration_s);
  EXPECT_LT(reward(with(walked(0.2), "lateral_drift_m", 0.2), kDuration_s), straight);
  EXPECT_EQ(reward(with(walked(0.2), "lateral_drift_m", -0.05), kDuration_s), straight);
  EXPECT_LT(reward(with(walked(0.2), "foot_slip_max_m", 0.02), kDuration_s), straight);
}

// What the search begins with must lie within its bounds, or it would begin elsewhere.
TEST(SearchedNumbers, HoldTheRobotsOwnGait) {
  const std::filesystem::path file = std::filesystem::path(KOBOSHI_SOURCE_DIR) / "robots/koboshi/gait.yaml";
  const std::string text = sim::read_text_file(file, "a gait file");
  for (const SearchedNumber& number : searched_numbers()) {
    if (!has_number(text, number.key)) continue;
    EXPECT_GE(gait_number(text, number.key, file), number.low) << number.key;
    EXPECT_LE(gait_number(text, number.key, file), number.high) << number.key;
  }
}

}  // namespace
}  // namespace koboshi::tools
