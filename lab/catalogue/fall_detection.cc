#include "lab/catalogue/fall_detection.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <memory>

#include "base/text/text.h"
#include "lab/experiment/report.h"
#include "lab/trial/fall_observer.h"
#include "lab/trial/pushes.h"
#include "lab/trial/scenario_trial.h"
#include "sim_board/description/load.h"
#include "sim_board/random/random_stream.h"
#include "simulation/assembly/parameters.h"

namespace koboshi::lab {
namespace {

constexpr double kWalkBefore_s = 2.0;   // before it is disturbed
constexpr double kStandBefore_s = 1.0;  // the same of a robot that stands
constexpr double kFallWindow_s = 5.0;   // in which a disturbed robot falls or not
constexpr double kSlowPush_s = 1.5;
// Its peak is as the pull of a floor that tilts to 10 to 17 degrees.
constexpr double kSlowPushFactor = 3.2;
constexpr simulation::Range kSlippery{0.01, 0.04};  // friction of wet ice
constexpr double kLongerSettled_s = 1.0;            // after the first touch, trunk and head are down too
constexpr double kDegreesPerUnit = 360.0 / 65'536.0;

enum class Cause { kPushStanding, kPushWalking, kSlowPush, kTrip, kSlip, kDriveFailure, kNone };
constexpr std::array kCauses{Cause::kPushStanding, Cause::kPushWalking,  Cause::kSlowPush, Cause::kTrip,
                             Cause::kSlip,         Cause::kDriveFailure, Cause::kNone};
// These are also played without fall detection, for comparison.
constexpr std::array kUnprotected{Cause::kPushStanding, Cause::kPushWalking, Cause::kTrip};

std::string name_of(Cause cause) {
  static constexpr std::array<const char*, 7> kNames{"push-standing", "push-walking",  "slow-push", "trip",
                                                     "slip",          "drive-failure", "walk"};
  return kNames.at(static_cast<std::size_t>(cause));
}

struct Case {
  Cause cause = Cause::kNone;
  double scale = 1.0;  // of the thresholds
  bool detects = true;

  friend bool operator==(const Case&, const Case&) = default;
};

std::vector<Case> cases_of(const FallDetectionOptions& options) {
  std::vector<Case> cases;
  for (const Cause cause : kCauses) cases.push_back({.cause = cause});
  for (const Cause cause : kUnprotected) cases.push_back({.cause = cause, .detects = false});
  for (const double scale : options.scales) {
    cases.push_back({.cause = Cause::kPushWalking, .scale = scale});
    cases.push_back({.cause = Cause::kNone, .scale = scale});
  }
  return cases;
}

Cell cell_of(const Case& played) {
  const std::string scale = played.detects ? number_text(played.scale) : "off";
  const std::string cause = name_of(played.cause);
  return {cause + "-" + scale, {{"cause", cause}, {"thresholds", scale}}};
}

void set_thresholds(simulation::Scenario& scenario, const Case& played) {
  const behaviour::FallLimits limits = simulation::controller_values(scenario).recovery.fall;
  const auto set = [&](const char* name, double value) {
    scenario.parameters.push_back({.name = {name, "an experiment", 0}, .value = value});
  };
  if (!played.detects) {
    set("fall_to_the_front_deg", 0.0);
  } else if (played.scale != 1.0) {
    set("fall_to_the_front_deg", played.scale * limits.front * kDegreesPerUnit);
    set("fall_to_the_back_deg", played.scale * limits.back * kDegreesPerUnit);
    set("fall_to_the_side_deg", played.scale * limits.side * kDegreesPerUnit);
  }
}

// A bar across the path, which the swing foot hits.
simulation::GroundShape bar(double at_m, double height_m) {
  sim_board::GroundBox box;
  box.X_WG = Eigen::Translation3d(at_m, 0.0, 0.5 * height_m) * Eigen::Isometry3d::Identity();
  box.size_m = {0.03, 3.0, height_m};
  return {.shape = box, .surface = {}};
}

// Makes the scenario of a case in the world of a seed.
class Disturbance {
 public:
  Disturbance(const FallDetectionOptions& options, const StandingStart& start)
      : options_(options), start_(start), robot_(sim_board::load_robot(start.scenario.robot)) {}

  simulation::Scenario scenario(const Case& played, std::uint64_t seed) const {
    sim_board::RandomStream random(seed, "disturbance");
    simulation::Scenario scenario = make(played.cause, random, seed);
    set_thresholds(scenario, played);
    return scenario;
  }

 private:
  simulation::Scenario make(Cause cause, sim_board::RandomStream& random, std::uint64_t seed) const {
    const double walk_s = kWalkBefore_s + random.uniform();  // any phase of a step
    switch (cause) {
      case Cause::kPushStanding:
        return pushed(start_.standing(kStandBefore_s + kFallWindow_s), kStandBefore_s, kPush_s,
                      options_.standing_N_s_per_kg, random, seed);
      case Cause::kPushWalking:
        return pushed(start_.walking(random_velocity(random), walk_s + kFallWindow_s), walk_s, kPush_s,
                      options_.walking_N_s_per_kg, random, seed);
      case Cause::kSlowPush:
        return pushed(start_.standing(kStandBefore_s + kFallWindow_s), kStandBefore_s, kSlowPush_s,
                      kSlowPushFactor * options_.standing_N_s_per_kg, random, seed);
      case Cause::kTrip: {
        simulation::Scenario scenario = start_.walking({0.25, 0.0, 0.0}, kWalkBefore_s + kFallWindow_s);
        const double height_m = between(random, 0.02, 0.03);
        scenario.ground.shapes.push_back(bar(between(random, 0.3, 0.45), height_m));
        return scenario;
      }
      case Cause::kSlip: {
        simulation::Scenario scenario = start_.walking({0.25, 0.0, 0.2}, kWalkBefore_s + kFallWindow_s);
        scenario.world.value().ranges.friction = kSlippery;
        return scenario;
      }
      case Cause::kDriveFailure:
        return with_failing_drive(start_, random, walk_s, kFallWindow_s);
      case Cause::kNone:
        return pushed_walk(random, seed);
    }
    return start_.scenario;
  }

  // Commands that change every 5 s, and pushes that the robot survives.
  simulation::Scenario pushed_walk(sim_board::RandomStream& random, std::uint64_t seed) const {
    simulation::Scenario scenario = start_.walking(Eigen::Vector3d::Zero(), options_.walk_s);
    for (double at_s = 2.0; at_s < options_.walk_s; at_s += 5.0) {
      scenario.commands.push_back({.at_us = start_.ready_us + to_us(at_s),
                                   .kind = simulation::Command::Kind::kWalk,
                                   .velocity = random_velocity(random)});
    }
    const double highest_N_s = options_.survivable_N_s_per_kg * robot_.total_mass_kg();
    add_pushes(scenario, robot_.links.front().name, start_.ready_us,
               {.first_s = 2.0,
                .shortest_s = 1.5,
                .longest_s = 4.0,
                .lowest_N_s = 0.2 * highest_N_s,
                .highest_N_s = highest_N_s,
                .duration_s = kPush_s},
               seed);
    return scenario;
  }

  // Adds a push of 1.2 to 2 times an impulse, from any side.
  simulation::Scenario pushed(simulation::Scenario scenario, double at_s, double duration_s,
                              double impulse_N_s_per_kg, sim_board::RandomStream& random,
                              std::uint64_t seed) const {
    const double mass_kg = robot_in_world(start_.scenario, robot_, seed).total_mass_kg();
    const double impulse_N_s = between(random, 1.2, 2.0) * impulse_N_s_per_kg * mass_kg;
    const double towards_rad = kTurn_rad * random.uniform();
    scenario.pushes.push_back(
        half_sine_push(robot_.links.front().name, start_.ready_us + to_us(at_s), duration_s,
                       impulse_N_s * Eigen::Vector3d(std::cos(towards_rad), std::sin(towards_rad), 0.0)));
    return scenario;
  }

  const FallDetectionOptions options_;
  const StandingStart start_;
  const sim_board::RobotDescription robot_;
};

// Whether the same robot would have stayed on its feet without fall detection.
bool was_false(const Disturbance& disturbance, Case played, std::uint64_t seed, double predicted_s) {
  played.detects = false;
  simulation::Scenario scenario = disturbance.scenario(played, seed);
  scenario.duration_us = to_us(predicted_s + 2.0);
  return !play_in_world(std::move(scenario), seed).lost();
}

FallTrial play(const Disturbance& disturbance, const Case& played, std::uint64_t seed) {
  FallObserver observer;
  bool side = false;
  double end_s = 0.0;
  const ScenarioTrial ended = watch_in_world(
      disturbance.scenario(played, seed), seed,
      [&](const simulation::Simulation& simulation, const simulation::RunRecorder& recorder) {
        const bool touched = observer.history().touched_s.has_value();
        observer.observe(simulation, recorder);
        end_s = simulation.board().world().time_s();
        if (!touched && observer.history().touched_s) {
          // The direction in which the trunk leans, in its own axes.
          const Eigen::Matrix3d R_WB = simulation.board().world().body(0).X_WL.linear();
          side = std::abs(R_WB(2, 1)) > std::abs(R_WB(2, 0));
        }
        const bool settled =
            observer.history().touched_s && end_s > *observer.history().touched_s + kLongerSettled_s;
        const bool seen_in_walk = played.cause == Cause::kNone && observer.history().predicted_s.has_value();
        return settled || seen_in_walk || recorder.telemetry().state == behaviour::State::kRighting;
      });
  const auto predicted_s = observer.history().predicted_s;
  const auto touched_s = observer.history().touched_s;
  FallTrial trial{.outcome = ended.outcome, .error = ended.error, .fell = touched_s.has_value()};
  if (played.cause == Cause::kNone) {
    trial.false_alarm = predicted_s && was_false(disturbance, played, seed, *predicted_s);
    trial.walked_s = end_s;
    trial.fell = trial.fell || (predicted_s && !*trial.false_alarm);
    return trial;
  }
  if (!touched_s) return trial;
  trial.side = side;
  if (played.detects) trial.missed = !(predicted_s && *predicted_s < *touched_s);
  if (predicted_s) trial.lead_s = *touched_s - *predicted_s;
  trial.impact_m_per_s = observer.history().impact_m_per_s;
  return trial;
}

// Returns the leads of all falls, or of those to a side or along the walk; 0 if a fall was not predicted.
std::vector<double> leads_s(const std::vector<FallTrial>& trials, std::optional<bool> side = {}) {
  std::vector<double> leads;
  for (const FallTrial& trial : trials) {
    if (!trial.fell || (side && trial.side.value_or(false) != *side)) continue;
    leads.push_back(std::max(0.0, trial.lead_s.value_or(0.0)));
  }
  return leads;
}

void add_lead(const std::string& name, const std::vector<double>& leads, Conclusions& conclusions) {
  const MeanEstimate mean = estimate_mean(leads);
  const QuantileEstimate p05 = estimate_quantile(leads, 0.05);
  conclusions.values["lead" + name + "_mean_s"] = mean.mean;
  conclusions.values["lead" + name + "_p05_s"] = p05.value;
  conclusions.lines +=
      fmt::format("lead{}: {} falls, mean {:.0f} ms, {} {:.0f} ms ({:.0f} .. {:.0f})\n", name, leads.size(),
                  1e3 * mean.mean, leads.size() < kEnoughFor95Of100 ? "the least" : "95 of 100 have",
                  1e3 * p05.value, 1e3 * p05.confidence_95.low, 1e3 * p05.confidence_95.high);
}

struct FalseAlarms {
  double per_10_min = 0.0;
  double walked_s = 0.0;
};

FalseAlarms false_alarms(const std::vector<FallTrial>& walks) {
  FalseAlarms alarms;
  double count = 0.0;
  for (const FallTrial& walk : walks) {
    count += walk.false_alarm.value_or(false) ? 1.0 : 0.0;
    alarms.walked_s += walk.walked_s.value_or(0.0);
  }
  alarms.per_10_min = 600.0 * count / alarms.walked_s;
  return alarms;
}

// Over the seeds in which trunk or head touched the ground without detection.
double impact_ratio(const std::vector<FallTrial>& with, const std::vector<FallTrial>& without) {
  double protected_sum = 0.0;
  double sum = 0.0;
  for (std::size_t i = 0; i < std::min(with.size(), without.size()); ++i) {
    if (!without[i].impact_m_per_s) continue;
    protected_sum += with[i].impact_m_per_s.value_or(0.0);
    sum += *without[i].impact_m_per_s;
  }
  return protected_sum / sum;
}

Conclusions conclude(const FallDetectionOptions& options, const ExperimentResult& result) {
  const std::vector<Case> cases = cases_of(options);
  const auto trials = [&](const Case& played) {
    const auto cell = std::ranges::find(cases, played) - cases.begin();
    return fall_fields().trials(result.cells.at(static_cast<std::size_t>(cell)));
  };
  Conclusions conclusions;
  std::vector<FallTrial> falls;
  for (const Cause cause : kCauses) {
    // A drive that fails is a fault, which ends the behaviour before the fall.
    if (cause == Cause::kDriveFailure || cause == Cause::kNone) continue;
    std::ranges::move(trials({.cause = cause}), std::back_inserter(falls));
  }
  add_lead("", leads_s(falls), conclusions);
  add_lead("_front_back", leads_s(falls, false), conclusions);
  add_lead("_side", leads_s(falls, true), conclusions);
  const FalseAlarms alarms = false_alarms(trials({.cause = Cause::kNone}));
  conclusions.values["false_alarms_per_10_min"] = alarms.per_10_min;
  conclusions.values["walked_s"] = alarms.walked_s;
  conclusions.lines += fmt::format("{:.2f} false alarms in 10 minutes, of {:.1f} minutes of walking\n",
                                   alarms.per_10_min, alarms.walked_s / 60.0);
  for (const Cause cause : kUnprotected) {
    const double ratio = impact_ratio(trials({.cause = cause}), trials({.cause = cause, .detects = false}));
    conclusions.values["impact_ratio_" + name_of(cause)] = ratio;
    conclusions.lines +=
        fmt::format("{}: trunk or head comes down with {:.2f} of the speed without\n", name_of(cause), ratio);
  }
  conclusions.values["roc"] = nlohmann::ordered_json::array();
  for (const double scale : options.scales) {
    const double lead_s = estimate_mean(leads_s(trials({.cause = Cause::kPushWalking, .scale = scale}))).mean;
    const double per_10_min = false_alarms(trials({.cause = Cause::kNone, .scale = scale})).per_10_min;
    conclusions.values["roc"].push_back(
        {{"thresholds", scale}, {"lead_mean_s", lead_s}, {"false_alarms_per_10_min", per_10_min}});
    conclusions.lines +=
        fmt::format("thresholds times {}: lead {:.0f} ms, {:.2f} false alarms in 10 minutes\n", scale,
                    1e3 * lead_s, per_10_min);
  }
  return conclusions;
}

}  // namespace

const FieldTable<FallTrial>& fall_fields() {
  using T = FallTrial;
  static constexpr std::array<Loss, 1> kGaveUp{{{Outcome::kGaveUp, "gave_up", ""}}};
  static const FieldTable<T> kFields{
      Fields<T>{{{"fell", "falls"}, &T::fell},
                {{"missed", "not predicted"}, &T::missed},
                {{"false_alarm", "false alarm"}, &T::false_alarm},
                {{"lead_s", "lead [ms]", 0, 1e3}, &T::lead_s},
                {{"impact_m_per_s", "trunk or head comes down with [m/s]", 2}, &T::impact_m_per_s},
                {{"walked_s"}, &T::walked_s},
                {{"side"}, &T::side}},
      outcome_fields<T>(&T::outcome, kGaveUp), outcome_fields<T>(&T::outcome, kLossesButFalls.subspan<1>())};
  return kFields;
}

Experiment make_fall_detection(const FallDetectionOptions& options) {
  const StandingStart start = read_standing_start(options, options.overrides);
  Experiment experiment = begin_experiment("fall-detection", "How it predicts falls", options, start.scenario,
                                           {{"standing_N_s_per_kg", options.standing_N_s_per_kg},
                                            {"walking_N_s_per_kg", options.walking_N_s_per_kg},
                                            {"survivable_N_s_per_kg", options.survivable_N_s_per_kg},
                                            {"walk_s", options.walk_s}});
  const std::vector<Case> cases = cases_of(options);
  for (const Case& played : cases) experiment.cells.push_back(cell_of(played));
  const auto disturbance = std::make_shared<const Disturbance>(options, start);
  set_trials(experiment, fall_fields(), [disturbance, cases](std::size_t cell, std::uint64_t seed) {
    return play(*disturbance, cases[cell], seed);
  });
  experiment.conclude = [options](const Experiment&, const ExperimentResult& result) {
    return conclude(options, result);
  };
  return experiment;
}

}  // namespace koboshi::lab
