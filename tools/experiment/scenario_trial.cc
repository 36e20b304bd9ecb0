#include "tools/experiment/scenario_trial.h"

#include <memory>
#include <mutex>

namespace koboshi::tools {
namespace {

// libsdformat keeps tables of its own while it reads a file.
std::unique_ptr<Simulation> make_simulation(const sim::Scenario& scenario, const RobotChange& change) {
  static std::mutex reading;
  const std::lock_guard lock(reading);
  return std::make_unique<Simulation>(scenario, in_process(), change);
}

// False when an error ended it.
bool play_until(Simulation& simulation, RunRecorder& recorder, const Watch& is_over) {
  try {
    while (!simulation.finished() && !is_over(simulation, recorder)) {
      simulation.advance();
      recorder.record();
    }
    return true;
  } catch (const std::runtime_error&) {
    return false;
  }
}

Values watch_scenario(const sim::Scenario& scenario, const RobotChange& change, const Watch& is_over) {
  const std::unique_ptr<Simulation> simulation = make_simulation(scenario, change);
  RunRecorder recorder(*simulation, nullptr);
  const bool ended_well = play_until(*simulation, recorder, is_over);
  Values values;
  const nlohmann::ordered_json summary = sim::to_json(recorder.summary());
  for (const auto& [key, value] : summary.items()) {
    if (value.is_number()) values[key] = value.get<double>();
    if (value.is_boolean()) values[key] = value.get<bool>() ? 1.0 : 0.0;
  }
  values["failed"] = ended_well ? 0.0 : 1.0;
  if (!ended_well) values["fell"] = 1.0;
  return values;
}

RobotChange robot_of(const PerturbationBounds& bounds, std::uint64_t seed) {
  return [&bounds, seed](sim::RobotDescription& robot) { perturb_robot(robot, bounds, seed); };
}

}  // namespace

Values play_scenario(const sim::Scenario& scenario, const RobotChange& change, const IsOver& is_over) {
  return watch_scenario(scenario, change, [&](const Simulation&, const RunRecorder& recorder) {
    return recorder.fell() || (is_over && is_over(recorder));
  });
}

Values watch_in_world(sim::Scenario scenario, const PerturbationBounds& bounds, std::uint64_t seed,
                      const Watch& is_over) {
  perturb_scenario(scenario, bounds, seed);
  return watch_scenario(scenario, robot_of(bounds, seed), is_over);
}

Values play_in_world(sim::Scenario scenario, const PerturbationBounds& bounds, std::uint64_t seed,
                     const IsOver& is_over) {
  perturb_scenario(scenario, bounds, seed);
  return play_scenario(scenario, robot_of(bounds, seed), is_over);
}

}  // namespace koboshi::tools
