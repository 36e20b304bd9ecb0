#include "lab/catalogue/gyro_feedback.h"

#include <cmath>
#include <optional>

#include "base/text/text.h"
#include "base/text/user_units.h"
#include "lab/experiment/files.h"
#include "lab/trial/pushes.h"
#include "sim_board/random/random_stream.h"
#include "simulation/disturbance/world_text.h"
#include "simulation/scenario/paths.h"
#include "simulation/scenario/reader.h"

namespace koboshi::lab {
namespace {

// The first push comes when the walk has left its starting steps behind.
constexpr double kFirstPush_s = 2.0;

// Soft ground gives way like felt, without much of a rebound, under a robot of 1.2 kg on a sole's four
// points: on one foot it sinks by up to 3 mm.
constexpr double kSoftest_N_per_m = 1000.0;
constexpr double kStiffest_N_per_m = 5000.0;
constexpr double kDampingRatio = 0.5;
constexpr double kMassAbove_kg = 0.3;

simulation::GroundSurface::Softness soft_ground(std::uint64_t seed) {
  sim_board::RandomStream softness(seed, "ground stiffness");
  const double stiffness_N_per_m = between(softness, kSoftest_N_per_m, kStiffest_N_per_m);
  return {stiffness_N_per_m, 2.0 * kDampingRatio * std::sqrt(stiffness_N_per_m * kMassAbove_kg)};
}

// The distance over time of a robot that fell is no speed of a walk.
ScenarioTrial without_a_fallen_walk(ScenarioTrial trial) {
  if (!trial.lost()) return trial;
  const simulation::WalkSummary none = no_walk();
  trial.walk.speed_m_per_s = none.speed_m_per_s;
  trial.walk.lateral_drift_m = none.lateral_drift_m;
  trial.walk.heading_drift_rad = none.heading_drift_rad;
  return trial;
}

std::string hash_of(const GyroFeedbackOptions& options, const std::vector<simulation::Scenario>& scenarios) {
  std::vector<std::filesystem::path> files;
  for (const simulation::Scenario& scenario : scenarios) {
    const std::vector<std::filesystem::path> of_scenario = simulation::input_files(scenario);
    files.insert(files.end(), of_scenario.begin(), of_scenario.end());
  }
  std::vector<std::string> texts{options.disturbed ? "push " + number_text(options.push_N_s) : "level"};
  for (const auto& [factor, range] : simulation::range_texts(simulation::world_named(options.world)))
    texts.insert(texts.end(), {factor, range});
  for (const Override& override_value : options.overrides) {
    texts.insert(texts.end(), {override_value.path, override_value.value});
  }
  return hash_inputs(files, texts);
}

}  // namespace

std::string gyro_feedback_cell(int points, bool feedback) {
  return std::to_string(points) + (feedback ? "-on" : "-off");
}

simulation::Scenario gyro_feedback_scenario(const GyroFeedbackOptions& options, int points, bool feedback) {
  std::vector<Override> overrides = options.overrides;
  overrides.push_back({"gait.points", std::to_string(points)});
  overrides.push_back({"gait.feedback", feedback ? "true" : "false"});
  if (!options.gaits.empty()) {
    const auto file = std::filesystem::absolute(simulation::find_path(options.gaits) /
                                                (gyro_feedback_cell(points, feedback) + ".yaml"));
    overrides.push_back({"gait.file", "\"" + file.string() + "\""});
  }
  return simulation::read_scenario(options.scenario, overrides);
}

simulation::Scenario seeded_walk(simulation::Scenario scenario, const GyroFeedbackOptions& options,
                                 std::uint64_t seed) {
  scenario.seed = seed;
  scenario.world = {simulation::world_named(options.world), std::nullopt};
  if (!options.disturbed) return scenario;
  scenario.ground.softness = soft_ground(seed);
  std::uint64_t walk_us = 0;
  for (const simulation::Command& command : scenario.commands) {
    if (command.kind == simulation::Command::Kind::kPlay) walk_us = command.at_us;
  }
  add_pushes(scenario, "trunk", walk_us, {.first_s = kFirstPush_s, .highest_N_s = options.push_N_s}, seed);
  return scenario;
}

FieldTable<ScenarioTrial> walk_fields(double falls_within) {
  using T = ScenarioTrial;
  using Walk = simulation::WalkSummary;
  constexpr auto kWalk = &T::walk;
  Fields<T> outcomes = outcome_fields<T>(&T::outcome);
  outcomes.front().metric.tight_at = falls_within;  // the falls
  return {outcomes,
          Fields<T>{{{"distance_m", "distance [m]", 2}, kWalk, &Walk::distance_m},
                    {{"speed_m_per_s", "speed [m/s]"}, kWalk, &Walk::speed_m_per_s},
                    {{"lateral_drift_m", "drift [m]", 2}, kWalk, &Walk::lateral_drift_m},
                    {{"zmp_rms_error_m", "ZMP error RMS [mm]", 1, kMmPerM}, kWalk, &Walk::zmp_rms_error_m},
                    {{"zmp_lag_s", "ZMP lag [ms]", 0, 1e3}, kWalk, &Walk::zmp_lag_s},
                    {{"roll_rms_rad", "roll RMS [deg]", 2, 1.0 / kRadPerDegree}, kWalk, &Walk::roll_rms_rad},
                    {{"zmp_margin_p05_m", "ZMP margin p05 [mm]", 1, kMmPerM}, kWalk, &Walk::zmp_margin_p05_m},
                    {{"heading_drift_rad"}, kWalk, &Walk::heading_drift_rad},
                    {{"foot_lift_m", "foot lift [mm]", 1, kMmPerM}, kWalk, &Walk::foot_lift_m},
                    {{"foot_slip_max_m"}, &T::foot_slip_max_m},
                    {{"duration_s"}, &T::duration_s}}};
}

Experiment make_gyro_feedback(const GyroFeedbackOptions& options) {
  Experiment experiment{.name = options.disturbed ? "gyro-feedback-disturbed" : "gyro-feedback",
                        .title = "Gyro feedback and the number of points",
                        .first_seed = options.first_seed,
                        .seeds = options.seeds};
  std::vector<simulation::Scenario> scenarios;
  for (const int points : options.points) {
    for (const bool feedback : options.feedback) {
      scenarios.push_back(gyro_feedback_scenario(options, points, feedback));
      experiment.cells.push_back(
          {gyro_feedback_cell(points, feedback),
           {{"points", std::to_string(points)}, {"feedback", feedback ? "on" : "off"}}});
    }
  }
  experiment.conditions = {
      {"duration_s", number_text(1e-6 * static_cast<double>(scenarios.front().duration_us))},
      {"disturbed", options.disturbed ? "yes" : "no"},
      {"world", options.world}};
  experiment.inputs = hash_of(options, scenarios);
  experiment.warning = simulation::left_out_text(scenarios.front());  // they differ by the gait only
  set_trials(experiment, walk_fields(options.falls_within),
             [options, scenarios](std::size_t cell, std::uint64_t seed) {
               return without_a_fallen_walk(play_scenario(seeded_walk(scenarios[cell], options, seed), {}));
             });
  return experiment;
}

}  // namespace koboshi::lab
