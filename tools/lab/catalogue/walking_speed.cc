#include "tools/lab/catalogue/walking_speed.h"

#include <cmath>
#include <memory>

#include "sim_board/input/text.h"
#include "tools/lab/trial/outcome.h"
#include "tools/lab/trial/scenario_trial.h"

namespace koboshi::tools {
namespace {

using Direction = SpeedLadder::Direction;

// Who takes longer than so many times what the command promises does not sustain it.
constexpr double kWalkPatience = 4.0;

constexpr const char* kFailure = "not_sustained";

std::vector<Measure> walk_measures() {
  using enum Measure::Kind;
  std::vector<Measure> measures{
      {.name = kFailure, .kind = kEvent, .label = "not sustained", .most_share = kMostFailures}};
  const std::vector<Measure> outcomes = outcome_measures();
  measures.insert(measures.end(), outcomes.begin(), outcomes.end());
  measures.insert(measures.end(), {{.name = "speed_m_per_s", .label = "speed [m/s]"},
                                   {.name = "turn_rad_per_s", .label = "turn [rad/s]"},
                                   {.name = "drift_m", .label = "drift [m]", .decimals = 2},
                                   {.name = "energy_J_per_m", .label = "energy [J/m]", .decimals = 0},
                                   {.name = "energy_J_per_rad", .label = "energy [J/rad]", .decimals = 1},
                                   {.name = "heading_off_deg", .label = "heading off [deg]", .decimals = 1}});
  return measures;
}

// +1 or -1 of what may go either way.
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

// What has been made good in the direction of a velocity: m or rad.
double made_good(const Eigen::Vector3d& velocity, const Eigen::Vector3d& way) {
  return way.dot(velocity.normalized());
}

struct SpeedTrial {
  Direction direction;
  double command;
  double way;  // m or rad
};

Values play(const SpeedTrial& trial, const StandingStart& start, std::uint64_t seed) {
  const double sign = sign_of(trial.direction, seed);
  const Eigen::Vector3d velocity = velocity_of(trial.direction, sign * trial.command);
  const double patience_s = kWalkPatience * trial.way / trial.command;
  const Values values = play_in_world(start.walking(velocity, patience_s), kRoughWorld, seed,
                                      [&](const simulation::RunRecorder& recorder) {
                                        return made_good(velocity, recorder.walk().made_good()) >= trial.way;
                                      });
  const double time_s = values.at("duration_s") - 1e-6 * static_cast<double>(start.ready_us);
  return judge_walk(trial.direction, trial.way, sign, time_s, values);
}

}  // namespace

const std::vector<std::string>& SpeedLadder::names() {
  static const std::vector<std::string> kNames{"forward", "backward", "sideways", "turn"};
  return kNames;
}

Values judge_walk(Direction direction, double way, double sign, double time_s,
                  const Values& scenario_values) {
  Values judged;
  add_outcome(scenario_values, judged);
  judged[kFailure] = 1.0;
  if (judged[kLost] != 0.0 || !scenario_values.contains("distance_m")) return judged;
  const Eigen::Vector3d made(scenario_values.at("distance_m"), scenario_values.at("lateral_drift_m"),
                             scenario_values.at("heading_drift_rad"));
  const Eigen::Vector3d ahead = velocity_of(direction, sign);
  const double made_way = made_good(ahead, made);
  // What the last cycle brought may have gone to summary and predicate rounded in different ways.
  if (made_way < (1.0 - 1e-9) * way) return judged;
  const bool turns = direction == Direction::kTurn;
  judged[kFailure] = 0.0;
  judged[turns ? "turn_rad_per_s" : "speed_m_per_s"] = made_way / time_s;
  judged["drift_m"] =
      turns ? made.head<2>().norm() : std::abs(made.head<2>().dot(ahead.head<2>().unitOrthogonal()));
  judged[turns ? "energy_J_per_rad" : "energy_J_per_m"] = scenario_values.at("energy_J") / made_way;
  if (!turns) judged["heading_off_deg"] = std::abs(made.z()) * 360.0 / kTurn_rad;
  return judged;
}

WalkingSpeed make_walking_speed(const WalkingSpeedOptions& options) {
  // What the robot is known to sustain is its limit; what more it may is the question.
  std::vector<sim::Override> overrides{{"parameters.highest_velocity_forward_mm_per_s", "2000"},
                                       {"parameters.highest_velocity_backward_mm_per_s", "2000"},
                                       {"parameters.highest_velocity_lateral_mm_per_s", "2000"},
                                       {"parameters.highest_turn_mrad_per_s", "6000"}};
  overrides.insert(overrides.end(), options.overrides.begin(), options.overrides.end());
  const auto start = std::make_shared<const StandingStart>(read_standing_start(options.scenario, overrides));
  auto trials = std::make_shared<std::vector<SpeedTrial>>();
  WalkingSpeed speed;
  speed.experiment = begin_experiment(
      "walking-speed", options, start->scenario,
      {{"way_m", sim::number_text(options.way_m)}, {"turns", sim::number_text(options.turns)}});
  speed.experiment.measures = walk_measures();
  for (const SpeedLadder& ladder : options.ladders) {
    const std::string& name = SpeedLadder::names().at(static_cast<std::size_t>(ladder.direction));
    const double way = ladder.direction == Direction::kTurn ? kTurn_rad * options.turns : options.way_m;
    speed.ladders.push_back(
        {.name = name, .unit = ladder.direction == Direction::kTurn ? "rad/s" : "m/s", .cells = {}});
    for (const double command : ladder.commands) {
      speed.ladders.back().cells.push_back(trials->size());
      trials->push_back({ladder.direction, command, way});
      const std::string text = sim::number_text(command);
      speed.experiment.cells.push_back({name + "-" + text, {{"direction", name}, {"command", text}}});
    }
  }
  speed.experiment.play = [start, trials](std::size_t cell, std::uint64_t seed) {
    return play(trials->at(cell), *start, seed);
  };
  return speed;
}

Conclusions walking_speed_conclusions(const WalkingSpeed& speed, const ClimbResult& result) {
  Conclusions conclusions;
  for (std::size_t i = 0; i < speed.ladders.size(); ++i) {
    const std::string& name = speed.ladders[i].name;
    const bool turns = name == SpeedLadder::names().back();
    const std::string key = name + (turns ? "_rad_per_s" : "_m_per_s");
    const Climb& climb = result.climbs[i];
    conclusions.lines += climb_line(speed.ladders[i], climb, result);
    conclusions.values[key] = 0.0;
    conclusions.values[name + "_ended_by"] = stop_name(climb.stop);
    if (!climb.highest) continue;
    const CellResult& highest = result.result.cells[*climb.highest];
    const MeanEstimate made = mean_of(highest, {.name = turns ? "turn_rad_per_s" : "speed_m_per_s"});
    conclusions.values[key] = made.mean;
    conclusions.values[key + "_confidence_95"] = {made.confidence_95.low, made.confidence_95.high};
    if (turns) continue;
    conclusions.values[name + "_heading_off_deg"] = mean_of(highest, {.name = "heading_off_deg"}).mean;
  }
  return conclusions;
}

}  // namespace koboshi::tools
