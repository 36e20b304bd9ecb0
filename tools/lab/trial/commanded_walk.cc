#include "tools/lab/trial/commanded_walk.h"

#include <algorithm>
#include <cmath>

#include "sim_board/input/error.h"
#include "sim_board/scenario/reader.h"
#include "sim_board/world/options.h"
#include "tools/lab/experiment/files.h"

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

Experiment begin_experiment(const std::string& name, const CommandedWalkOptions& options,
                            const sim::Scenario& scenario,
                            const std::vector<std::pair<std::string, std::string>>& conditions) {
  Experiment experiment{.name = name, .first_seed = options.first_seed, .seeds = options.seeds};
  experiment.conditions = {{"stepper", std::string(sim::name_of(scenario.physics.stepper))}};
  experiment.conditions.insert(experiment.conditions.end(), conditions.begin(), conditions.end());
  std::vector<std::string> texts;
  for (const auto& [key, value] : experiment.conditions) texts.insert(texts.end(), {key, value});
  for (const sim::Override& item : options.overrides) texts.insert(texts.end(), {item.path, item.value});
  experiment.inputs = hash_inputs(sim::input_files(scenario), texts);
  return experiment;
}

}  // namespace koboshi::tools
