// The experiments on walking by command in short: trials of the real robot that can go either way.

#include <gtest/gtest.h>

#include <cmath>

#include "lab/catalogue/loop.h"
#include "lab/catalogue/push_recovery.h"
#include "lab/catalogue/robustness.h"
#include "lab/catalogue/terrain.h"
#include "lab/catalogue/walking_speed.h"
#include "lab/experiment/ladder.h"

namespace koboshi::tools {
namespace {

constexpr const char* kGo = KOBOSHI_SOURCE_DIR "/scenarios/go.yaml";

template <typename Options>
Options short_form() {
  Options options;
  options.scenario = kGo;
  options.overrides = {{"physics.stepper", "lumped"}};
  options.seeds = 1;
  return options;
}

// Slowly over a short way, and then at a command that the robot does not follow by half.
TEST(WalkingSpeed, SustainsASlowWalkAndNoImpossibleOne) {
  lab::WalkingSpeedOptions options = short_form<lab::WalkingSpeedOptions>();
  options.distance_m = 0.5;
  options.ladders = {{.direction = lab::SpeedLadder::Direction::kForward, .commands = {0.15, 2.0}}};
  const lab::Experiment experiment = lab::make_walking_speed(options);
  const lab::ExperimentResult result = lab::play_experiment(experiment, {});
  const lab::Conclusions conclusions = lab::walking_speed_conclusions(experiment, result);
  const lab::Climb climb = lab::climb_of(experiment.ladders[0], result);
  ASSERT_EQ(climb.highest, 0u);
  EXPECT_EQ(climb.stop, lab::Stop::kTooMany);
  const double made_m_per_s = conclusions.values.at("forward_m_per_s");
  EXPECT_GT(made_m_per_s, 0.05);
  EXPECT_LT(made_m_per_s, 0.15) << "faster than it was told to";
  const lab::SpeedTrial slow = lab::speed_fields().trials(result.cells[0]).at(0);
  EXPECT_GT(slow.energy_J_per_m, 1.0);
  EXPECT_NEAR(slow.steady_percent.value(), 100.0, 15.0);
  // A foot that bears the robot alone shows its weight; a landing shows more.
  EXPECT_GT(slow.landing_weights.value(), 1.0);
  EXPECT_LT(slow.landing_weights.value(), 10.0);
}

TEST(PushRecovery, SurvivesASmallPushButNotALargeOne) {
  lab::PushRecoveryOptions options = short_form<lab::PushRecoveryOptions>();
  options.directions = 1;
  options.highest_N_s_per_kg = 1.0;
  options.halvings = 2;
  const lab::Experiment experiment = lab::make_push_recovery(options);
  const lab::ExperimentResult result = lab::play_experiment(experiment, {});
  const lab::Conclusions conclusions = experiment.conclude(experiment, result);
  const double standing = conclusions.values.at("standing_min_Ns_per_kg");
  EXPECT_GE(standing, 0.25);
  EXPECT_LE(standing, 0.5) << "0.75 is all that was asked";
  EXPECT_LE(conclusions.values.at("walking_min_Ns_per_kg"), 0.5);
}

TEST(Terrain, PassesOnAFloorAndFailsOnASteepSlope) {
  lab::TerrainOptions options = short_form<lab::TerrainOptions>();
  options.distance_m = 0.4;
  options.kinds = {"uphill"};
  options.levels = {0, 20};
  const lab::Experiment experiment = lab::make_terrain(options);
  const lab::Ladder& uphill = experiment.ladders.at(0);
  ASSERT_EQ(uphill.cells.size(), 2u);
  const lab::ExperimentResult result = lab::play_experiment(experiment, {});
  ASSERT_EQ(lab::climb_of(uphill, result).highest, uphill.cells.front());
  EXPECT_EQ(experiment.conclude(experiment, result).values.at("uphill_passed"), 0.0);
}

TEST(Terrain, TakesRisingLevelsForKindsOfOneUnit) {
  lab::TerrainOptions options = short_form<lab::TerrainOptions>();
  EXPECT_EQ(lab::make_terrain(options).ladders.size(), lab::TerrainOptions::all_kinds().size());
  options.levels = {5, 8};
  EXPECT_THROW(static_cast<void>(lab::make_terrain(options)), InputError) << "millimetres and degrees";
  options.kinds = {"uphill", "across"};
  EXPECT_EQ(lab::make_terrain(options).cells.size(), 4u);
  options.levels = {8, 5};
  EXPECT_THROW(static_cast<void>(lab::make_terrain(options)), InputError);
}

TEST(Terrain, WalksNoFasterThanTheControllerPermits) {
  lab::TerrainOptions options = short_form<lab::TerrainOptions>();
  options.kinds = {"uphill"};
  options.levels = {0};
  options.speed_m_per_s = 0.34;
  EXPECT_THROW(static_cast<void>(lab::make_terrain(options)), InputError);
}

TEST(Robustness, TakesLevelsForOneFactor) {
  lab::RobustnessOptions options = short_form<lab::RobustnessOptions>();
  options.scenario = KOBOSHI_SOURCE_DIR "/scenarios/get_up.yaml";
  options.activities = {"push-standing", "push-on-the-spot"};
  options.levels = {0.25, 0.3};
  EXPECT_THROW(static_cast<void>(lab::make_robustness(options)), InputError);
  options.factors = {"impulse"};
  EXPECT_EQ(lab::make_robustness(options).cells.size(), 4u);
  options.levels = {0.3, 0.25};
  EXPECT_THROW(static_cast<void>(lab::make_robustness(options)), InputError);
}

TEST(Robustness, WalksNoFasterThanTheControllerPermits) {
  lab::RobustnessOptions options = short_form<lab::RobustnessOptions>();
  options.scenario = KOBOSHI_SOURCE_DIR "/scenarios/get_up.yaml";
  options.activities = {"walk-full"};
  options.factors = {"none"};
  options.full_speed_m_per_s = 0.33;
  EXPECT_EQ(lab::make_robustness(options).cells.size(), 1u);
  options.full_speed_m_per_s = 0.34;
  EXPECT_THROW(static_cast<void>(lab::make_robustness(options)), InputError);
  options.overrides = {{"parameters.highest_velocity_forward_mm_per_s", "340"}};
  EXPECT_EQ(lab::make_robustness(options).cells.size(), 1u);
}

// The weakest and the hardest push at a standing robot, in two directions; all other factors are nominal.
TEST(Robustness, CountsEachKindOfLossUpToTheCliff) {
  lab::RobustnessOptions options = short_form<lab::RobustnessOptions>();
  options.scenario = KOBOSHI_SOURCE_DIR "/scenarios/get_up.yaml";
  options.activities = {"push-standing"};
  options.factors = {"impulse"};
  options.seeds = 2;
  lab::Experiment experiment = lab::make_robustness(options);
  ASSERT_EQ(experiment.ladders.size(), 1u);
  lab::Ladder& impulse = experiment.ladders.front();
  const std::size_t weakest = impulse.cells.front();
  const std::size_t hardest = impulse.cells.back();
  impulse.cells = {weakest, hardest};
  const lab::ExperimentResult result = lab::play_experiment(experiment, {});
  for (const lab::RobustnessTrial& trial : lab::robustness_fields().trials(result.cells[weakest]))
    EXPECT_FALSE(trial.lost);
  const auto pushed_over = lab::robustness_fields().trials(result.cells[hardest]);
  ASSERT_EQ(pushed_over.size(), 2u);
  for (const lab::RobustnessTrial& trial : pushed_over) {
    EXPECT_TRUE(trial.lost);
    EXPECT_TRUE(trial.outcome == lab::Outcome::kFell || trial.outcome == lab::Outcome::kGaveUp);
  }
  const auto lost =
      experiment.conclude(experiment, result).values.at("lost").at("push-standing").at("impulse");
  EXPECT_EQ(lost.front(), 0.0);
  EXPECT_EQ(lost.back(), 1.0);
}

// The feedback of the rate is proportional below its clamp: with it, the loop has a gain; without any
// feedback, that of the DCM included, the trunk does not care what the gyro senses.
TEST(Loop, HasAGainOnlyWithFeedback) {
  lab::LoopOptions options = short_form<lab::LoopOptions>();
  options.states = {"walking"};
  options.axes = {"roll"};
  options.frequencies_Hz = {5.6};
  options.shortest_s = 2.0;
  const auto gain = [&] {
    const lab::Experiment experiment = lab::make_loop(options);
    const lab::LoopTrial trial =
        lab::loop_fields().trials(lab::play_experiment(experiment, {}).cells.front()).at(0);
    EXPECT_EQ(trial.outcome, lab::Outcome::kSurvived) << trial.error;
    return std::hypot(trial.gain_real.value_or(0.0), trial.gain_imaginary.value_or(0.0));
  };
  const double closed = gain();
  for (const lab::Feedback& feedback : lab::feedbacks()) {
    for (const std::string& name : feedback.parameters)
      options.overrides.push_back({"parameters." + name, "0"});
  }
  options.overrides.push_back({"parameters.plan_age_ms", "0"});
  options.overrides.push_back({"parameters.sole_levelling_percent", "0"});
  const double open = gain();
  EXPECT_GT(closed, 0.1);
  EXPECT_LT(open, 0.3 * closed);
}

}  // namespace
}  // namespace koboshi::tools
