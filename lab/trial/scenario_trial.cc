#include "lab/trial/scenario_trial.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <utility>

#include "lab/trial/trial_recordings.h"
#include "simulation/assembly/world.h"
#include "view/capture/run_recording.h"

namespace koboshi::lab {
namespace {

// The firmware's reason for having stopped, worst first.
void follow_state(const simulation::Telemetry& telemetry, Outcome& outcome) {
  using behaviour::State;
  const State state = telemetry.state;
  if (state == State::kLowBattery || telemetry.reason == behaviour::Reason::kSupplyLow) {
    outcome = Outcome::kLowSupply;
  } else if (state == State::kFalling || state == State::kFault || state == State::kEmergencyStop) {
    outcome = std::min(outcome, Outcome::kGaveUp);
  }
}

ScenarioTrial watch_simulation(std::unique_ptr<simulation::Simulation> simulation, const Watch& is_over) {
  std::optional<view::RunRecording> recording;
  if (TrialRecordings* recordings = TrialRecordings::of_this_thread())
    recording.emplace(recordings->next_file(), *simulation, view::RunRecording::Options{});
  using Rows = simulation::RunRecorder::Rows;
  simulation::RunRecorder recorder(*simulation, nullptr, recording ? &*recording : nullptr,
                                   recording ? Rows::kAlways : Rows::kForFiles);
  ScenarioTrial trial;
  try {
    while (!simulation->finished() && !is_over(*simulation, recorder)) {
      simulation->advance();
      recorder.record();
      if (recording) recording->record(recorder);
      follow_state(recorder.telemetry(), trial.outcome);
    }
    if (recorder.fell()) trial.outcome = Outcome::kFell;
  } catch (const WriteError&) {
    throw;
  } catch (const sim_board::WorldBlewUp& error) {
    trial.outcome = Outcome::kEnergyGuard;
    trial.error = error.what();
  } catch (const std::runtime_error& error) {
    trial.outcome = Outcome::kFailed;
    trial.error = error.what();
  }
  const simulation::RunSummary summary = recorder.summary();
  if (recording) recording->close(summary.events);
  trial.duration_s = summary.duration_s;
  trial.faults = summary.faults;
  trial.foot_slip_max_m = summary.foot_slip_max_m;
  if (summary.walk) trial.walk = *summary.walk;
  return trial;
}

ScenarioTrial watch_scenario(const simulation::Scenario& scenario, const simulation::RobotChange& change,
                             const Watch& is_over) {
  return watch_simulation(
      std::make_unique<simulation::Simulation>(scenario, simulation::in_process(), change), is_over);
}

}  // namespace

simulation::WalkSummary no_walk() {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  return {kNaN, kNaN, kNaN, kNaN, kNaN, kNaN, kNaN, kNaN, kNaN, kNaN, kNaN};
}

bool ScenarioTrial::walked() const { return !std::isnan(walk.distance_m); }

Outcome outcome_at_end(const ScenarioTrial& trial, behaviour::State state) {
  if (!trial.error.empty()) return trial.outcome;
  // A robot that sits limp has stopped for its supply earlier.
  const bool sits = state == behaviour::State::kLimp && trial.outcome == Outcome::kLowSupply;
  if (state == behaviour::State::kLowBattery || state == behaviour::State::kSittingDown || sits)
    return Outcome::kLowSupply;
  const bool faulted = state == behaviour::State::kFault || state == behaviour::State::kEmergencyStop;
  return faulted ? Outcome::kGaveUp : Outcome::kSurvived;
}

ScenarioTrial play_scenario(const simulation::Scenario& scenario, const simulation::RobotChange& change,
                            const IsOver& is_over) {
  return watch_scenario(scenario, change,
                        [&](const simulation::Simulation&, const simulation::RunRecorder& recorder) {
                          return recorder.fell() || (is_over && is_over(recorder));
                        });
}

ScenarioTrial watch_in_world(simulation::Scenario scenario, std::uint64_t seed, const Watch& is_over) {
  scenario.seed = seed;
  return watch_scenario(scenario, {}, is_over);
}

ScenarioTrial watch_prepared(std::shared_ptr<const simulation::PreparedScenario> prepared, std::uint64_t seed,
                             const simulation::HostFactory& make_host, const Watch& is_over) {
  return watch_simulation(std::make_unique<simulation::Simulation>(std::move(prepared), seed, make_host),
                          is_over);
}

ScenarioTrial play_in_world(simulation::Scenario scenario, std::uint64_t seed, const IsOver& is_over) {
  scenario.seed = seed;
  return play_scenario(scenario, {}, is_over);
}

sim_board::RobotDescription robot_in_world(const simulation::Scenario& scenario,
                                           const sim_board::RobotDescription& robot, std::uint64_t seed) {
  sim_board::RobotDescription in_world = robot;
  simulation::Scenario seeded = scenario;
  seeded.seed = seed;
  if (const auto world = simulation::draw_world(seeded, robot)) simulation::apply(*world, in_world);
  return in_world;
}

}  // namespace koboshi::lab
