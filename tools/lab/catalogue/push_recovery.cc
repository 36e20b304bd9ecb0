#include "tools/lab/catalogue/push_recovery.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <tuple>

#include "sim_board/input/text.h"
#include "sim_board/random/random_stream.h"
#include "sim_board/scenario/reader.h"
#include "simulation/scenario/parameters.h"
#include "tools/lab/trial/outcome.h"
#include "tools/lab/trial/perturbation.h"
#include "tools/lab/trial/scenario_trial.h"

namespace koboshi::tools {
namespace {

constexpr double kStand_s = 0.5;      // before it is pushed, standing;
constexpr double kWalk_s = 3.0;       // and walking, at least
constexpr double kAftermath_s = 3.0;  // a robot of this height that is going to fall lies after one second
constexpr double kStillFall = 0.05;   // of 95 of 100 that survive

constexpr const char* kImpulse = "impulse_N_s_per_kg";
constexpr const char* kPhase = "phase";
constexpr const char* kStanding = "standing";
constexpr const char* kWalking = "walking";
constexpr const char* kNothing = "nothing";

double cycle_s(const sim::Scenario& scenario) {
  return 2.0 * 1e-3 * simulation::controller_values(scenario).walk.step.time_ms;
}

struct PushTrial {
  StandingStart start;
  bool walks = false;
  double direction_rad = 0.0;
};

// The largest impulse that this robot survives in the seed's world.
Values play(const PushTrial& trial, const PushRecoveryOptions& options, const sim::RobotDescription& robot,
            std::uint64_t seed) {
  sim::RandomStream random(seed, "phase of the push");
  const double phase = random.uniform();
  const double wait_s = trial.walks ? kWalk_s + phase * cycle_s(trial.start.scenario) : kStand_s;
  const double for_s = wait_s + kPush_s + kAftermath_s;
  sim::RobotDescription in_world = robot;
  perturb_robot(in_world, kRoughWorld, seed);
  const Eigen::Vector3d along(std::cos(trial.direction_rad), std::sin(trial.direction_rad), 0.0);
  Values weakest_lost;  // of the pushes, for a bisection only ever goes down from one that was not survived
  const auto survives = [&](double impulse_N_s_per_kg) {
    sim::Scenario scenario =
        trial.walks ? trial.start.walking(Eigen::Vector3d::Zero(), for_s) : trial.start.standing(for_s);
    const std::uint64_t at_us = trial.start.ready_us + static_cast<std::uint64_t>(std::llround(1e6 * wait_s));
    scenario.pushes = {half_sine_push(robot.links.front().name, at_us, kPush_s,
                                      impulse_N_s_per_kg * in_world.total_mass_kg() * along)};
    Values played = play_in_world(scenario, kRoughWorld, seed);
    const bool survived = played.at(kLost) == 0.0;
    if (!survived) weakest_lost = std::move(played);
    return survived;
  };
  Values values{{kImpulse, largest_survived(options.highest_N_s_per_kg, options.halvings, survives)},
                {kPhase, phase}};
  if (!weakest_lost.empty()) add_outcome(weakest_lost, values);
  return values;
}

// Of all values, or by phase the estimate that is least.
QuantileEstimate survived_by_95_of_100(const CellResult& cell, std::size_t bins) {
  std::vector<std::vector<double>> by_phase(bins);
  for (const Trial& trial : cell.played) {
    const auto bin = static_cast<std::size_t>(trial.values.at(kPhase) * static_cast<double>(bins));
    by_phase[std::min(bin, bins - 1)].push_back(trial.values.at(kImpulse));
  }
  QuantileEstimate least = estimate_quantile({}, kStillFall);
  for (const std::vector<double>& values : by_phase) {
    const QuantileEstimate estimate = estimate_quantile(values, kStillFall);
    if (estimate.count > 0 && (least.count == 0 || estimate.value < least.value)) least = estimate;
  }
  return least;
}

// "walking", "walking without capture".
std::string column(const SurvivedPush& push) {
  return push.without == kNothing ? push.state : push.state + " without " + push.without;
}

std::string degrees(double angle_rad) { return fmt::format("{:.1f}", angle_rad * 360.0 / kTurn_rad); }

// The pushes of each column, in the order of directions.
std::vector<std::vector<SurvivedPush>> by_column(const std::vector<SurvivedPush>& pushes) {
  std::vector<std::vector<SurvivedPush>> columns;
  for (const SurvivedPush& push : pushes) {
    if (columns.empty() || column(columns.back().front()) != column(push)) columns.emplace_back();
    columns.back().push_back(push);
  }
  return columns;
}

std::string push_table(const std::vector<SurvivedPush>& pushes, TableStyle style) {
  const auto columns = by_column(pushes);
  Row head{"pushed towards [deg]"};
  std::vector<Row> rows(columns.front().size());
  for (std::size_t i = 0; i < rows.size(); ++i) rows[i] = {degrees(columns.front()[i].direction_rad)};
  for (const auto& of_column : columns) {
    head.push_back(column(of_column.front()) + " [N s/kg]");
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const QuantileEstimate& impulse = of_column[i].impulse_N_s_per_kg;
      rows[i].push_back(impulse.count == 0
                            ? "-"
                            : fmt::format("{:.3f} ({:.3f} .. {:.3f})", impulse.value,
                                          impulse.confidence_95.low, impulse.confidence_95.high));
    }
  }
  return table_text(head, rows, style);
}

// How the weakest pushes that were not survived ended, summed over directions and seeds.
std::string loss_table(const std::vector<SurvivedPush>& pushes, TableStyle style) {
  Row head{"the weakest push that was not survived"};
  for (const Measure& measure : outcome_measures())
    head.push_back(measure.label.empty() ? measure.name : measure.label);
  std::vector<Row> rows;
  for (const auto& of_column : by_column(pushes)) {
    Row row{column(of_column.front())};
    for (const Measure& measure : outcome_measures()) {
      std::size_t count = 0;
      for (const SurvivedPush& push : of_column) {
        const auto found = push.losses.find(measure.name);
        if (found != push.losses.end()) count += found->second;
      }
      row.push_back(std::to_string(count));
    }
    rows.push_back(std::move(row));
  }
  return table_text(head, rows, style);
}

std::map<std::string, std::size_t> losses_of(const CellResult& cell) {
  std::map<std::string, std::size_t> losses;
  for (const Trial& trial : cell.played) {
    for (const Measure& measure : outcome_measures()) {
      const auto value = trial.values.find(measure.name);
      if (value != trial.values.end() && value->second > 0.0) ++losses[measure.name];
    }
  }
  return losses;
}

// The same for a state and the feedback that is off, whatever else is drawn.
int colour_of_column(const SurvivedPush& push) {
  const auto& states = pushed_states();
  const auto state = std::ranges::find(states, push.state) - states.begin();
  const auto off = std::ranges::find(feedbacks(), push.without, &Feedback::name) - feedbacks().begin();
  const auto row = push.without == kNothing ? 0 : off + 1;
  constexpr int kPalette = 7;  // the eighth is that of the rings
  return static_cast<int>((state + static_cast<std::ptrdiff_t>(states.size()) * row) % kPalette);
}

PlaneCurve ring(double radius) {
  PlaneCurve curve{.colour = 7, .width = 0.5};
  for (int i = 0; i <= 72; ++i) {
    const double angle_rad = kTurn_rad * i / 72;
    curve.points.push_back({radius * std::cos(angle_rad), radius * std::sin(angle_rad)});
  }
  return curve;
}

}  // namespace

const std::vector<std::string>& pushed_states() {
  static const std::vector<std::string> kStates{kStanding, kWalking};
  return kStates;
}

const std::vector<Feedback>& feedbacks() {
  static const std::vector<Feedback> kFeedbacks{
      {"gyro",
       {"standing_gain_ankle_pitch_s", "standing_gain_ankle_roll_s", "standing_gain_hip_roll_s",
        "standing_gain_knee_s", "standing_gain_hip_pitch_s", "walking_gain_ankle_pitch_s",
        "walking_gain_ankle_roll_s", "walking_gain_hip_roll_s", "walking_gain_knee_s",
        "walking_gain_hip_pitch_s"}},
      {"attitude",
       {"standing_lean_gain_ankle_pitch_percent", "standing_lean_gain_ankle_roll_percent",
        "standing_lean_gain_hip_roll_percent", "standing_lean_gain_knee_percent",
        "standing_lean_gain_hip_pitch_percent", "walking_lean_gain_ankle_pitch_percent",
        "walking_lean_gain_ankle_roll_percent", "walking_lean_gain_hip_roll_percent",
        "walking_lean_gain_knee_percent", "walking_lean_gain_hip_pitch_percent"}},
      {"capture", {"capture_forward_percent", "capture_lateral_percent"}},
      {"touch-down", {"touchdown_load_N"}},
      {"heading", {"heading_hold_percent"}}};
  return kFeedbacks;
}

double largest_survived(double highest, int halvings, const std::function<bool(double)>& survives) {
  double low = 0.0;
  double high = highest;
  for (int i = 0; i < halvings; ++i) {
    const double middle = 0.5 * (low + high);
    (survives(middle) ? low : high) = middle;
  }
  return low;
}

Experiment make_push_recovery(const PushRecoveryOptions& options) {
  auto trials = std::make_shared<std::vector<PushTrial>>();
  std::vector<Cell> cells;
  std::vector<std::string> without{kNothing};
  without.insert(without.end(), options.ablate.begin(), options.ablate.end());
  for (const std::string& state : options.states) {
    for (const std::string& name : without) {
      std::vector<sim::Override> overrides = options.overrides;
      const auto off = std::ranges::find(feedbacks(), name, &Feedback::name);
      if (off != feedbacks().end()) {
        for (const std::string& parameter : off->parameters) {
          overrides.push_back({"parameters." + parameter, "0"});
        }
      }
      const StandingStart start = read_standing_start(options.scenario, overrides);
      for (std::size_t i = 0; i < options.directions; ++i) {
        const double direction_rad =
            kTurn_rad * static_cast<double>(i) / static_cast<double>(options.directions);
        trials->push_back({.start = start, .walks = state == kWalking, .direction_rad = direction_rad});
        cells.push_back({fmt::format("{}-without-{}-{}", state, name, degrees(direction_rad)),
                         {{"state", state}, {"without", name}, {"direction_deg", degrees(direction_rad)}}});
      }
    }
  }
  const sim::Scenario& scenario = trials->front().start.scenario;
  Experiment experiment =
      begin_experiment("push-recovery", options, scenario,
                       {{"highest_N_s_per_kg", sim::number_text(options.highest_N_s_per_kg)},
                        {"halvings", std::to_string(options.halvings)}});
  experiment.measures = {{.name = kImpulse, .label = "survived [N s/kg]"}, {.name = kPhase}};
  const std::vector<Measure> outcomes = outcome_measures();
  experiment.measures.insert(experiment.measures.end(), outcomes.begin(), outcomes.end());
  experiment.cells = std::move(cells);
  experiment.play = [options, trials, robot = sim::read_robot(scenario)](std::size_t cell,
                                                                         std::uint64_t seed) {
    return play(trials->at(cell), options, robot, seed);
  };
  return experiment;
}

std::vector<SurvivedPush> survived_pushes(const PushRecoveryOptions& options, const Experiment& experiment,
                                          const ExperimentResult& result) {
  std::vector<SurvivedPush> pushes;
  for (std::size_t cell = 0; cell < experiment.cells.size(); ++cell) {
    const auto& settings = experiment.cells[cell].settings;
    const std::string& state = settings[0].second;
    const std::size_t direction = cell % options.directions;
    pushes.push_back({.state = state,
                      .without = settings[1].second,
                      .direction_rad = kTurn_rad * static_cast<double>(direction) /
                                       static_cast<double>(options.directions),
                      .impulse_N_s_per_kg = survived_by_95_of_100(result.cells[cell],
                                                                  state == kWalking ? options.phase_bins : 1),
                      .losses = losses_of(result.cells[cell])});
  }
  return pushes;
}

Conclusions push_recovery_conclusions(const std::vector<SurvivedPush>& pushes) {
  Conclusions conclusions;
  conclusions.table = [pushes](TableStyle style) {
    return push_table(pushes, style) + "\n" + loss_table(pushes, style);
  };
  for (const std::vector<SurvivedPush>& of_column : by_column(pushes)) {
    const auto played = [](const SurvivedPush& push) { return push.impulse_N_s_per_kg.count > 0; };
    if (!std::ranges::all_of(of_column, played)) {
      conclusions.lines += column(of_column.front()) + ": some directions were not played\n";
      continue;
    }
    const SurvivedPush& least = *std::ranges::min_element(
        of_column, {}, [](const SurvivedPush& push) { return push.impulse_N_s_per_kg.value; });
    const QuantileEstimate& impulse = least.impulse_N_s_per_kg;
    const std::string who = impulse.count < kEnoughFor95Of100
                                ? fmt::format("the weakest of {} survives", impulse.count)
                                : fmt::format("95 of 100 survive, by {} seeds,", impulse.count);
    conclusions.lines += fmt::format("{}: {} {:.3f} N s/kg, the least towards {} degrees\n", column(least),
                                     who, impulse.value, degrees(least.direction_rad));
    const std::string key = least.without == kNothing
                                ? least.state + "_min_Ns_per_kg"
                                : least.state + "_without_" + least.without + "_min_Ns_per_kg";
    conclusions.values[key] = impulse.value;
    conclusions.values[key + "_seeds"] = impulse.count;
    conclusions.values[key + "_confidence_95"] = {impulse.confidence_95.low, impulse.confidence_95.high};
  }
  return conclusions;
}

PlaneFigure polar_figure(const std::vector<SurvivedPush>& pushes) {
  std::size_t fewest = pushes.empty() ? 0 : pushes.front().impulse_N_s_per_kg.count;
  for (const SurvivedPush& push : pushes) fewest = std::min(fewest, push.impulse_N_s_per_kg.count);
  PlaneFigure figure{
      .title =
          fewest < kEnoughFor95Of100
              ? fmt::format(
                    "Impulse that the weakest of {} seeds survives [N s/kg], by the direction of the push",
                    fewest)
              : "Impulses that 95 of 100 survive [N s/kg], by the direction of the push",
      .x_label = "to the right",
      .y_label = "forward"};
  for (const double radius : {0.1, 0.2, 0.3, 0.4}) figure.curves.push_back(ring(radius));
  for (const std::vector<SurvivedPush>& of_column : by_column(pushes)) {
    PlaneCurve curve{.label = column(of_column.front()),
                     .style = of_column.front().without == kNothing ? LineStyle::kSolid : LineStyle::kDashed,
                     .colour = colour_of_column(of_column.front())};
    for (const SurvivedPush& push : of_column) {
      const double radius = push.impulse_N_s_per_kg.value;
      curve.points.push_back({-radius * std::sin(push.direction_rad), radius * std::cos(push.direction_rad)});
    }
    curve.points.push_back(curve.points.front());
    figure.curves.push_back(std::move(curve));
  }
  return figure;
}

}  // namespace koboshi::tools
