#include "tools/lab/trial/scenario_trial.h"

#include <memory>
#include <mutex>

#include "tools/lab/trial/outcome.h"

namespace koboshi::tools {
namespace {

// libsdformat keeps tables of its own while it reads a file.
std::unique_ptr<simulation::Simulation> make_simulation(const sim::Scenario& scenario,
                                                        const simulation::RobotChange& change) {
  static std::mutex reading;
  const std::lock_guard lock(reading);
  return std::make_unique<simulation::Simulation>(scenario, simulation::in_process(), change);
}

// How a run ended, and what the firmware did in it.
struct Played {
  bool blew_up = false;
  bool failed = false;
  bool low_supply = false;
  bool gave_up = false;
  std::string error{};  // that ended it
};

void follow_state(const simulation::Telemetry& said, Played& played) {
  using behaviour::State;
  const bool supply_low = said.reason == behaviour::Reason::kSupplyLow;
  played.low_supply = played.low_supply || said.state == State::kLowBattery || supply_low;
  played.gave_up = played.gave_up || said.state == State::kFalling || said.state == State::kFault ||
                   said.state == State::kEmergencyStop;
}

Played play_until(simulation::Simulation& simulation, simulation::RunRecorder& recorder,
                  const Watch& is_over) {
  Played played;
  try {
    while (!simulation.finished() && !is_over(simulation, recorder)) {
      simulation.advance();
      recorder.record();
      follow_state(recorder.telemetry(), played);
    }
  } catch (const sim::WorldBlewUp& error) {
    played.blew_up = true;
    played.error = error.what();
  } catch (const std::runtime_error& error) {
    played.failed = true;
    played.error = error.what();
  }
  return played;
}

Values watch_scenario(const sim::Scenario& scenario, const simulation::RobotChange& change,
                      const Watch& is_over) {
  const std::unique_ptr<simulation::Simulation> simulation = make_simulation(scenario, change);
  simulation::RunRecorder recorder(*simulation, nullptr);
  const Played played = play_until(*simulation, recorder, is_over);
  Values values;
  const nlohmann::ordered_json summary = sim::to_json(recorder.summary());
  for (const auto& [key, value] : summary.items()) {
    if (value.is_number()) values[key] = value.get<double>();
    if (value.is_boolean()) values[key] = value.get<bool>() ? 1.0 : 0.0;
  }
  const bool fell = recorder.fell();
  bool lost = false;
  const auto set = [&](const char* name, bool happened) {
    values[name] = happened && !lost ? 1.0 : 0.0;
    lost = lost || happened;
  };
  set("energy_guard", played.blew_up);
  set("failed", played.failed);
  set("fell", fell);
  set("low_supply", played.low_supply);
  set("gave_up", played.gave_up);
  values[kLost] = lost ? 1.0 : 0.0;
  values.error = played.error;
  return values;
}

simulation::RobotChange robot_of(const PerturbationBounds& bounds, std::uint64_t seed) {
  return [&bounds, seed](sim::RobotDescription& robot) { perturb_robot(robot, bounds, seed); };
}

}  // namespace

Values play_scenario(const sim::Scenario& scenario, const simulation::RobotChange& change,
                     const IsOver& is_over) {
  return watch_scenario(scenario, change,
                        [&](const simulation::Simulation&, const simulation::RunRecorder& recorder) {
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
