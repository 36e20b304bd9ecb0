#include "tools/experiment/scenario_trial.h"

#include <memory>
#include <mutex>
#include <optional>

#include "tools/run/run_recorder.h"

namespace koboshi::tools {
namespace {

// libsdformat keeps tables of its own while it reads a file.
std::unique_ptr<Simulation> make_simulation(const sim::Scenario& scenario, const RobotChange& change) {
  static std::mutex reading;
  const std::lock_guard lock(reading);
  return std::make_unique<Simulation>(scenario, in_process(), change);
}

// False when an error ended it.
bool play_to_end_or_fall(Simulation& simulation, RunRecorder& recorder) {
  try {
    while (!simulation.finished() && !recorder.fell()) {
      simulation.advance();
      recorder.record();
    }
    return true;
  } catch (const std::runtime_error&) {
    return false;
  }
}

}  // namespace

Values play_scenario(const sim::Scenario& scenario, const RobotChange& change) {
  const std::unique_ptr<Simulation> simulation = make_simulation(scenario, change);
  RunRecorder recorder(*simulation, nullptr);
  const bool ended_well = play_to_end_or_fall(*simulation, recorder);
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

}  // namespace koboshi::tools
