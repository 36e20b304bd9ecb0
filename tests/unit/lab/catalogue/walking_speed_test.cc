#include "lab/catalogue/walking_speed.h"

#include <gtest/gtest.h>

#include "base/text/error.h"

namespace koboshi::lab {
namespace {

using Direction = SpeedLadder::Direction;

ScenarioTrial walked(double forward_m, double left_m, double turned_rad) {
  ScenarioTrial trial;
  trial.walk.distance_m = forward_m;
  trial.walk.lateral_drift_m = left_m;
  trial.walk.heading_drift_rad = turned_rad;
  trial.walk.energy_J = 100.0;
  return trial;
}

TEST(JudgedWalk, IsMeasuredAlongTheHeadingAtItsStart) {
  const SpeedTrial forward = judge_walk(Direction::kForward, 4.0, 1.0, 20.0, walked(4.0, -0.3, 0.1));
  EXPECT_FALSE(forward.not_sustained);
  EXPECT_DOUBLE_EQ(forward.speed_m_per_s.value(), 0.2);
  EXPECT_DOUBLE_EQ(forward.drift_m.value(), 0.3);
  EXPECT_DOUBLE_EQ(forward.energy_J_per_m.value(), 25.0);
  EXPECT_NEAR(forward.heading_off_deg.value(), 5.73, 0.01);
  EXPECT_GT(judge_walk(Direction::kForward, 4.0, 1.0, 20.0, walked(4.0, 0.0, -0.1)).heading_off_deg, 0.0);
  const SpeedTrial backward = judge_walk(Direction::kBackward, 4.0, 1.0, 40.0, walked(-4.0, 0.5, 0.0));
  EXPECT_DOUBLE_EQ(backward.speed_m_per_s.value(), 0.1);
  EXPECT_FALSE(backward.turn_rad_per_s);
}

TEST(JudgedWalk, MayDriftToEitherSide) {
  const SpeedTrial right = judge_walk(Direction::kSideways, 2.0, -1.0, 20.0, walked(0.4, -2.0, 0.0));
  EXPECT_DOUBLE_EQ(right.speed_m_per_s.value(), 0.1);
  EXPECT_DOUBLE_EQ(right.drift_m.value(), 0.4);
  EXPECT_TRUE(judge_walk(Direction::kSideways, 2.0, 1.0, 20.0, walked(0.4, -2.0, 0.0)).not_sustained);
  const SpeedTrial clockwise = judge_walk(Direction::kTurn, 6.0, -1.0, 10.0, walked(0.3, 0.4, -6.0));
  EXPECT_DOUBLE_EQ(clockwise.turn_rad_per_s.value(), 0.6);
  EXPECT_DOUBLE_EQ(clockwise.drift_m.value(), 0.5);
  EXPECT_FALSE(clockwise.speed_m_per_s);
}

TEST(JudgedWalk, HasNoSpeedAfterAFallOrAShortfall) {
  ScenarioTrial fallen = walked(4.0, 0.0, 0.0);
  fallen.outcome = Outcome::kFell;
  ScenarioTrial given_up = walked(4.0, 0.0, 0.0);
  given_up.outcome = Outcome::kGaveUp;
  for (const ScenarioTrial& trial : {fallen, given_up, walked(3.9, 0.0, 0.0), ScenarioTrial{}}) {
    const SpeedTrial judged = judge_walk(Direction::kForward, 4.0, 1.0, 20.0, trial);
    EXPECT_TRUE(judged.not_sustained);
    EXPECT_FALSE(judged.speed_m_per_s);
  }
}

TEST(WalkingSpeed, ReportsTheSpeedAtTheHighestSustainedCommand) {
  const Experiment experiment{.name = "walking-speed",
                              .metrics = speed_fields().metrics(),
                              .cells = {{"forward-0.1", {{"command", "0.1"}}},
                                        {"forward-0.2", {{"command", "0.2"}}},
                                        {"turn-1", {{"command", "1"}}}},
                              .ladders = {{.name = "forward", .unit = "m/s", .cells = {0, 1}},
                                          {.name = "turn", .unit = "rad/s", .cells = {2}}}};
  ExperimentResult result{.cells = {{}, {.stop = Stop::kTooMany}, {.stop = Stop::kBudget}}};
  for (const double speed_m_per_s : {0.08, 0.1}) {
    result.cells[0].played.push_back({.record = speed_fields().record({.speed_m_per_s = speed_m_per_s})});
  }
  const Conclusions conclusions = walking_speed_conclusions(experiment, result);
  EXPECT_DOUBLE_EQ(conclusions.values.at("forward_m_per_s"), 0.09);
  EXPECT_EQ(conclusions.values.at("forward_ended_by"), "too_many");
  EXPECT_EQ(conclusions.values.at("turn_rad_per_s"), 0.0);
  EXPECT_EQ(conclusions.values.at("turn_ended_by"), "budget");
  EXPECT_EQ(conclusions.lines,
            "forward: up to 0.1; the next is too much\nturn: at no level; the time was over\n");
}

TEST(WalkingSpeed, TestsTheChosenDirectionsFromTheSlowestCommand) {
  WalkingSpeedOptions options;
  options.scenario = KOBOSHI_SOURCE_DIR "/scenarios/go.yaml";
  options.ladders[1].commands = {0.2, 0.1};
  options.only = {"backward"};
  const Experiment experiment = make_walking_speed(options);
  ASSERT_EQ(experiment.ladders.size(), 1u);
  EXPECT_EQ(experiment.ladders[0].name, "backward");
  ASSERT_EQ(experiment.cells.size(), 2u);
  EXPECT_EQ(experiment.cells[0].name, "backward-0.1");
}

TEST(WalkingSpeed, RequiresAScenarioThatWalksByCommand) {
  EXPECT_THROW(std::ignore = make_walking_speed({{.scenario = KOBOSHI_SOURCE_DIR "/scenarios/squat.yaml"}}),
               InputError);
}

}  // namespace
}  // namespace koboshi::lab
