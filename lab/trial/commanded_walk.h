#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/yaml/yaml_tree.h"
#include "lab/experiment/experiment.h"
#include "sim_board/random/random_stream.h"
#include "simulation/scenario/scenario.h"

namespace koboshi::lab {

// The common part of the experiments on a robot that stands by itself: the scenario brings it to its feet,
// and the experiment gives it other commands from there.

inline constexpr double kBodyHeight_m = 0.38;

// A scenario up to its first command to walk; later pushes are left out.
struct StandingStart {
  simulation::Scenario scenario;
  std::uint64_t ready_us = 0;  // time of that command

  // Commands the velocity when the robot is ready; the run ends so much later. m/s forward and to the left,
  // rad/s counter-clockwise.
  [[nodiscard]] simulation::Scenario walking(const Eigen::Vector3d& velocity, double for_s) const;
  // Gives no command: the robot stands.
  [[nodiscard]] simulation::Scenario standing(double for_s) const;
};

// Throws InputError, in the name of an option of the command line, if the scenario's controller refuses to
// walk ahead at this speed, because it is beyond the robot's limit.
void require_permitted_speed(const std::string& option, double forward_m_per_s,
                             const simulation::Scenario& scenario);

// A velocity that the robot walks at in any direction, for StandingStart::walking.
[[nodiscard]] Eigen::Vector3d random_velocity(sim_board::RandomStream& random);
// Walks at a random velocity until the drive of a random joint of the legs loses its power. Ends so much
// later.
[[nodiscard]] simulation::Scenario with_failing_drive(const StandingStart& start,
                                                      sim_board::RandomStream& random, double walk_s,
                                                      double after_s);

// The options of every experiment.
struct ExperimentSetup {
  std::filesystem::path scenario = "scenarios/go.yaml";
  std::vector<Override> overrides{};  // of the scenario, in all cells
  std::string world = "mild";         // in which the trials are played; replaces the scenario's
  std::uint64_t first_seed = 1;
  std::size_t seeds = 100;
};

// Reads the setup's scenario, in the setup's world, with these overrides instead of the setup's. Throws
// InputError, also for a scenario that never walks by command.
[[nodiscard]] StandingStart read_standing_start(const ExperimentSetup& setup,
                                                std::span<const Override> overrides);

// The experiment without its cells and trials. Its conditions are part of the inputs of its trials.
[[nodiscard]] Experiment begin_experiment(const std::string& name, const std::string& title,
                                          const ExperimentSetup& setup, const simulation::Scenario& scenario,
                                          const std::vector<std::pair<std::string, double>>& conditions);

}  // namespace koboshi::lab
