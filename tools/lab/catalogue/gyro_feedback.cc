#include "tools/lab/catalogue/gyro_feedback.h"

#include <memory>
#include <numbers>
#include <utility>

#include "sim_board/input/text.h"
#include "sim_board/input/user_units.h"
#include "sim_board/scenario/reader.h"
#include "tools/lab/experiment/files.h"
#include "tools/lab/trial/outcome.h"
#include "tools/lab/trial/perturbation.h"
#include "tools/lab/trial/scenario_trial.h"

namespace koboshi::tools {
namespace {

constexpr double kDegree_rad = std::numbers::pi / 180.0;
// The first push comes when the walk has left its starting steps behind.
constexpr double kFirstPush_s = 2.0;

PerturbationBounds bounds_of(const GyroFeedbackOptions& options) {
  PerturbationBounds bounds;
  if (!options.disturbed) return bounds;
  bounds.tilt_rad = 3.0 * kDegree_rad;
  bounds.softest_N_per_m = 1000.0;  // on one foot it sinks by 3 mm
  bounds.stiffest_N_per_m = 5000.0;
  return bounds;
}

// What a robot that fell did before is no walk at some speed: these are left out.
Values without_a_fallen_walk(Values values) {
  if (values.at(kLost) == 0.0) return values;
  for (const char* name : {"speed_m_per_s", "lateral_drift_m", "heading_drift_rad"}) values.erase(name);
  return values;
}

std::vector<Measure> measures(double falls_within) {
  using enum Measure::Kind;
  std::vector<Measure> measures = outcome_measures();
  measures.front().tight_at = falls_within;
  measures.insert(
      measures.end(),
      {{.name = "distance_m", .label = "distance [m]", .decimals = 2},
       {.name = "speed_m_per_s", .label = "speed [m/s]"},
       {.name = "lateral_drift_m", .label = "drift [m]", .decimals = 2},
       {.name = "zmp_rms_error_m", .label = "ZMP error RMS [mm]", .factor = sim::kMmPerM, .decimals = 1},
       {.name = "zmp_lag_s", .label = "ZMP lag [ms]", .factor = 1e3, .decimals = 0},
       {.name = "roll_rms_rad", .label = "roll RMS [deg]", .factor = 1.0 / kDegree_rad, .decimals = 2},
       {.name = "zmp_margin_p05_m", .label = "ZMP margin p05 [mm]", .factor = sim::kMmPerM, .decimals = 1},
       {.name = "heading_drift_rad"},
       {.name = "foot_lift_m", .label = "foot lift [mm]", .factor = sim::kMmPerM, .decimals = 1},
       {.name = "foot_slip_max_m"},
       {.name = "duration_s"}});
  return measures;
}

std::string hash_of(const GyroFeedbackOptions& options, const std::vector<sim::Scenario>& scenarios) {
  std::vector<std::filesystem::path> files;
  for (const sim::Scenario& scenario : scenarios) {
    const std::vector<std::filesystem::path> of_scenario = sim::input_files(scenario);
    files.insert(files.end(), of_scenario.begin(), of_scenario.end());
  }
  std::vector<std::string> texts{options.disturbed ? "push " + sim::number_text(options.push_N_s) : "level"};
  for (const sim::Override& override_value : options.overrides) {
    texts.insert(texts.end(), {override_value.path, override_value.value});
  }
  return hash_inputs(files, texts);
}

}  // namespace

std::string gyro_feedback_cell(int points, bool feedback) {
  return std::to_string(points) + (feedback ? "-on" : "-off");
}

sim::Scenario gyro_feedback_scenario(const GyroFeedbackOptions& options, int points, bool feedback) {
  std::vector<sim::Override> overrides = options.overrides;
  overrides.push_back({"gait.points", std::to_string(points)});
  overrides.push_back({"gait.feedback", feedback ? "true" : "false"});
  if (!options.gaits.empty()) {
    const auto file =
        std::filesystem::absolute(options.gaits / (gyro_feedback_cell(points, feedback) + ".yaml"));
    overrides.push_back({"gait.file", "\"" + file.string() + "\""});
  }
  return sim::read_scenario(options.scenario, overrides);
}

SeededWorld seeded_world(sim::Scenario scenario, const GyroFeedbackOptions& options, std::uint64_t seed) {
  const PerturbationBounds bounds = bounds_of(options);
  perturb_scenario(scenario, bounds, seed);
  if (options.disturbed) {
    std::uint64_t walk_us = 0;
    for (const sim::Command& command : scenario.commands) {
      if (command.kind == sim::Command::Kind::kPlay) walk_us = command.at_us;
    }
    add_pushes(scenario, "trunk", walk_us, {.first_s = kFirstPush_s, .highest_N_s = options.push_N_s}, seed);
  }
  return {std::move(scenario),
          [bounds, seed](sim::RobotDescription& robot) { perturb_robot(robot, bounds, seed); }};
}

Experiment make_gyro_feedback(const GyroFeedbackOptions& options) {
  Experiment experiment{.name = options.disturbed ? "gyro-feedback-disturbed" : "gyro-feedback",
                        .measures = measures(options.falls_within),
                        .first_seed = options.first_seed,
                        .seeds = options.seeds};
  auto scenarios = std::make_shared<std::vector<sim::Scenario>>();
  for (const int points : options.points) {
    for (const bool feedback : options.feedback) {
      scenarios->push_back(gyro_feedback_scenario(options, points, feedback));
      experiment.cells.push_back(
          {gyro_feedback_cell(points, feedback),
           {{"points", std::to_string(points)}, {"feedback", feedback ? "on" : "off"}}});
    }
  }
  experiment.conditions = {
      {"duration_s", sim::number_text(1e-6 * static_cast<double>(scenarios->front().duration_us))},
      {"disturbed", options.disturbed ? "yes" : "no"}};
  experiment.inputs = hash_of(options, *scenarios);
  experiment.play = [options, scenarios](std::size_t cell, std::uint64_t seed) {
    const SeededWorld world = seeded_world(scenarios->at(cell), options, seed);
    return without_a_fallen_walk(play_scenario(world.scenario, world.change));
  };
  return experiment;
}

}  // namespace koboshi::tools
