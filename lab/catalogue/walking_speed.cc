#include "lab/catalogue/walking_speed.h"

#include <algorithm>
#include <cmath>

#include "base/text/text.h"
#include "lab/experiment/ladder.h"
#include "lab/trial/landings.h"
#include "lab/trial/pushes.h"

namespace koboshi::lab {
namespace {

using Direction = SpeedLadder::Direction;

// A walk that takes longer than so many times the commanded distance over the command is not sustained.
constexpr double kWalkPatience = 4.0;
// Since the command; the robot has reached its speed then.
constexpr double kSteadyFrom_s = 2.0;

// +1, or -1 of a walk to the right.
double sign_of(Direction direction, std::uint64_t seed) {
  const bool either_way = direction == Direction::kSideways || direction == Direction::kTurn;
  return either_way && seed % 2 == 0 ? -1.0 : 1.0;
}

Eigen::Vector3d velocity_of(Direction direction, double command) {
  switch (direction) {
    case Direction::kForward:
      return {command, 0.0, 0.0};
    case Direction::kBackward:
      return {-command, 0.0, 0.0};
    case Direction::kSideways:
      return {0.0, command, 0.0};
    case Direction::kTurn:
      return {0.0, 0.0, command};
  }
  return Eigen::Vector3d::Zero();
}

// Returns the component of a displacement (forward, left, turn) along a velocity, in m or rad.
double progress(const Eigen::Vector3d& velocity, const Eigen::Vector3d& displacement) {
  return displacement.dot(velocity.normalized());
}

struct CommandedSpeed {
  Direction direction;
  double command;
  double distance;  // m or rad
};

// Where a walk was when its third second began.
struct UnderWay {
  double time_s = 0.0;  // since the command
  double progress = 0.0;
};

SpeedTrial play(const CommandedSpeed& speed, const StandingStart& start, std::uint64_t seed) {
  const double sign = sign_of(speed.direction, seed);
  const Eigen::Vector3d velocity = velocity_of(speed.direction, sign * speed.command);
  const double patience_s = kWalkPatience * speed.distance / speed.command;
  const double ready_s = 1e-6 * static_cast<double>(start.ready_us);
  std::optional<Landings> landings;
  std::optional<UnderWay> under_way;
  double made = 0.0;
  const Watch watch = [&](const simulation::Simulation& simulation, const simulation::RunRecorder& recorder) {
    const double time_s = 1e-6 * static_cast<double>(simulation.board().now_us()) - ready_s;
    if (!landings) landings.emplace(simulation.robot());
    if (time_s >= 0.0) landings->observe(simulation);
    made = progress(velocity, recorder.walk().displacement());
    if (!under_way && time_s >= kSteadyFrom_s) under_way = UnderWay{time_s, made};
    return recorder.fell() || made >= speed.distance;
  };
  const ScenarioTrial walk = watch_in_world(start.walking(velocity, patience_s), seed, watch);
  const double time_s = walk.duration_s - ready_s;
  SpeedTrial judged = judge_walk(speed.direction, speed.distance, sign, time_s, walk);
  if (judged.not_sustained) return judged;
  judged.landing_weights = landings->peak(0.95);
  if (under_way && time_s > under_way->time_s)
    judged.steady_percent =
        100.0 * (made - under_way->progress) / (time_s - under_way->time_s) / speed.command;
  return judged;
}

}  // namespace

const std::vector<std::string>& SpeedLadder::names() {
  static const std::vector<std::string> kNames{"forward", "backward", "sideways", "turn"};
  return kNames;
}

SpeedTrial judge_walk(Direction direction, double distance, double sign, double time_s,
                      const ScenarioTrial& walk) {
  SpeedTrial judged{.outcome = walk.outcome, .error = walk.error};
  if (walk.lost() || !walk.walked()) return judged;
  const Eigen::Vector3d made(walk.walk.distance_m, walk.walk.lateral_drift_m, walk.walk.heading_drift_rad);
  const Eigen::Vector3d along = velocity_of(direction, sign);
  const double made_distance = progress(along, made);
  // The last cycle may have been rounded in different ways in the summary and in the predicate.
  if (made_distance < (1.0 - 1e-9) * distance) return judged;
  judged.not_sustained = false;
  if (direction == Direction::kTurn) {
    judged.turn_rad_per_s = made_distance / time_s;
    judged.drift_m = made.head<2>().norm();
    judged.energy_J_per_rad = walk.walk.energy_J / made_distance;
  } else {
    judged.speed_m_per_s = made_distance / time_s;
    judged.drift_m = std::abs(made.head<2>().dot(along.head<2>().unitOrthogonal()));
    judged.energy_J_per_m = walk.walk.energy_J / made_distance;
    judged.heading_off_deg = std::abs(made.z()) * 360.0 / kTurn_rad;
  }
  return judged;
}

const FieldTable<SpeedTrial>& speed_fields() {
  using T = SpeedTrial;
  static const FieldTable<T> kFields{
      Fields<T>{{{.name = "not_sustained", .label = "not sustained", .max_share = kMaxFailureShare},
                 &T::not_sustained}},
      outcome_fields<T>(&T::outcome),
      Fields<T>{{{"speed_m_per_s", "speed [m/s]"}, &T::speed_m_per_s},
                {{"turn_rad_per_s", "turn [rad/s]"}, &T::turn_rad_per_s},
                {{"steady_percent", "steady speed [% of the command]", 1}, &T::steady_percent},
                {{"landing_weights", "landing [weights]", 2}, &T::landing_weights},
                {{"drift_m", "drift [m]", 2}, &T::drift_m},
                {{"energy_J_per_m", "energy [J/m]", 0}, &T::energy_J_per_m},
                {{"energy_J_per_rad", "energy [J/rad]", 1}, &T::energy_J_per_rad},
                {{"heading_off_deg", "heading off [deg]", 1}, &T::heading_off_deg}}};
  return kFields;
}

Experiment make_walking_speed(const WalkingSpeedOptions& options) {
  // The limits are what the robot is known to sustain; the experiment asks what more it may.
  std::vector<Override> overrides{{"parameters.highest_velocity_forward_mm_per_s", "2000"},
                                  {"parameters.highest_velocity_backward_mm_per_s", "2000"},
                                  {"parameters.highest_velocity_lateral_mm_per_s", "2000"},
                                  {"parameters.highest_turn_mrad_per_s", "6000"}};
  overrides.insert(overrides.end(), options.overrides.begin(), options.overrides.end());
  const StandingStart start = read_standing_start(options, overrides);
  Experiment experiment = begin_experiment("walking-speed", "How fast it walks", options, start.scenario,
                                           {{"distance_m", options.distance_m}, {"turns", options.turns}});
  std::vector<CommandedSpeed> speeds;
  for (SpeedLadder commanded : options.ladders) {
    const bool turns = commanded.direction == Direction::kTurn;
    const std::string& name = SpeedLadder::names().at(static_cast<std::size_t>(commanded.direction));
    if (std::ranges::find(options.only, name) == options.only.end()) continue;
    std::ranges::sort(commanded.commands);
    Ladder& ladder =
        experiment.ladders.emplace_back(Ladder{.name = name, .unit = turns ? "rad/s" : "m/s", .cells = {}});
    for (const double command : commanded.commands) {
      ladder.cells.push_back(speeds.size());
      speeds.push_back(
          {commanded.direction, command, turns ? kTurn_rad * options.turns : options.distance_m});
      const std::string text = number_text(command);
      experiment.cells.push_back({name + "-" + text, {{"direction", name}, {"command", text}}});
    }
  }
  set_trials(experiment, speed_fields(), [start, speeds](std::size_t cell, std::uint64_t seed) {
    return play(speeds[cell], start, seed);
  });
  experiment.conclude = walking_speed_conclusions;
  return experiment;
}

Conclusions walking_speed_conclusions(const Experiment& experiment, const ExperimentResult& result) {
  Conclusions conclusions;
  for (const Ladder& ladder : experiment.ladders) {
    const std::string& name = ladder.name;
    const bool turns = name == SpeedLadder::names().back();
    const std::string key = name + (turns ? "_rad_per_s" : "_m_per_s");
    const Climb climb = climb_of(ladder, result);
    conclusions.lines += climb_line(experiment, ladder, climb);
    conclusions.values[key] = 0.0;
    conclusions.values[name + "_ended_by"] = stop_name(climb.stop);
    if (!climb.highest) continue;
    const std::vector<SpeedTrial> trials = speed_fields().trials(result.cells[*climb.highest]);
    const MeanEstimate made =
        mean_of(trials, turns ? &SpeedTrial::turn_rad_per_s : &SpeedTrial::speed_m_per_s);
    conclusions.values[key] = made.mean;
    conclusions.values[key + "_confidence_95"] = {made.confidence_95.low, made.confidence_95.high};
    if (turns) continue;
    conclusions.values[name + "_heading_off_deg"] = mean_of(trials, &SpeedTrial::heading_off_deg).mean;
  }
  conclusions.figure = ladder_figure("Walking speed: what is not sustained", experiment, result);
  return conclusions;
}

}  // namespace koboshi::lab
