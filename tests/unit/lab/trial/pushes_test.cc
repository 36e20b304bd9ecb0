#include "lab/trial/pushes.h"

#include <gtest/gtest.h>

namespace koboshi::lab {
namespace {

TEST(Pushes, AreDrawnWithinTheirBounds) {
  simulation::Scenario scenario;
  scenario.duration_us = 600'000'000;
  const PushBounds bounds{.first_s = 2.0,
                          .shortest_s = 1.0,
                          .longest_s = 3.0,
                          .lowest_N_s = 0.02,
                          .highest_N_s = 0.1,
                          .duration_s = 0.05};
  add_pushes(scenario, "trunk", 4'000'000, bounds, 3);
  ASSERT_GT(scenario.pushes.size(), 250u);  // one in 2 s
  EXPECT_LT(scenario.pushes.size(), 350u);
  EXPECT_EQ(scenario.pushes.front().at_us, 6'000'000u);
  std::uint64_t last_us = 5'000'000;
  Eigen::Vector3d sum_N_s = Eigen::Vector3d::Zero();
  for (const simulation::Push& push : scenario.pushes) {
    EXPECT_EQ(push.link.text, "trunk");
    EXPECT_GE(push.at_us - last_us, 1'000'000u);
    EXPECT_LE(push.at_us - last_us, 3'000'000u);
    last_us = push.at_us;
    // Over 0.1 s, which holds the whole push.
    const Eigen::Vector3d impulse_N_s = 0.1 * push.mean_force_W_N(push.at_us, push.at_us + 100'000);
    EXPECT_GE(impulse_N_s.norm(), 0.02 - 1e-12);
    EXPECT_LE(impulse_N_s.norm(), 0.1 + 1e-12);
    EXPECT_EQ(impulse_N_s.z(), 0.0);
    sum_N_s += impulse_N_s;
  }
  EXPECT_LT(sum_N_s.norm() / static_cast<double>(scenario.pushes.size()), 0.01) << "from all sides";
}

}  // namespace
}  // namespace koboshi::lab
