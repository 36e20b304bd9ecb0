#include "tools/lab/trial/commanded_walk.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "sim_board/input/error.h"
#include "sim_board/input/text.h"
#include "sim_board/scenario/reader.h"
#include "sim_board/world/options.h"
#include "tools/lab/experiment/files.h"
#include "tools/lab/trial/perturbation.h"

namespace koboshi::tools {

sim::Scenario StandingStart::walking(const Eigen::Vector3d& velocity, double for_s) const {
  sim::Scenario walk = standing(for_s);
  walk.commands.push_back({.at_us = ready_us, .kind = sim::Command::Kind::kWalk, .velocity = velocity});
  return walk;
}

sim::Scenario StandingStart::standing(double for_s) const {
  sim::Scenario stand = scenario;
  stand.duration_us = ready_us + 1000 * static_cast<std::uint64_t>(std::llround(1000.0 * for_s));
  return stand;
}

StandingStart read_standing_start(const std::filesystem::path& scenario,
                                  std::span<const sim::Override> overrides) {
  StandingStart start{.scenario = sim::read_scenario(scenario, overrides)};
  auto& commands = start.scenario.commands;
  const auto walk = std::ranges::find(commands, sim::Command::Kind::kWalk, &sim::Command::kind);
  if (walk == commands.end())
    throw sim::InputError(scenario, 0, "no command to walk", "a scenario that walks by command");
  start.ready_us = walk->at_us;
  commands.erase(walk, commands.end());
  std::erase_if(start.scenario.pushes, [&](const sim::Push& push) { return push.at_us >= start.ready_us; });
  return start;
}

Eigen::Vector3d random_velocity(sim::RandomStream& random) {
  const double forward = between(random, -0.15, 0.22);
  const double left = between(random, -0.06, 0.06);
  return {forward, left, between(random, -0.5, 0.5)};
}

sim::Scenario with_failing_drive(const StandingStart& start, sim::RandomStream& random, double walk_s,
                                 double after_s) {
  static constexpr std::array<const char*, 4> kJoints{"left_knee", "right_knee", "left_hip_pitch",
                                                      "right_ankle_pitch"};
  sim::Scenario scenario = start.walking(random_velocity(random), walk_s + after_s);
  const auto joint = static_cast<std::size_t>(random.uniform() * kJoints.size());
  sim::Fault& fault = scenario.faults.emplace_back();
  fault.at_us = start.ready_us + to_us(walk_s);
  fault.kind = sim::Fault::Kind::kDrivePowerLoss;
  fault.target = {kJoints[joint], "an experiment", 0};
  return scenario;
}

Experiment begin_experiment(const std::string& name, const std::string& title, const ExperimentSetup& setup,
                            const sim::Scenario& scenario,
                            const std::vector<std::pair<std::string, double>>& conditions) {
  Experiment experiment{.name = name, .title = title, .first_seed = setup.first_seed, .seeds = setup.seeds};
  experiment.conditions = {{"stepper", std::string(sim::name_of(scenario.physics.stepper))}};
  for (const auto& [key, value] : conditions)
    experiment.conditions.emplace_back(key, sim::number_text(value));
  std::vector<std::string> texts;
  for (const auto& [key, value] : experiment.conditions) texts.insert(texts.end(), {key, value});
  for (const sim::Override& item : setup.overrides) texts.insert(texts.end(), {item.path, item.value});
  experiment.inputs = hash_inputs(sim::input_files(scenario), texts);
  return experiment;
}

}  // namespace koboshi::tools
