#include "studio/parameters/comparison.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "studio/parameters/parameter_document.h"
#include "tests/studio/parameters/sample_walk.h"

namespace koboshi::studio {
namespace {

simulation::Command walk(double forward_m_per_s) {
  simulation::Command command;
  command.kind = simulation::Command::Kind::kWalk;
  command.velocity = {forward_m_per_s, 0.0, 0.0};
  return command;
}

std::array<simulation::Scenario, 2> scenarios() {
  ParameterDocument other(KOBOSHI_SOURCE_DIR "/robots/koboshi/parameters.yaml");
  other.set(index_of(other.table(), "step_height_mm").value(), 26.0);
  other.set(index_of(other.table(), "highest_velocity_forward_mm_per_s").value(), 100.0);
  std::array<simulation::Scenario, 2> both{sample_walk(), sample_walk()};
  other.apply_to(both[1]);
  both[1].seed = 7;  // the comparison gives it that of the first
  return both;
}

double result(const std::vector<ComparedResult>& results, const std::string& name, std::size_t run) {
  const auto found = std::ranges::find(results, name, &ComparedResult::name);
  return found == results.end() ? std::nan("") : found->values[run];
}

// Each of the two has the bits of a run of its own, also with an input on the way.
TEST(Comparison, EqualsTwoSeparateRuns) {
  Comparison comparison(scenarios());
  for (int i = 0; i < 60; ++i) comparison.advance(100);
  comparison.give(walk(0.25));
  comparison.advance(1500);
  comparison.wait();
  EXPECT_FALSE(comparison.is_busy());
  EXPECT_EQ(comparison.error(), "");
  auto separate = scenarios();
  separate[1].seed = separate[0].seed;
  for (std::size_t run = 0; run < Comparison::kRuns; ++run) {
    Session session(separate[run]);
    session.step(6000);
    session.give(walk(0.25));
    session.step(1500);
    EXPECT_EQ(comparison.state_hash(run), session.state_hash()) << run;
  }
  EXPECT_NE(comparison.state_hash(0), comparison.state_hash(1));

  EXPECT_TRUE(comparison.take());
  EXPECT_EQ(comparison.common_samples(), 750U);
  const auto results = compare(comparison.summary(0), comparison.summary(1));
  EXPECT_GT(result(results, "Speed", 0), result(results, "Speed", 1) + 0.03);
  EXPECT_EQ(result(results, "Falls", 0), 0.0);
  EXPECT_TRUE(std::isfinite(result(results, "ZMP margin", 0)));
  EXPECT_NEAR(result(results, "Distance", 0),
              trunk_quantity(comparison.recording(0), 749, TrunkQuantity::kDistance), 0.1);
}

TEST(Comparison, EndsWithItsScenario) {
  auto both = scenarios();
  both[0].duration_us = 300'000;
  Comparison comparison(both);
  comparison.advance(200);
  EXPECT_FALSE(comparison.is_finished());
  comparison.advance(1000);
  comparison.wait();
  EXPECT_TRUE(comparison.is_finished());
  EXPECT_EQ(comparison.status(0).time_us, 300'000U);
  EXPECT_EQ(comparison.status(1).time_us, 300'000U);
}

TEST(SceneOfBoth, HasTheRobotsBesideEachOtherInTheirColours) {
  Session session(sample_walk());
  const view::Scene& one = session.head().scene;
  const view::Scene both =
      scene_of_both(one, one, {view::Colour{1.0F, 0.0F, 0.0F}, view::Colour{0.0F, 0.0F, 1.0F}});
  ASSERT_EQ(both.links.size(), 2 * one.links.size());
  EXPECT_EQ(both.links[0].name, "A: " + one.links[0].name);
  EXPECT_EQ(both.links[one.links.size()].name, "B: " + one.links[0].name);
  EXPECT_EQ(both.links[one.links.size()].parent, -1);
  for (std::size_t i = 1; i < one.links.size(); ++i)
    EXPECT_EQ(both.links[one.links.size() + i].parent,
              one.links[i].parent + (one.links[i].parent < 0 ? 0 : static_cast<int>(one.links.size())));
  EXPECT_GT(both.links[0].visuals[0].colour.red, both.links[one.links.size()].visuals[0].colour.red);
  const std::vector<view::Pose> poses(one.links.size());
  const auto apart = poses_of_both(poses, poses, 0.4);
  EXPECT_FLOAT_EQ(apart.front().p_WL_m.y(), 0.2F);
  EXPECT_FLOAT_EQ(apart.back().p_WL_m.y(), -0.2F);
}

}  // namespace
}  // namespace koboshi::studio
