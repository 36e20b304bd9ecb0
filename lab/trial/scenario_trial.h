#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "lab/trial/outcome.h"
#include "simulation/assembly/simulation.h"
#include "simulation/observe/run_recorder.h"
#include "simulation/record/summary.h"
#include "simulation/scenario/scenario.h"

namespace koboshi::lab {

// A walk of which nothing was measured: every figure is NaN.
[[nodiscard]] simulation::WalkSummary no_walk();

// A scenario that was played to its end.
struct ScenarioTrial {
  Outcome outcome = Outcome::kSurvived;
  std::string error{};
  double duration_s = 0.0;
  std::uint64_t faults = 0;
  double foot_slip_max_m = 0.0;
  simulation::WalkSummary walk = no_walk();

  bool lost() const { return outcome != Outcome::kSurvived; }
  bool walked() const;
};

// The outcome of a trial in which the robot may fall and get up again: lost if it ended by an error, or with
// the firmware in this state.
[[nodiscard]] Outcome outcome_at_end(const ScenarioTrial& trial, behaviour::State state);

// Asked after each millisecond whether the trial is over.
using IsOver = std::function<bool(const simulation::RunRecorder&)>;
// The same for observers that look at more than is recorded.
using Watch = std::function<bool(simulation::Simulation&, const simulation::RunRecorder&)>;

// Plays a scenario in this process, without leaving files, until it ends, is over or the robot has fallen.
// May be called from several threads at a time. Throws InputError.
[[nodiscard]] ScenarioTrial play_scenario(const simulation::Scenario& scenario,
                                          const simulation::RobotChange& change, const IsOver& is_over = {});

// The same with another seed, which also draws the scenario's world.
[[nodiscard]] ScenarioTrial play_in_world(simulation::Scenario scenario, std::uint64_t seed,
                                          const IsOver& is_over = {});

// The same, but a fall does not end the trial.
[[nodiscard]] ScenarioTrial watch_in_world(simulation::Scenario scenario, std::uint64_t seed,
                                           const Watch& is_over);

// The same with files that are already read and compiled, and with a host of the caller's, which may look
// into the firmware. A fall does not end the trial.
[[nodiscard]] ScenarioTrial watch_prepared(std::shared_ptr<const simulation::PreparedScenario> prepared,
                                           std::uint64_t seed, const simulation::HostFactory& make_host,
                                           const Watch& is_over);

// The robot in the world that a seed draws for this scenario.
[[nodiscard]] sim_board::RobotDescription robot_in_world(const simulation::Scenario& scenario,
                                                         const sim_board::RobotDescription& robot,
                                                         std::uint64_t seed);

}  // namespace koboshi::lab
