#include "lab/trial/getting_up.h"

#include <gtest/gtest.h>

#include <numbers>

namespace koboshi::lab {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr std::uint64_t kTick_us = 10'000;

simulation::GroundTruth trunk(double tilt_rad, double height_m, double rate_rad_per_s = 0.0) {
  simulation::GroundTruth truth;
  truth.tilt_rad = tilt_rad;
  truth.height_m = height_m;
  truth.pose_height_m = 0.16;
  truth.w_WB_W.x() = rate_rad_per_s;
  return truth;
}

// A robot that is told to get up at one second.
class GettingUpTest : public testing::Test {
 protected:
  static simulation::Scenario scenario() {
    simulation::Scenario scenario;
    scenario.duration_us = 10'000'000;
    scenario.commands.push_back({.at_us = 500'000, .kind = simulation::Command::Kind::kEnable});
    scenario.commands.push_back({.at_us = 1'000'000, .kind = simulation::Command::Kind::kPlay});
    return scenario;
  }
  // Whether it was over before the end.
  bool observe(const simulation::GroundTruth& truth, double until_s) {
    for (; 1e-6 * static_cast<double>(now_us_) < until_s; now_us_ += kTick_us) {
      if (getting_up_.observe(truth, now_us_)) return true;
    }
    return false;
  }

  GettingUp getting_up_{scenario()};
  std::uint64_t now_us_ = 0;
};

TEST_F(GettingUpTest, CountsFromTheCommandToTheFinalStand) {
  EXPECT_FALSE(observe(trunk(90 * kDegree, 0.03), 2.0));
  EXPECT_FALSE(getting_up_.stood_s());
  EXPECT_FALSE(observe(trunk(5 * kDegree, 0.16), 2.2));  // passes upright, and sways on
  EXPECT_FALSE(observe(trunk(5 * kDegree, 0.16, 0.2), 3.0));
  EXPECT_FALSE(getting_up_.stood_s());
  EXPECT_TRUE(observe(trunk(5 * kDegree, 0.16), 4.0));
  EXPECT_NEAR(getting_up_.stood_s().value(), 2.0, 1e-9);
}

TEST_F(GettingUpTest, DoesNotMistakeALeanOrASeatForAStand) {
  EXPECT_FALSE(observe(trunk(16 * kDegree, 0.16), 3.0));
  EXPECT_FALSE(observe(trunk(0.0, 0.08), 5.0));
  EXPECT_FALSE(getting_up_.stood_s());
}

TEST_F(GettingUpTest, DoesNotEndBeforeItBegins) {
  EXPECT_FALSE(observe(trunk(0.0, 0.16), 1.0));
  EXPECT_FALSE(getting_up_.stood_s());
}

TEST_F(GettingUpTest, ReportsHowFarItCame) {
  observe(trunk(180 * kDegree, 0.0), 0.1);
  EXPECT_NEAR(getting_up_.uprightness(), 0.0, 1e-12);
  observe(trunk(90 * kDegree, 0.04), 0.2);
  EXPECT_NEAR(getting_up_.uprightness(), 0.25 + 0.125, 1e-12);
  observe(trunk(0.0, 0.17), 0.3);
  EXPECT_NEAR(getting_up_.uprightness(), 1.0, 1e-12);
}

}  // namespace
}  // namespace koboshi::lab
