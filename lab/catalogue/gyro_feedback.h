#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "lab/experiment/field_table.h"
#include "lab/trial/commanded_walk.h"
#include "lab/trial/scenario_trial.h"
#include "simulation/scenario/scenario.h"

namespace koboshi::lab {

// The paper's section 3: does a walk need more than four points, and what does gyro feedback do to it?
struct GyroFeedbackOptions : ExperimentSetup {
  GyroFeedbackOptions() : ExperimentSetup{.scenario = "scenarios/walk.yaml", .seeds = 20} {}

  std::vector<int> points{4, 8, 16};  // into which the pattern is divided
  std::vector<bool> feedback{false, true};
  // With a file for each cell, 8-on.yaml and so on, which were tuned for it. Empty: the scenario's gait.
  std::filesystem::path gaits{};
  // The walk is disturbed by pushes against the trunk and by soft ground.
  bool disturbed = false;
  double push_N_s = 0.1;        // the strongest push of the disturbed form
  double falls_within = 0.015;  // a cell stops when the share of falls is known to +- this
};

// The fields of a walk. A walk that is lost has no speed, drift or turn. A cell stops when the share of falls
// is known to +- falls_within; 0: never.
[[nodiscard]] FieldTable<ScenarioTrial> walk_fields(double falls_within = 0.0);

// "8-on": name of the cell, of its gait's file, of its figures.
[[nodiscard]] std::string gyro_feedback_cell(int points, bool feedback);

// A cell's scenario before a seed has changed the world.
[[nodiscard]] simulation::Scenario gyro_feedback_scenario(const GyroFeedbackOptions& options, int points,
                                                          bool feedback);

// The scenario in the world of a seed, with its soft ground and its pushes if the walk is disturbed.
[[nodiscard]] simulation::Scenario seeded_walk(simulation::Scenario scenario,
                                               const GyroFeedbackOptions& options, std::uint64_t seed);

// Reads and checks everything. Throws InputError.
[[nodiscard]] Experiment make_gyro_feedback(const GyroFeedbackOptions& options);

}  // namespace koboshi::lab
