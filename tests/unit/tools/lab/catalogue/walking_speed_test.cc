#include "tools/lab/catalogue/walking_speed.h"

#include <gtest/gtest.h>

#include <cmath>

#include "sim_board/input/error.h"

namespace koboshi::tools {
namespace {

using Direction = SpeedLadder::Direction;

Values walked(double ahead_m, double left_m, double turned_rad) {
  return {{"lost", 0.0},
          {"fell", 0.0},
          {"gave_up", 0.0},
          {"low_supply", 0.0},
          {"energy_guard", 0.0},
          {"failed", 0.0},
          {"distance_m", ahead_m},
          {"lateral_drift_m", left_m},
          {"heading_drift_rad", turned_rad},
          {"energy_J", 100.0}};
}

TEST(JudgedWalk, IsMeasuredAlongTheHeadingAtItsStart) {
  const Values forward = judge_walk(Direction::kForward, 4.0, 1.0, 20.0, walked(4.0, -0.3, 0.1));
  EXPECT_EQ(forward.at("not_sustained"), 0.0);
  EXPECT_DOUBLE_EQ(forward.at("speed_m_per_s"), 0.2);
  EXPECT_DOUBLE_EQ(forward.at("drift_m"), 0.3);
  EXPECT_DOUBLE_EQ(forward.at("energy_J_per_m"), 25.0);
  EXPECT_NEAR(forward.at("heading_off_deg"), 5.73, 0.01);
  EXPECT_GT(judge_walk(Direction::kForward, 4.0, 1.0, 20.0, walked(4.0, 0.0, -0.1)).at("heading_off_deg"),
            0.0);
  const Values backward = judge_walk(Direction::kBackward, 4.0, 1.0, 40.0, walked(-4.0, 0.5, 0.0));
  EXPECT_DOUBLE_EQ(backward.at("speed_m_per_s"), 0.1);
  EXPECT_FALSE(backward.contains("turn_rad_per_s"));
}

TEST(JudgedWalk, MayGoToEitherSide) {
  const Values right = judge_walk(Direction::kSideways, 2.0, -1.0, 20.0, walked(0.4, -2.0, 0.0));
  EXPECT_DOUBLE_EQ(right.at("speed_m_per_s"), 0.1);
  EXPECT_DOUBLE_EQ(right.at("drift_m"), 0.4);
  EXPECT_EQ(judge_walk(Direction::kSideways, 2.0, 1.0, 20.0, walked(0.4, -2.0, 0.0)).at("not_sustained"),
            1.0);
  const Values clockwise = judge_walk(Direction::kTurn, 6.0, -1.0, 10.0, walked(0.3, 0.4, -6.0));
  EXPECT_DOUBLE_EQ(clockwise.at("turn_rad_per_s"), 0.6);
  EXPECT_DOUBLE_EQ(clockwise.at("drift_m"), 0.5);
  EXPECT_FALSE(clockwise.contains("speed_m_per_s"));
}

TEST(JudgedWalk, HasNoSpeedWhereItFellOrCameShort) {
  Values fallen = walked(4.0, 0.0, 0.0);
  fallen["lost"] = fallen["fell"] = 1.0;
  Values given_up = walked(4.0, 0.0, 0.0);
  given_up["lost"] = given_up["gave_up"] = 1.0;
  Values never_walked = walked(0.0, 0.0, 0.0);
  never_walked.erase("distance_m");
  for (const Values& values : {fallen, given_up, walked(3.9, 0.0, 0.0), never_walked}) {
    const Values judged = judge_walk(Direction::kForward, 4.0, 1.0, 20.0, values);
    EXPECT_EQ(judged.at("not_sustained"), 1.0);
    EXPECT_FALSE(judged.contains("speed_m_per_s"));
  }
}

TEST(WalkingSpeed, TellsTheSpeedMadeAtTheHighestCommandThatWasSustained) {
  const WalkingSpeed speed{.experiment = {},
                           .ladders = {{.name = "forward", .unit = "m/s", .cells = {0, 1}},
                                       {.name = "turn", .unit = "rad/s", .cells = {2}}}};
  ClimbResult result;
  result.experiment.cells = {{"forward-0.1", {{"command", "0.1"}}},
                             {"forward-0.2", {{"command", "0.2"}}},
                             {"turn-1", {{"command", "1"}}}};
  result.result.cells.resize(3);
  result.result.cells[0].played = {{0, 1, {{"speed_m_per_s", 0.08}}}, {0, 2, {{"speed_m_per_s", 0.1}}}};
  result.climbs = {{.first = 0, .levels = 2, .highest = 0, .stop = Stop::kTooMany},
                   {.first = 2, .levels = 1, .highest = std::nullopt, .stop = Stop::kBudget}};
  const Conclusions conclusions = walking_speed_conclusions(speed, result);
  EXPECT_DOUBLE_EQ(conclusions.values.at("forward_m_per_s"), 0.09);
  EXPECT_EQ(conclusions.values.at("forward_ended_by"), "too_many");
  EXPECT_EQ(conclusions.values.at("turn_rad_per_s"), 0.0);
  EXPECT_EQ(conclusions.values.at("turn_ended_by"), "budget");
  EXPECT_EQ(conclusions.lines,
            "forward: up to 0.1; the next is too much\nturn: at no level; the time was over\n");
}

TEST(WalkingSpeed, NeedsAScenarioThatWalksByCommand) {
  EXPECT_THROW(std::ignore = make_walking_speed({{.scenario = KOBOSHI_SOURCE_DIR "/scenarios/squat.yaml"}}),
               sim::InputError);
}

}  // namespace
}  // namespace koboshi::tools
