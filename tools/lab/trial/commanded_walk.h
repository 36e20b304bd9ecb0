#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "sim_board/input/yaml_tree.h"
#include "sim_board/scenario/scenario.h"
#include "tools/lab/experiment/experiment.h"

namespace koboshi::tools {

// What the experiments on walking by command have in common: the robot of a scenario is brought to its feet
// as there, and then told something else.

inline constexpr double kBodyHeight_m = 0.38;

// A scenario up to its first command to walk, and when that comes; pushes of later are left out.
struct StandingStart {
  sim::Scenario scenario;
  std::uint64_t ready_us = 0;

  // The velocity is commanded when the robot is ready, for the rest of a run that ends so much later: m/s
  // ahead and to the left, rad/s counter-clockwise.
  [[nodiscard]] sim::Scenario walking(const Eigen::Vector3d& velocity, double for_s) const;
  // It goes on standing.
  [[nodiscard]] sim::Scenario standing(double for_s) const;
};

// Throws sim::InputError, also for a scenario that never walks by command.
[[nodiscard]] StandingStart read_standing_start(const std::filesystem::path& scenario,
                                                std::span<const sim::Override> overrides);

// What an experiment on walking by command is made of.
struct CommandedWalkOptions {
  std::filesystem::path scenario = "scenarios/go.yaml";
  std::vector<sim::Override> overrides{};  // of the scenario, in all cells
  std::uint64_t first_seed = 1;
  std::size_t seeds = 100;
};

// The experiment without its cells, measures and trials. Its conditions are part of what its trials depend
// on.
[[nodiscard]] Experiment begin_experiment(const std::string& name, const CommandedWalkOptions& options,
                                          const sim::Scenario& scenario,
                                          const std::vector<std::pair<std::string, std::string>>& conditions);

}  // namespace koboshi::tools
