#include "lab/learn/episode.h"

#include <gtest/gtest.h>

namespace koboshi::lab {
namespace {

constexpr double kWalk_s = 10.0;

LearningStage pushed() {
  LearningStage stage{.name = "pushed", .world = "harsh"};
  stage.forward_m_per_s = {0.05, 0.15};
  stage.turn_rad_per_s = {-0.3, 0.3};
  stage.impulse_N_s_per_kg = {0.2, 0.4};
  stage.interval_s = {1.5, 2.0};
  return stage;
}

TEST(DrawCourse, StaysWithinTheStagesRanges) {
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    const EpisodePlayer::Course course = draw_course(pushed(), kWalk_s, seed);
    EXPECT_EQ(course.world, "harsh");
    EXPECT_GE(course.velocity.x(), 0.05);
    EXPECT_LT(course.velocity.x(), 0.15);
    EXPECT_EQ(course.velocity.y(), 0.0);
    EXPECT_LE(std::abs(course.velocity.z()), 0.3);
    ASSERT_GE(course.pushes.size(), 4u);
    double before_s = 0.0;
    for (const auto& push : course.pushes) {
      EXPECT_GE(push.at_s - before_s, 1.0);
      EXPECT_LE(push.at_s, 9.0) << "the robot has a second to fall";
      EXPECT_GE(push.impulse_N_s_per_kg.norm(), 0.2 - 1e-12);
      EXPECT_LE(push.impulse_N_s_per_kg.norm(), 0.4);
      before_s = push.at_s;
    }
  }
}

TEST(DrawCourse, DependsOnTheSeedAlone) {
  const auto first = draw_course(pushed(), kWalk_s, 7);
  EXPECT_EQ(first.velocity, draw_course(pushed(), kWalk_s, 7).velocity);
  EXPECT_NE(first.velocity, draw_course(pushed(), kWalk_s, 8).velocity);
}

TEST(DrawCourse, HasNoPushesWithoutAnImpulse) {
  LearningStage stage = pushed();
  stage.impulse_N_s_per_kg = {};
  EXPECT_TRUE(draw_course(stage, kWalk_s, 1).pushes.empty());
}

Episode stood() {
  Episode episode;
  episode.walk_s = kWalk_s;
  episode.drift_m_per_s = 0.02;
  episode.turn_rad_per_s = 0.1;
  episode.power_W = 12.0;
  episode.lean_rad2 = 0.01;
  episode.offset = 0.2;
  return episode;
}

TEST(Reward, IsSurvivalLessTheWeightedCosts) {
  EXPECT_EQ(reward_of(stood(), {}, kWalk_s), 1.0);
  const RewardWeights weights{
      .survival = 2.0, .drift = 5.0, .turn = 0.5, .power = 0.01, .lean = 10.0, .offset = 0.25};
  EXPECT_NEAR(reward_of(stood(), weights, kWalk_s), 2.0 - 0.1 - 0.05 - 0.12 - 0.1 - 0.05, 1e-12);
}

TEST(Reward, OfAWholeWalkIsTheSumOfItsCycles) {
  const RewardWeights weights{
      .survival = 2.0, .drift = 5.0, .turn = 0.5, .power = 0.01, .lean = 10.0, .offset = 0.25};
  const Episode walk = stood();
  const RewardTerms all{.walk_s = kWalk_s,
                        .drift_m = kWalk_s * walk.drift_m_per_s,
                        .turn_rad = kWalk_s * walk.turn_rad_per_s,
                        .energy_J = kWalk_s * walk.power_W,
                        .lean_rad2_s = kWalk_s * walk.lean_rad2,
                        .offset_s = kWalk_s * walk.offset};
  EXPECT_NEAR(reward_of(all, weights, kWalk_s), reward_of(walk, weights, kWalk_s), 1e-12);
}

TEST(Reward, OfALossRisesWithTheTimeBeforeIt) {
  Episode fell = stood();
  fell.outcome = Outcome::kFell;
  fell.walk_s = 4.0;
  EXPECT_NEAR(reward_of(fell, {}, kWalk_s), -0.6, 1e-12);
  fell.walk_s = 0.0;
  EXPECT_EQ(reward_of(fell, {}, kWalk_s), -1.0);
}

}  // namespace
}  // namespace koboshi::lab
