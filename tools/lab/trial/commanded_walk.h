#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "sim_board/input/yaml_tree.h"
#include "sim_board/random/random_stream.h"
#include "sim_board/scenario/scenario.h"
#include "tools/lab/experiment/experiment.h"

namespace koboshi::tools {

// The common part of the experiments on a robot that stands by itself: the scenario brings it to its feet,
// and the experiment gives it other commands from there.

inline constexpr double kBodyHeight_m = 0.38;

// A scenario up to its first command to walk; later pushes are left out.
struct StandingStart {
  sim::Scenario scenario;
  std::uint64_t ready_us = 0;  // time of that command

  // Commands the velocity when the robot is ready; the run ends so much later. m/s forward and to the left,
  // rad/s counter-clockwise.
  [[nodiscard]] sim::Scenario walking(const Eigen::Vector3d& velocity, double for_s) const;
  // Gives no command: the robot stands.
  [[nodiscard]] sim::Scenario standing(double for_s) const;
};

// Throws sim::InputError, also for a scenario that never walks by command.
[[nodiscard]] StandingStart read_standing_start(const std::filesystem::path& scenario,
                                                std::span<const sim::Override> overrides);

// A velocity that the robot walks at in any direction, for StandingStart::walking.
[[nodiscard]] Eigen::Vector3d random_velocity(sim::RandomStream& random);
// Walks at a random velocity until the drive of a random joint of the legs loses its power. Ends so much
// later.
[[nodiscard]] sim::Scenario with_failing_drive(const StandingStart& start, sim::RandomStream& random,
                                               double walk_s, double after_s);

// The options of every experiment.
struct ExperimentSetup {
  std::filesystem::path scenario = "scenarios/go.yaml";
  std::vector<sim::Override> overrides{};  // of the scenario, in all cells
  std::uint64_t first_seed = 1;
  std::size_t seeds = 100;
};

// The experiment without its cells and trials. Its conditions are part of the inputs of its trials.
[[nodiscard]] Experiment begin_experiment(const std::string& name, const std::string& title,
                                          const ExperimentSetup& setup, const sim::Scenario& scenario,
                                          const std::vector<std::pair<std::string, double>>& conditions);

}  // namespace koboshi::tools
