#include "lab/catalogue/marathon.h"

#include <fmt/core.h>

#include <cmath>
#include <numeric>
#include <optional>

#include "lab/experiment/report.h"
#include "lab/trial/pushes.h"
#include "lab/trial/scenario_trial.h"
#include "sim_board/description/load.h"
#include "sim_board/random/random_stream.h"

namespace koboshi::lab {
namespace {

// The last push comes so long before the end that the robot can be on its feet again.
constexpr double kQuietEnd_s = 60.0;
constexpr double kShortestCommand_s = 2.0;
constexpr double kMaxCommand_s = 10.0;

// Walks, turns and stops; a robot that lies refuses them.
void add_commands(simulation::Scenario& scenario, std::uint64_t from_us, std::uint64_t until_us,
                  std::uint64_t seed) {
  sim_board::RandomStream random(seed, "commands of a marathon");
  std::uint64_t at_us = from_us;
  while (at_us < until_us) {
    simulation::Command command{.at_us = at_us, .kind = simulation::Command::Kind::kStop};
    if (random.uniform() < 0.85) {
      command.kind = simulation::Command::Kind::kWalk;
      const double forward = between(random, -0.15, 0.25);
      const double left = between(random, -0.06, 0.06);
      command.velocity = {forward, left, between(random, -0.6, 0.6)};
    }
    scenario.commands.push_back(command);
    at_us += to_us(between(random, kShortestCommand_s, kMaxCommand_s));
  }
  scenario.commands.push_back({.at_us = until_us, .kind = simulation::Command::Kind::kStop});
}

MarathonTrial play(const StandingStart& start, const sim_board::RobotDescription& robot,
                   const MarathonOptions& options, std::uint64_t seed) {
  const double duration_s = 3600.0 * options.hours;
  simulation::Scenario scenario = start.standing(duration_s);
  const std::uint64_t end_us = scenario.duration_us;
  const std::uint64_t quiet_us = end_us > to_us(kQuietEnd_s) ? end_us - to_us(kQuietEnd_s) : start.ready_us;
  add_commands(scenario, start.ready_us, quiet_us, seed);
  scenario.duration_us = quiet_us;
  const double highest_N_s = options.highest_N_s_per_kg * robot.total_mass_kg();
  add_pushes(
      scenario, robot.links.front().name, start.ready_us,
      {.first_s = 5.0, .shortest_s = 5.0, .longest_s = 30.0, .highest_N_s = highest_N_s, .duration_s = 0.1},
      seed);
  scenario.duration_us = end_us;

  FallObserver observer;
  double distance_m = 0.0;
  std::optional<Eigen::Vector2d> was_W;
  behaviour::State state = behaviour::State::kBoot;
  double end_s = 0.0;
  const ScenarioTrial played = watch_in_world(
      std::move(scenario), seed,
      [&](const simulation::Simulation& simulation, const simulation::RunRecorder& recorder) {
        observer.observe(simulation, recorder);
        state = recorder.telemetry().state;
        end_s = simulation.board().world().time_s();
        // By the tenth of a second, so that swaying is no distance.
        if (simulation.board().now_us() % 100'000 == 0) {
          const Eigen::Vector2d now_W = simulation.board().world().body(0).X_WL.translation().head<2>();
          if (was_W && state == behaviour::State::kWalking) distance_m += (now_W - *was_W).norm();
          was_W = now_W;
        }
        return state == behaviour::State::kFault || state == behaviour::State::kEmergencyStop;
      });
  const bool stands =
      state == behaviour::State::kStanding && end_s >= 1e-6 * static_cast<double>(end_us) - 0.01;
  return {.outcome = outcome_at_end(played, state),
          .error = played.error,
          .down = !stands || !played.error.empty(),
          .faults = played.faults,
          .distance_m = distance_m,
          .time_s = end_s,
          .history = observer.history()};
}

Conclusions conclude(const Experiment& experiment, const CellResult& cell) {
  const ShareEstimate down = share_of(marathon_fields().trials(cell), &MarathonTrial::down);
  Conclusions conclusions;
  conclusions.values["stands_at_the_end"] = down.count - down.events;
  conclusions.values["seeds"] = down.count;
  for (std::size_t i = 0; i < experiment.metrics.size(); ++i) {
    if (experiment.metrics[i].is_event) continue;
    const std::vector<double> values = values_of(cell, i);
    conclusions.values[experiment.metrics[i].name + "_total"] =
        std::accumulate(values.begin(), values.end(), 0.0);
  }
  conclusions.lines = fmt::format("stands at the end in {} of {}\n", down.count - down.events, down.count);
  return conclusions;
}

}  // namespace

const FieldTable<MarathonTrial>& marathon_fields() {
  using T = MarathonTrial;
  static const FieldTable<T> kFields{
      Fields<T>{{{.name = "down", .label = "does not stand at the end", .is_loss = true}, &T::down},
                {{"falls", "falls", 1}, &T::history, &FallHistory::falls},
                {{"attempts", "attempts to get up", 1}, &T::history, &FallHistory::attempts},
                {{"stand_ups", "got up", 1}, &T::history, &FallHistory::stands},
                {{"faults", "faults", 1}, &T::faults},
                {{"distance_m", "way [m]", 0}, &T::distance_m},
                {{"time_s", "time [s]", 0}, &T::time_s},
                {{"peak_winding_C", "hottest winding [C]", 1}, &T::history, &FallHistory::peak_winding_C}},
      outcome_fields<T>(&T::outcome, kLossesButFalls)};
  return kFields;
}

Experiment make_marathon(const MarathonOptions& options) {
  const StandingStart start = read_standing_start(options, options.overrides);
  Experiment experiment =
      begin_experiment("marathon", "A marathon", options, start.scenario,
                       {{"hours", options.hours}, {"highest_N_s_per_kg", options.highest_N_s_per_kg}});
  experiment.cells = {{"marathon", {{"robot", start.scenario.robot.stem().string()}}}};
  set_trials(experiment, marathon_fields(),
             [options, start, robot = sim_board::load_robot(start.scenario.robot)](
                 std::size_t, std::uint64_t seed) { return play(start, robot, options, seed); });
  experiment.conclude = [](const Experiment& played, const ExperimentResult& result) {
    return conclude(played, result.cells.front());
  };
  return experiment;
}

}  // namespace koboshi::lab
