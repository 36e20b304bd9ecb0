#include "tools/lab/catalogue/fall_detection.h"

#include <fmt/core.h>

#include <array>
#include <cmath>
#include <functional>
#include <memory>

#include "sim_board/input/text.h"
#include "sim_board/random/random_stream.h"
#include "sim_board/robot/load.h"
#include "sim_board/scenario/reader.h"
#include "simulation/scenario/parameters.h"
#include "tools/lab/trial/fall_observer.h"
#include "tools/lab/trial/outcome.h"
#include "tools/lab/trial/perturbation.h"
#include "tools/lab/trial/scenario_trial.h"

namespace koboshi::tools {
namespace {

constexpr double kWalkBefore_s = 2.0;   // before it is disturbed
constexpr double kStandBefore_s = 1.0;  // the same of a robot that stands
constexpr double kFallWindow_s = 5.0;   // in which a disturbed robot falls or not
constexpr double kSlowPush_s = 1.5;
// Its peak is as the pull of a floor that tilts to 10 to 17 degrees.
constexpr double kSlowPushFactor = 3.2;
constexpr double kLongerSettled_s = 1.0;  // after the first touch, trunk and head are down too
constexpr double kDegreesPerUnit = 360.0 / 65'536.0;

enum class Cause { kPushStanding, kPushWalking, kSlowPush, kTrip, kSlip, kDriveFailure, kNone };

struct NamedCause {
  Cause cause;
  const char* name;
};
constexpr std::array<NamedCause, 6> kCauses{{{Cause::kPushStanding, "push-standing"},
                                             {Cause::kPushWalking, "push-walking"},
                                             {Cause::kSlowPush, "slow-push"},
                                             {Cause::kTrip, "trip"},
                                             {Cause::kSlip, "slip"},
                                             {Cause::kDriveFailure, "drive-failure"}}};
// Of these also how hard the robot comes down when nothing is done about it; indices of kCauses.
constexpr std::array<std::size_t, 3> kUnprotected{0, 1, 3};
constexpr const char* kWalk = "walk";

struct Case {
  Cause cause = Cause::kNone;
  double scale = 1.0;  // of the thresholds
  bool looked_for = true;
};

sim::ParameterSetting parameter(const std::string& name, double value) {
  return {.name = {name, "an experiment", 0}, .value = value};
}

void set_thresholds(sim::Scenario& scenario, const Case& what) {
  const behaviour::FallLimits limits = simulation::controller_values(scenario).recovery.fall;
  const auto set = [&](const char* name, std::int16_t value) {
    scenario.parameters.push_back(parameter(name, what.scale * value * kDegreesPerUnit));
  };
  if (!what.looked_for) {
    scenario.parameters.push_back(parameter("fall_to_the_front_deg", 0.0));
  } else if (what.scale != 1.0) {
    set("fall_to_the_front_deg", limits.front);
    set("fall_to_the_back_deg", limits.back);
    set("fall_to_the_side_deg", limits.side);
  }
}

// A bar across the way, that the swing foot hits.
sim::GroundShape bar(double at_m, double height_m) {
  sim::GroundBox box;
  box.X_WG = Eigen::Translation3d(at_m, 0.0, 0.5 * height_m) * Eigen::Isometry3d::Identity();
  box.size_m = {0.03, 3.0, height_m};
  return {.shape = box, .surface = {}};
}

class Disturbance {
 public:
  Disturbance(const FallDetectionOptions& options, const StandingStart& start,
              const sim::RobotDescription& robot)
      : options_(options), start_(start), robot_(robot) {}

  sim::Scenario scenario(const Case& what, std::uint64_t seed) const {
    sim::RandomStream random(seed, "disturbance");
    sim::Scenario scenario = make(what.cause, random, seed);
    set_thresholds(scenario, what);
    return scenario;
  }

 private:
  sim::Scenario make(Cause cause, sim::RandomStream& random, std::uint64_t seed) const {
    const double walk_s = kWalkBefore_s + random.uniform();  // any phase of a step
    switch (cause) {
      case Cause::kPushStanding: {
        sim::Scenario scenario = start_.standing(kStandBefore_s + kFallWindow_s);
        push(scenario, kStandBefore_s, kPush_s, options_.standing_N_s_per_kg, random, seed);
        return scenario;
      }
      case Cause::kPushWalking: {
        sim::Scenario scenario = start_.walking(velocity(random), walk_s + kFallWindow_s);
        push(scenario, walk_s, kPush_s, options_.walking_N_s_per_kg, random, seed);
        return scenario;
      }
      case Cause::kSlowPush: {
        sim::Scenario scenario = start_.standing(kStandBefore_s + kFallWindow_s);
        push(scenario, kStandBefore_s, kSlowPush_s, kSlowPushFactor * options_.standing_N_s_per_kg, random,
             seed);
        return scenario;
      }
      case Cause::kTrip: {
        sim::Scenario scenario = start_.walking({0.25, 0.0, 0.0}, kWalkBefore_s + kFallWindow_s);
        scenario.ground.shapes.push_back(bar(between(random, 0.3, 0.45), between(random, 0.02, 0.03)));
        return scenario;
      }
      case Cause::kSlip: {
        sim::Scenario scenario = start_.walking({0.25, 0.0, 0.2}, kWalkBefore_s + kFallWindow_s);
        return scenario;
      }
      case Cause::kDriveFailure: {
        sim::Scenario scenario = start_.walking(velocity(random), walk_s + kFallWindow_s);
        static constexpr std::array<const char*, 4> kJoints{"left_knee", "right_knee", "left_hip_pitch",
                                                            "right_ankle_pitch"};
        const auto joint = static_cast<std::size_t>(random.uniform() * kJoints.size());
        sim::Fault fault;
        fault.at_us = start_.ready_us + to_us(walk_s);
        fault.kind = sim::Fault::Kind::kDrivePowerLoss;
        fault.target = {kJoints[joint], "an experiment", 0};
        scenario.faults.push_back(fault);
        return scenario;
      }
      case Cause::kNone:
        return pushed_walk(random, seed);
    }
    return start_.scenario;
  }

  // Commands that change every 5 s, and pushes that are survived.
  sim::Scenario pushed_walk(sim::RandomStream& random, std::uint64_t seed) const {
    sim::Scenario scenario = start_.walking(Eigen::Vector3d::Zero(), options_.walk_s);
    for (double at_s = 2.0; at_s < options_.walk_s; at_s += 5.0) {
      scenario.commands.push_back({.at_us = start_.ready_us + to_us(at_s),
                                   .kind = sim::Command::Kind::kWalk,
                                   .velocity = velocity(random)});
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

  static Eigen::Vector3d velocity(sim::RandomStream& random) {
    const double ahead = between(random, -0.15, 0.22);
    const double left = between(random, -0.06, 0.06);
    return {ahead, left, between(random, -0.5, 0.5)};
  }

  // 1.2 to 2 times an impulse, from any side.
  void push(sim::Scenario& scenario, double at_s, double duration_s, double impulse_N_s_per_kg,
            sim::RandomStream& random, std::uint64_t seed) const {
    sim::RobotDescription in_world = robot_;
    perturb_robot(in_world, kRoughWorld, seed);
    const double impulse = between(random, 1.2, 2.0) * impulse_N_s_per_kg * in_world.total_mass_kg();
    const double towards_rad = kTurn_rad * random.uniform();
    scenario.pushes.push_back(
        half_sine_push(robot_.links.front().name, start_.ready_us + to_us(at_s), duration_s,
                       impulse * Eigen::Vector3d(std::cos(towards_rad), std::sin(towards_rad), 0.0)));
  }

  const FallDetectionOptions& options_;
  const StandingStart& start_;
  const sim::RobotDescription& robot_;
};

PerturbationBounds world_of(Cause cause) {
  PerturbationBounds bounds = kRoughWorld;
  if (cause == Cause::kSlip) {
    bounds.lowest_friction = 0.01;
    bounds.highest_friction = 0.04;
  }
  return bounds;
}

// Whether the same robot would have stayed on its feet, had nothing been done.
bool was_false(const Disturbance& disturbance, Case what, std::uint64_t seed, double foreseen_s) {
  what.looked_for = false;
  sim::Scenario scenario = disturbance.scenario(what, seed);
  scenario.duration_us = to_us(foreseen_s + 2.0);
  return play_in_world(std::move(scenario), world_of(what.cause), seed).at(kLost) == 0.0;
}

Values play(const Disturbance& disturbance, const Case& what, std::uint64_t seed) {
  FallObserver observer;
  double side = 0.0;
  double end_s = 0.0;
  const Values played = watch_in_world(
      disturbance.scenario(what, seed), world_of(what.cause), seed,
      [&](const simulation::Simulation& simulation, const simulation::RunRecorder& recorder) {
        const bool touched = observer.touched_s().has_value();
        observer.observe(simulation, recorder);
        end_s = simulation.board().world().time_s();
        if (!touched && observer.touched_s()) {
          // Where the trunk leans to, in its own axes.
          const Eigen::Matrix3d R_WB = simulation.board().world().body(0).X_WL.linear();
          side = std::abs(R_WB(2, 1)) > std::abs(R_WB(2, 0)) ? 1.0 : 0.0;
        }
        const bool settled = observer.touched_s() && end_s > *observer.touched_s() + kLongerSettled_s;
        const bool seen_in_walk = what.cause == Cause::kNone && observer.foreseen_s().has_value();
        return settled || seen_in_walk || recorder.telemetry().state == behaviour::State::kRighting;
      });
  Values values;
  add_outcome(played, values);
  const auto foreseen_s = observer.foreseen_s();
  const auto touched_s = observer.touched_s();
  if (what.cause == Cause::kNone) {
    const bool is_false = foreseen_s && was_false(disturbance, what, seed, *foreseen_s);
    values["false_alarm"] = is_false ? 1.0 : 0.0;
    values["walked_s"] = end_s;
    values["fell"] = (foreseen_s && !is_false) || touched_s ? 1.0 : 0.0;
    return values;
  }
  values["fell"] = touched_s ? 1.0 : 0.0;
  if (!touched_s) return values;
  values["side"] = side;
  if (what.looked_for) values["missed"] = foreseen_s && *foreseen_s < *touched_s ? 0.0 : 1.0;
  if (foreseen_s) values["lead_s"] = *touched_s - *foreseen_s;
  if (observer.impact_m_per_s()) values["impact_m_per_s"] = *observer.impact_m_per_s();
  return values;
}

std::vector<std::pair<Cell, Case>> cases(const FallDetectionOptions& options) {
  std::vector<std::pair<Cell, Case>> all;
  const auto add = [&](const std::string& cause, const Case& what) {
    const std::string scale = what.looked_for ? sim::number_text(what.scale) : "off";
    all.push_back({{cause + "-" + scale, {{"cause", cause}, {"thresholds", scale}}}, what});
  };
  for (const NamedCause& named : kCauses) add(named.name, {.cause = named.cause});
  add(kWalk, {.cause = Cause::kNone});
  for (const std::size_t i : kUnprotected) {
    add(kCauses[i].name, {.cause = kCauses[i].cause, .looked_for = false});
  }
  for (const double scale : options.scales) {
    add(kCauses[1].name, {.cause = Cause::kPushWalking, .scale = scale});
    add(kWalk, {.cause = Cause::kNone, .scale = scale});
  }
  return all;
}

std::string setting(const Cell& cell, const std::string& key) {
  for (const auto& [name, value] : cell.settings) {
    if (name == key) return value;
  }
  return {};
}

struct Leads {
  std::vector<double> all;
  std::vector<double> along;  // to the front and the back
  std::vector<double> aside;
};

// A fall that nobody saw had no lead.
void add_leads(const CellResult& cell, Leads& leads) {
  for (const Trial& trial : cell.played) {
    const Values& values = trial.values;
    if (values.at("fell") == 0.0) continue;
    const double lead_s = values.contains("lead_s") ? std::max(0.0, values.at("lead_s")) : 0.0;
    leads.all.push_back(lead_s);
    (values.at("side") != 0.0 ? leads.aside : leads.along).push_back(lead_s);
  }
}

void tell_leads(const std::string& name, const std::vector<double>& leads_s, Conclusions& conclusions) {
  const MeanEstimate mean = estimate_mean(leads_s);
  const QuantileEstimate p05 = estimate_quantile(leads_s, 0.05);
  conclusions.values["lead" + name + "_mean_s"] = mean.mean;
  conclusions.values["lead" + name + "_p05_s"] = p05.value;
  conclusions.lines +=
      fmt::format("lead{}: {} falls, mean {:.0f} ms, {} {:.0f} ms ({:.0f} .. {:.0f})\n", name, leads_s.size(),
                  1e3 * mean.mean, leads_s.size() < kEnoughFor95Of100 ? "the least" : "95 of 100 have",
                  1e3 * p05.value, 1e3 * p05.confidence_95.low, 1e3 * p05.confidence_95.high);
}

// Of the seeds in which trunk or head came down in both.
double impact_ratio(const CellResult& with, const CellResult& without) {
  double protected_sum = 0.0;
  double sum = 0.0;
  for (std::size_t i = 0; i < std::min(with.played.size(), without.played.size()); ++i) {
    const Values& a = with.played[i].values;
    const Values& b = without.played[i].values;
    if (!b.contains("impact_m_per_s")) continue;
    protected_sum += a.contains("impact_m_per_s") ? a.at("impact_m_per_s") : 0.0;
    sum += b.at("impact_m_per_s");
  }
  return protected_sum / sum;
}

}  // namespace

Experiment make_fall_detection(const FallDetectionOptions& options) {
  struct Shared {
    FallDetectionOptions options;
    StandingStart start;
    sim::RobotDescription robot;
    std::vector<std::pair<Cell, Case>> cases;
  };
  const auto shared = std::make_shared<Shared>();
  shared->options = options;
  shared->start = read_standing_start(options.scenario, options.overrides);
  shared->robot = sim::load_robot(shared->start.scenario.robot);
  shared->cases = cases(options);
  Experiment experiment =
      begin_experiment("fall-detection", options, shared->start.scenario,
                       {{"standing_N_s_per_kg", sim::number_text(options.standing_N_s_per_kg)},
                        {"walking_N_s_per_kg", sim::number_text(options.walking_N_s_per_kg)},
                        {"survivable_N_s_per_kg", sim::number_text(options.survivable_N_s_per_kg)},
                        {"walk_s", sim::number_text(options.walk_s)}});
  using enum Measure::Kind;
  experiment.measures = {
      {.name = "fell", .kind = kEvent, .label = "falls"},
      {.name = "missed", .kind = kEvent, .label = "not foreseen"},
      {.name = "false_alarm", .kind = kEvent, .label = "false alarm"},
      {.name = "lead_s", .label = "lead [ms]", .factor = 1e3, .decimals = 0},
      {.name = "impact_m_per_s", .label = "trunk or head comes down with [m/s]", .decimals = 2},
      {.name = "walked_s"},
      {.name = "side", .kind = kEvent},
      {.name = "gave_up", .kind = kEvent},
      {.name = "low_supply", .kind = kEvent, .label = "low supply"},
      {.name = "energy_guard", .kind = kEvent, .label = "energy guard"},
      {.name = "failed", .kind = kEvent}};
  for (const auto& [cell, what] : shared->cases) experiment.cells.push_back(cell);
  experiment.play = [shared](std::size_t cell, std::uint64_t seed) {
    const Disturbance disturbance(shared->options, shared->start, shared->robot);
    return play(disturbance, shared->cases[cell].second, seed);
  };
  return experiment;
}

Conclusions fall_detection_conclusions(const FallDetectionOptions& options, const Experiment& experiment,
                                       const ExperimentResult& result) {
  Conclusions conclusions;
  Leads leads;
  const auto& cells = experiment.cells;
  const std::size_t walk = kCauses.size();
  for (std::size_t i = 0; i < walk; ++i) {
    // A drive that fails is a fault, which ends the behaviour before the fall.
    if (setting(cells[i], "cause") != "drive-failure") add_leads(result.cells[i], leads);
  }
  tell_leads("", leads.all, conclusions);
  tell_leads("_front_back", leads.along, conclusions);
  tell_leads("_side", leads.aside, conclusions);
  const auto alarms_per_10_min = [&](const CellResult& cell) {
    double alarms = 0.0;
    double walked_s = 0.0;
    for (const Trial& trial : cell.played) {
      alarms += trial.values.at("false_alarm");
      walked_s += trial.values.at("walked_s");
    }
    return std::pair{600.0 * alarms / walked_s, walked_s};
  };
  const auto [alarms, walked_s] = alarms_per_10_min(result.cells[walk]);
  conclusions.values["false_alarms_per_10_min"] = alarms;
  conclusions.values["walked_s"] = walked_s;
  conclusions.lines += fmt::format("{:.2f} false alarms in 10 minutes, of {:.1f} minutes of walking\n",
                                   alarms, walked_s / 60.0);
  for (std::size_t i = 0; i < kUnprotected.size(); ++i) {
    const std::string cause = kCauses[kUnprotected[i]].name;
    const double ratio = impact_ratio(result.cells[kUnprotected[i]], result.cells[walk + 1 + i]);
    conclusions.values["impact_ratio_" + cause] = ratio;
    conclusions.lines +=
        fmt::format("{}: trunk or head comes down with {:.2f} of the speed without\n", cause, ratio);
  }
  conclusions.values["roc"] = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < options.scales.size(); ++i) {
    const std::size_t first = walk + 1 + kUnprotected.size() + 2 * i;
    Leads of_scale;
    add_leads(result.cells[first], of_scale);
    const MeanEstimate lead = estimate_mean(of_scale.all);
    const double false_alarms = alarms_per_10_min(result.cells[first + 1]).first;
    conclusions.values["roc"].push_back({{"thresholds", options.scales[i]},
                                         {"lead_mean_s", lead.mean},
                                         {"false_alarms_per_10_min", false_alarms}});
    conclusions.lines +=
        fmt::format("thresholds times {}: lead {:.0f} ms, {:.2f} false alarms in 10 minutes\n",
                    options.scales[i], 1e3 * lead.mean, false_alarms);
  }
  return conclusions;
}

}  // namespace koboshi::tools
