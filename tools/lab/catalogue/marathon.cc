#include "tools/lab/catalogue/marathon.h"

#include <fmt/core.h>

#include <cmath>
#include <memory>

#include "sim_board/input/text.h"
#include "sim_board/random/random_stream.h"
#include "sim_board/robot/load.h"
#include "tools/lab/trial/fall_observer.h"
#include "tools/lab/trial/scenario_trial.h"

namespace koboshi::tools {
namespace {

// The last push comes so long before the end that the robot can be on its feet again.
constexpr double kQuietEnd_s = 60.0;
constexpr double kShortestCommand_s = 2.0;
constexpr double kLongestCommand_s = 10.0;

// Walks, turns and stops; a robot that lies refuses them.
void add_commands(sim::Scenario& scenario, std::uint64_t from_us, std::uint64_t until_us,
                  std::uint64_t seed) {
  sim::RandomStream random(seed, "commands of a marathon");
  std::uint64_t at_us = from_us;
  while (at_us < until_us) {
    sim::Command command{.at_us = at_us, .kind = sim::Command::Kind::kStop};
    if (random.uniform() < 0.85) {
      command.kind = sim::Command::Kind::kWalk;
      const double ahead = between(random, -0.15, 0.25);
      const double left = between(random, -0.06, 0.06);
      command.velocity = {ahead, left, between(random, -0.6, 0.6)};
    }
    scenario.commands.push_back(command);
    at_us += to_us(between(random, kShortestCommand_s, kLongestCommand_s));
  }
  scenario.commands.push_back({.at_us = until_us, .kind = sim::Command::Kind::kStop});
}

Values play(const StandingStart& start, const sim::RobotDescription& robot, const MarathonOptions& options,
            std::uint64_t seed) {
  const double duration_s = 3600.0 * options.hours;
  sim::Scenario scenario = start.standing(duration_s);
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
  const Values played = watch_in_world(
      std::move(scenario), kRoughWorld, seed,
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
  const bool ended_well = played.at("failed") == 0.0 && played.at("energy_guard") == 0.0;
  Values values{
      {"down", stands && ended_well ? 0.0 : 1.0},
      {"falls", observer.falls()},
      {"attempts", observer.attempts()},
      {"stand_ups", observer.stands()},
      {"faults", played.at("faults")},
      {"distance_m", distance_m},
      {"time_s", end_s},
      {"peak_winding_C", observer.peak_winding_C()},
      {"gave_up", state == behaviour::State::kFault || state == behaviour::State::kEmergencyStop ? 1.0 : 0.0},
      {"low_supply", state == behaviour::State::kLowBattery ? 1.0 : 0.0},
      {"energy_guard", played.at("energy_guard")},
      {"failed", played.at("failed")}};
  values.error = played.error;
  return values;
}

}  // namespace

Experiment make_marathon(const MarathonOptions& options) {
  const auto start =
      std::make_shared<StandingStart>(read_standing_start(options.scenario, options.overrides));
  const auto robot = std::make_shared<sim::RobotDescription>(sim::load_robot(start->scenario.robot));
  Experiment experiment =
      begin_experiment("marathon", options, start->scenario,
                       {{"hours", sim::number_text(options.hours)},
                        {"highest_N_s_per_kg", sim::number_text(options.highest_N_s_per_kg)}});
  using enum Measure::Kind;
  experiment.measures = {{.name = "down", .kind = kEvent, .label = "does not stand at the end"},
                         {.name = "falls", .label = "falls", .decimals = 1},
                         {.name = "attempts", .label = "attempts to get up", .decimals = 1},
                         {.name = "stand_ups", .label = "got up", .decimals = 1},
                         {.name = "faults", .label = "faults", .decimals = 1},
                         {.name = "distance_m", .label = "way [m]", .decimals = 0},
                         {.name = "time_s", .label = "time [s]", .decimals = 0},
                         {.name = "peak_winding_C", .label = "hottest winding [C]", .decimals = 1},
                         {.name = "gave_up", .kind = kEvent, .label = "given up"},
                         {.name = "low_supply", .kind = kEvent, .label = "low supply"},
                         {.name = "energy_guard", .kind = kEvent, .label = "energy guard"},
                         {.name = "failed", .kind = kEvent}};
  experiment.cells = {{"marathon", {{"robot", start->scenario.robot.stem().string()}}}};
  experiment.play = [options, start, robot](std::size_t, std::uint64_t seed) {
    return play(*start, *robot, options, seed);
  };
  return experiment;
}

Conclusions marathon_conclusions(const Experiment& experiment, const ExperimentResult& result) {
  const CellResult& cell = result.cells.front();
  const ShareEstimate down = share_of(cell, experiment.measures.front());
  Conclusions conclusions;
  conclusions.values["stands_at_the_end"] = down.count - down.events;
  conclusions.values["seeds"] = down.count;
  for (const Measure& measure : experiment.measures) {
    if (measure.kind == Measure::Kind::kEvent) continue;
    double sum = 0.0;
    for (const double value : values_of(cell, measure)) sum += value;
    conclusions.values[measure.name + "_total"] = sum;
  }
  conclusions.lines = fmt::format("stands at the end in {} of {}\n", down.count - down.events, down.count);
  return conclusions;
}

}  // namespace koboshi::tools
