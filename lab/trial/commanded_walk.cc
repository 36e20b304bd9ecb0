#include "lab/trial/commanded_walk.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/text/error.h"
#include "base/text/text.h"
#include "lab/experiment/files.h"
#include "lab/trial/pushes.h"
#include "sim_board/world/options.h"
#include "simulation/assembly/parameters.h"
#include "simulation/disturbance/world_text.h"
#include "simulation/scenario/reader.h"

namespace koboshi::lab {

simulation::Scenario StandingStart::walking(const Eigen::Vector3d& velocity, double for_s) const {
  simulation::Scenario walk = standing(for_s);
  walk.commands.push_back(
      {.at_us = ready_us, .kind = simulation::Command::Kind::kWalk, .velocity = velocity});
  return walk;
}

simulation::Scenario StandingStart::standing(double for_s) const {
  simulation::Scenario stand = scenario;
  stand.duration_us = ready_us + 1000 * static_cast<std::uint64_t>(std::llround(1000.0 * for_s));
  return stand;
}

StandingStart read_standing_start(const ExperimentSetup& setup, std::span<const Override> overrides) {
  StandingStart start{.scenario = simulation::read_scenario(setup.scenario, overrides)};
  start.scenario.world = {simulation::world_named(setup.world), std::nullopt};
  auto& commands = start.scenario.commands;
  const auto walk = std::ranges::find(commands, simulation::Command::Kind::kWalk, &simulation::Command::kind);
  if (walk == commands.end())
    throw InputError(setup.scenario, 0, "no command to walk", "a scenario that walks by command");
  start.ready_us = walk->at_us;
  commands.erase(walk, commands.end());
  std::erase_if(start.scenario.pushes,
                [&](const simulation::Push& push) { return push.at_us >= start.ready_us; });
  return start;
}

void require_permitted_speed(const std::string& option, double forward_m_per_s,
                             const simulation::Scenario& scenario) {
  const double limit_m_per_s =
      1e-3 * simulation::controller_values(scenario).velocity_limits.forward_mm_per_s;
  if (forward_m_per_s > limit_m_per_s)
    throw InputError(option, 0, number_text(forward_m_per_s) + " m/s",
                     "at most " + number_text(limit_m_per_s) +
                         " m/s, the robot's highest_velocity_forward_mm_per_s (--set parameters.NAME=VALUE)");
}

Eigen::Vector3d random_velocity(sim_board::RandomStream& random) {
  const double forward = between(random, -0.15, 0.22);
  const double left = between(random, -0.06, 0.06);
  return {forward, left, between(random, -0.5, 0.5)};
}

simulation::Scenario with_failing_drive(const StandingStart& start, sim_board::RandomStream& random,
                                        double walk_s, double after_s) {
  static constexpr std::array<const char*, 4> kJoints{"left_knee", "right_knee", "left_hip_pitch",
                                                      "right_ankle_pitch"};
  simulation::Scenario scenario = start.walking(random_velocity(random), walk_s + after_s);
  const auto joint = static_cast<std::size_t>(random.uniform() * kJoints.size());
  simulation::Fault& fault = scenario.faults.emplace_back();
  fault.at_us = start.ready_us + to_us(walk_s);
  fault.kind = simulation::Fault::Kind::kDrivePowerLoss;
  fault.target = {kJoints[joint], "an experiment", 0};
  return scenario;
}

Experiment begin_experiment(const std::string& name, const std::string& title, const ExperimentSetup& setup,
                            const simulation::Scenario& scenario,
                            const std::vector<std::pair<std::string, double>>& conditions) {
  Experiment experiment{.name = name, .title = title, .first_seed = setup.first_seed, .seeds = setup.seeds};
  experiment.conditions = {{"stepper", std::string(sim_board::name_of(scenario.physics.stepper))},
                           {"world", setup.world}};
  for (const auto& [key, value] : conditions) experiment.conditions.emplace_back(key, number_text(value));
  std::vector<std::string> texts;
  for (const auto& [key, value] : experiment.conditions) texts.insert(texts.end(), {key, value});
  for (const auto& [factor, range] : simulation::range_texts(simulation::world_named(setup.world)))
    texts.insert(texts.end(), {factor, range});
  for (const Override& item : setup.overrides) texts.insert(texts.end(), {item.path, item.value});
  experiment.inputs = hash_inputs(simulation::input_files(scenario), texts);
  experiment.warning = simulation::left_out_text(scenario);
  return experiment;
}

}  // namespace koboshi::lab
