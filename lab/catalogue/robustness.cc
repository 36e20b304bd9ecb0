#include "lab/catalogue/robustness.h"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <iterator>
#include <optional>
#include <utility>

#include "base/text/error.h"
#include "base/text/text.h"
#include "base/text/user_units.h"
#include "lab/catalogue/stand_up.h"
#include "lab/experiment/ladder.h"
#include "lab/trial/pushes.h"
#include "lab/trial/scenario_trial.h"
#include "sim_board/random/random_stream.h"
#include "simulation/assembly/parameters.h"
#include "simulation/disturbance/disturbed_world.h"
#include "simulation/scenario/reader.h"

namespace koboshi::lab {
namespace {

using simulation::WorldRanges;

constexpr double kQuietBefore_s = 1.0;   // before a push, standing
constexpr double kStrideBefore_s = 2.5;  // and walking, at least
constexpr double kFallTime_s = 3.0;      // a robot that is going to fall lies after one second
constexpr double kArrivalPatience = 2.0;
constexpr std::uint64_t kDirections = 16;

// The impulses that a robot is pushed with while another factor is raised: five sixths of those of which the
// default robot survives 99 of 100 in `rough` worlds, 0.44 standing and 0.30 N s/kg walking on the spot
// (docs/experiment/closed-loop-walk.md).
constexpr double kPushStanding_N_s_per_kg = 0.36;
constexpr double kPushWalking_N_s_per_kg = 0.25;

struct Activity {
  enum class Kind { kWalk, kPush, kStandUp };
  std::string name;
  Kind kind = Kind::kWalk;
  bool walks = true;
  double speed_share = 0.0;  // of the full speed
  double impulse_N_s_per_kg = 0.0;
};

const std::vector<Activity>& known_activities() {
  using Kind = Activity::Kind;
  static const std::vector<Activity> kActivities{
      {"walk-half", Kind::kWalk, true, 0.5, 0.0},
      {"walk-full", Kind::kWalk, true, 1.0, 0.0},
      {"push-standing", Kind::kPush, false, 0.0, kPushStanding_N_s_per_kg},
      {"push-on-the-spot", Kind::kPush, true, 0.0, kPushWalking_N_s_per_kg},
      {"push-half", Kind::kPush, true, 0.5, kPushWalking_N_s_per_kg},
      {"push-full", Kind::kPush, true, 1.0, kPushWalking_N_s_per_kg},
      {"stand-up", Kind::kStandUp, false, 0.0, 0.0}};
  return kActivities;
}

// A factor of the worlds, and how a level sets it. The levels become harder.
struct Factor {
  std::string name;
  std::string unit;
  std::vector<double> levels;
  std::function<void(WorldRanges&, double level)> set;
};

simulation::Range one_value(double value) { return {value, value}; }

constexpr const char* kImpulse = "impulse";
constexpr const char* kNone = "none";

const std::vector<Factor>& known_factors() {
  static const std::vector<Factor> kFactors{
      {kNone, "", {0}, [](WorldRanges&, double) {}},
      {kImpulse,
       "N s/kg",
       {0.1, 0.15, 0.2, 0.25, 0.3, 0.36, 0.44, 0.52, 0.6, 0.7},
       [](WorldRanges&, double) {}},
      {"com",
       "mm",
       {5, 10, 15, 20, 30},
       [](WorldRanges& world, double level) { world.com_m = simulation::symmetric(1e-3 * level); }},
      {"masses",
       "%",
       {10, 15, 25, 40},
       [](WorldRanges& world, double level) { world.mass_factor = simulation::around_one(0.01 * level); }},
      {"servo-gain",
       "divided by",
       {1.5, 2, 2.5, 3, 4},
       [](WorldRanges& world, double level) { world.servo_gain_divisor = one_value(level); }},
      {"load-friction",
       "",
       {0.11, 0.22, 0.33, 0.45, 0.6},
       [](WorldRanges& world, double level) { world.load_friction = one_value(level); }},
      {"motor-constant-low",
       "% less",
       {5, 10, 20, 30},
       [](WorldRanges& world, double level) { world.motor_constant_factor = one_value(1.0 - 0.01 * level); }},
      {"motor-constant-high",
       "% more",
       {5, 10, 20, 30},
       [](WorldRanges& world, double level) { world.motor_constant_factor = one_value(1.0 + 0.01 * level); }},
      {"backlash",
       "mrad",
       {5, 12, 20, 30, 40},
       [](WorldRanges& world, double level) { world.backlash_rad = one_value(1e-3 * level); }},
      {"encoder-offset",
       "mrad",
       {5, 10, 20, 40},
       [](WorldRanges& world, double level) {
         world.encoder_offset_rad = simulation::symmetric(1e-3 * level);
       }},
      {"sensor-latency",
       "ms",
       {10, 20, 30, 40, 60},
       [](WorldRanges& world, double level) { world.sensor_latency_s = one_value(1e-3 * level); }},
      {"drive-latency",
       "ms",
       {5, 10, 15, 20, 30},
       [](WorldRanges& world, double level) { world.drive_latency_s = one_value(1e-3 * level); }},
      {"tick-jitter",
       "ms",
       {1, 2, 4, 8},
       [](WorldRanges& world, double level) { world.tick_jitter_s = one_value(1e-3 * level); }},
      {"slipperiness",
       "less than mu 1",
       {0.4, 0.6, 0.7, 0.8, 0.85, 0.9},
       [](WorldRanges& world, double level) { world.friction = one_value(1.0 - level); }},
      {"grip",
       "mu",
       {1.0, 1.2, 1.5, 2.0},
       [](WorldRanges& world, double level) { world.friction = one_value(level); }},
      {"slope",
       "deg",
       {1, 2, 2.5, 3, 4, 5, 7, 10},
       [](WorldRanges& world, double level) { world.tilt_rad = one_value(kRadPerDegree * level); }},
      {"supply-low",
       "% less",
       {5, 10, 15, 20, 25},
       [](WorldRanges& world, double level) { world.supply_factor = one_value(1.0 - 0.01 * level); }},
      {"supply-high",
       "% more",
       {10, 15, 25},
       [](WorldRanges& world, double level) { world.supply_factor = one_value(1.0 + 0.01 * level); }},
      {"gyro-noise",
       "deg/s/sqrt(Hz)",
       {0.0075, 0.01, 0.03, 0.1},
       [](WorldRanges& world, double level) { world.gyro_noise_density = kRadPerDegree * level; }},
      {"gyro-walk",
       "1e-5 rad/s/sqrt(s)",
       {2, 10, 50, 200},
       [](WorldRanges& world, double level) { world.gyro_random_walk = 1e-5 * level; }},
      {"weak-joint", "joints", {1}, [](WorldRanges& world, double) { world.weak_joint = true; }}};
  return kFactors;
}

template <typename Named>
std::vector<std::string> names_of(const std::vector<Named>& all) {
  std::vector<std::string> names;
  for (const Named& one : all) names.push_back(one.name);
  return names;
}

template <typename Named>
std::vector<Named> chosen(const std::vector<Named>& all, const std::vector<std::string>& names) {
  std::vector<Named> some;
  std::ranges::copy_if(all, std::back_inserter(some),
                       [&](const Named& one) { return std::ranges::find(names, one.name) != names.end(); });
  return some;
}

// A cell of the experiment.
struct RobustnessCase {
  Activity activity;
  Factor factor;
  double level = 0.0;
};

// The inputs that all trials have in common.
struct Course {
  StandingStart start;
  sim_board::RobotDescription robot;
  double full_speed_m_per_s = 0.0;
  double distance_m = 0.0;
  double cycle_s = 0.0;
  WorldRanges others;
};

Course course_of(const RobustnessOptions& options) {
  Course course;
  course.start = read_standing_start(options, options.overrides);
  const simulation::Scenario& scenario = course.start.scenario;
  course.robot = simulation::read_robot(scenario);
  const auto values = simulation::controller_values(scenario);
  require_permitted_speed("--full-speed", options.full_speed_m_per_s, scenario);
  course.full_speed_m_per_s = options.full_speed_m_per_s > 0.0
                                  ? options.full_speed_m_per_s
                                  : 1e-3 * values.velocity_limits.forward_mm_per_s;
  course.distance_m =
      options.distance_m * simulation::leg_length_m(course.robot) / simulation::kReferenceLeg_m;
  course.cycle_s = 2e-3 * values.walk.step.time_ms;
  const bool nominal = options.others == RobustnessOptions::kNominal;
  course.others = nominal ? WorldRanges{.ends_only = true} : simulation::world_named(options.others);
  return course;
}

RobustnessTrial judged(const ScenarioTrial& played, bool arrived) {
  return {.outcome = played.outcome,
          .error = played.error,
          .lost = played.lost() || !arrived,
          .not_arrived = !played.lost() && !arrived};
}

RobustnessTrial walk(const RobustnessCase& played, const Course& course, std::uint64_t seed) {
  const double speed_m_per_s = played.activity.speed_share * course.full_speed_m_per_s;
  const double patience_s = kArrivalPatience * course.distance_m / speed_m_per_s;
  bool arrived = false;
  const ScenarioTrial trial = play_in_world(course.start.walking({speed_m_per_s, 0.0, 0.0}, patience_s), seed,
                                            [&](const simulation::RunRecorder& recorder) {
                                              arrived =
                                                  recorder.walk().displacement().x() >= course.distance_m;
                                              return arrived;
                                            });
  return judged(trial, arrived);
}

RobustnessTrial push(const RobustnessCase& played, const Course& course, std::uint64_t seed) {
  sim_board::RandomStream random(seed, "phase of the push");
  const double phase_s = course.cycle_s * random.uniform();
  const double wait_s = played.activity.walks ? kStrideBefore_s + phase_s : kQuietBefore_s + phase_s;
  const double for_s = wait_s + kPush_s + kFallTime_s;
  const double speed_m_per_s = played.activity.speed_share * course.full_speed_m_per_s;
  simulation::Scenario scenario = played.activity.walks
                                      ? course.start.walking({speed_m_per_s, 0.0, 0.0}, for_s)
                                      : course.start.standing(for_s);
  const double mass_kg = robot_in_world(scenario, course.robot, seed).total_mass_kg();
  const double impulse_N_s_per_kg =
      played.factor.name == kImpulse ? played.level : played.activity.impulse_N_s_per_kg;
  const double towards_rad = kTurn_rad * static_cast<double>(seed % kDirections) / kDirections;
  scenario.pushes = {half_sine_push(
      course.robot.links.front().name, course.start.ready_us + to_us(wait_s), kPush_s,
      impulse_N_s_per_kg * mass_kg * Eigen::Vector3d(std::cos(towards_rad), std::sin(towards_rad), 0.0))};
  // A robot that has just been let go on a slope may step too.
  bool stepped = false;
  std::uint64_t time_us = 0;
  const std::uint64_t push_us = scenario.pushes.front().at_us;
  const ScenarioTrial trial = play_in_world(scenario, seed, [&](const simulation::RunRecorder& recorder) {
    time_us += 1'000;
    stepped = stepped || (time_us > push_us && recorder.telemetry().reason == behaviour::Reason::kPushed);
    return false;
  });
  RobustnessTrial judgement = judged(trial, true);
  judgement.stepped = stepped && !played.activity.walks;
  return judgement;
}

RobustnessTrial stand_up(const Course& course, std::uint64_t seed) {
  const StandUpTrial trial = play_stand_up(course.start.scenario, course.robot, {}, seed);
  const bool lost = trial.outcome != Outcome::kSurvived;
  return {.outcome = trial.outcome,
          .error = trial.error,
          .lost = lost || trial.down,
          .not_arrived = !lost && trial.down};
}

RobustnessTrial play(const RobustnessCase& played, Course course, std::uint64_t seed) {
  WorldRanges ranges = course.others;
  ranges.name = played.factor.name;
  played.factor.set(ranges, played.level);
  course.start.scenario.world = {ranges, std::nullopt};
  switch (played.activity.kind) {
    case Activity::Kind::kWalk:
      return walk(played, course, seed);
    case Activity::Kind::kPush:
      return push(played, course, seed);
    case Activity::Kind::kStandUp:
      return stand_up(course, seed);
  }
  return {};
}

std::vector<RobustnessCase> cases_of(const RobustnessOptions& options) {
  if (!options.levels.empty() && options.factors.size() != 1)
    throw InputError("--levels", 0, fmt::format("{} factors", options.factors.size()), "one in --factors");
  if (!std::ranges::is_sorted(options.levels))
    throw InputError("--levels", 0, fmt::format("{}", fmt::join(options.levels, ",")), "rising levels");
  std::vector<RobustnessCase> cases;
  for (const Activity& activity : chosen(known_activities(), options.activities)) {
    for (const Factor& factor : chosen(known_factors(), options.factors)) {
      if (factor.name == kImpulse && activity.kind != Activity::Kind::kPush) continue;
      for (const double level : options.levels.empty() ? factor.levels : options.levels)
        cases.push_back({activity, factor, level});
    }
  }
  return cases;
}

ShareEstimate robustness_lost(const CellResult& cell) {
  return share_of(robustness_fields().trials(cell), &RobustnessTrial::lost);
}

// The share that is lost without any factor is the first point of every curve.
tools::GridPanel panel_of(const Factor& factor, const std::vector<RobustnessCase>& cases,
                          const RobustnessOptions& options, const ExperimentResult& result) {
  tools::GridPanel panel{.title = factor.name,
                         .x_label = factor.unit,
                         .y_label = "lost [%]",
                         .y_span = tools::Span{-2.0, 102.0}};
  const std::vector<Activity> shown = chosen(known_activities(), options.activities);
  for (std::size_t i = 0; i < shown.size(); ++i) {
    tools::PlaneCurve curve{.label = shown[i].name,
                            .style = tools::LineStyle::kLinesPoints,
                            .colour = static_cast<int>(i),
                            .width = 1.4};
    for (std::size_t cell = 0; cell < cases.size(); ++cell) {
      if (cases[cell].activity.name != shown[i].name || cases[cell].factor.name != factor.name) continue;
      const ShareEstimate lost = robustness_lost(result.cells[cell]);
      if (lost.count > 0) curve.points.push_back({cases[cell].level, 100.0 * lost.share});
    }
    // gnuplot draws no curve without points, and the key is that of the first panel.
    if (curve.points.empty()) curve.points.push_back({std::nan(""), std::nan("")});
    panel.curves.push_back(std::move(curve));
  }
  return panel;
}

Conclusions conclude(const RobustnessOptions& options, const ExperimentResult& result) {
  const std::vector<RobustnessCase> cases = cases_of(options);
  Conclusions conclusions;
  tools::PanelGrid grid{.title = "Trials that are lost, by the level of one factor alone", .columns = 3};
  for (const Factor& factor : chosen(known_factors(), options.factors)) {
    if (factor.name != kNone) grid.panels.push_back(panel_of(factor, cases, options, result));
  }
  if (!grid.panels.empty()) conclusions.grids.push_back({"factors", std::move(grid)});
  nlohmann::ordered_json& lost = conclusions.values["lost"];
  for (std::size_t cell = 0; cell < cases.size(); ++cell) {
    const ShareEstimate share = robustness_lost(result.cells[cell]);
    if (share.count == 0) continue;
    lost[cases[cell].activity.name][cases[cell].factor.name][number_text(cases[cell].level)] = share.share;
  }
  return conclusions;
}

}  // namespace

const std::vector<std::string>& RobustnessOptions::all_activities() {
  static const std::vector<std::string> kNames = names_of(known_activities());
  return kNames;
}

const std::vector<std::string>& RobustnessOptions::all_factors() {
  static const std::vector<std::string> kNames = names_of(known_factors());
  return kNames;
}

FieldTable<RobustnessTrial> robustness_fields(double cliff_share) {
  using T = RobustnessTrial;
  static constexpr std::array<Loss, 5> kColumns{{{Outcome::kFell, "fell", "falls"},
                                                 {Outcome::kGaveUp, "gave_up", "given up"},
                                                 {Outcome::kLowSupply, "low_supply", "low supply"},
                                                 {Outcome::kEnergyGuard, "energy_guard", "energy guard"},
                                                 {Outcome::kFailed, "failed", "error"}}};
  return {Fields<T>{{{.name = "lost", .label = "lost", .max_share = cliff_share, .is_loss = true}, &T::lost}},
          outcome_fields<T>(&T::outcome, kColumns),
          Fields<T>{{{.name = "not_arrived", .label = "does not arrive, or stays down", .is_loss = true},
                     &T::not_arrived},
                    {{.name = "stepped", .label = "steps from standing", .is_event = true}, &T::stepped}}};
}

Experiment make_robustness(const RobustnessOptions& options) {
  const Course course = course_of(options);
  Experiment experiment = begin_experiment(
      "robustness", "What it withstands", options, course.start.scenario,
      {{"full_speed_m_per_s", course.full_speed_m_per_s}, {"distance_m", course.distance_m}});
  // The factors replace the world, and a level may be tried without the others.
  for (auto& [name, value] : experiment.conditions) {
    if (name == "world") value = options.others;
  }
  const std::vector<RobustnessCase> cases = cases_of(options);
  for (const auto& [activity, factor, level] : cases) {
    const std::string text = number_text(level);
    const std::string name = activity.name + "-" + factor.name;
    if (experiment.ladders.empty() || experiment.ladders.back().name != name)
      experiment.ladders.push_back({.name = name, .unit = factor.unit, .cells = {}});
    experiment.ladders.back().cells.push_back(experiment.cells.size());
    experiment.cells.push_back(
        {name + "-" + text,
         {{"activity", activity.name},
          {"factor", factor.unit.empty() ? factor.name : factor.name + " [" + factor.unit + "]"},
          {"level", text}}});
  }
  set_trials(
      experiment, robustness_fields(options.cliff_share),
      [cases, course](std::size_t cell, std::uint64_t seed) { return play(cases[cell], course, seed); });
  experiment.conclude = [options](const Experiment&, const ExperimentResult& result) {
    return conclude(options, result);
  };
  return experiment;
}

}  // namespace koboshi::lab
