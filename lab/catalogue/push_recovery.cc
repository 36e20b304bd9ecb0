#include "lab/catalogue/push_recovery.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/text/text.h"
#include "lab/trial/pushes.h"
#include "lab/trial/scenario_trial.h"
#include "sim_board/random/random_stream.h"
#include "simulation/assembly/parameters.h"
#include "simulation/scenario/reader.h"

namespace koboshi::lab {
namespace {

constexpr double kStand_s = 0.5;      // before it is pushed, standing;
constexpr double kWalk_s = 3.0;       // and walking, at least
constexpr double kAftermath_s = 3.0;  // a robot of this height that is going to fall lies after one second
constexpr double kStillFall = 0.05;   // the share that falls if 95 of 100 survive

constexpr const char* kStanding = "standing";
constexpr const char* kWalking = "walking";
constexpr const char* kNothing = "nothing";

double cycle_s(const simulation::Scenario& scenario) {
  return 2.0 * 1e-3 * simulation::controller_values(scenario).walk.step.time_ms;
}

// A cell of the experiment.
struct PushCase {
  std::string state;
  std::string without;
  double direction_rad = 0.0;
};

std::vector<PushCase> cases_of(const PushRecoveryOptions& options) {
  std::vector<std::string> without{kNothing};
  without.insert(without.end(), options.ablate.begin(), options.ablate.end());
  std::vector<PushCase> cases;
  for (const std::string& state : options.states) {
    for (const std::string& name : without) {
      for (std::size_t i = 0; i < options.directions; ++i) {
        const double turn_rad = kTurn_rad * static_cast<double>(i);
        cases.push_back({state, name, turn_rad / static_cast<double>(options.directions)});
      }
    }
  }
  return cases;
}

StandingStart start_of(const PushRecoveryOptions& options, const std::string& without) {
  std::vector<Override> overrides = options.overrides;
  for (const Feedback& feedback : feedbacks()) {
    if (feedback.name != without) continue;
    for (const std::string& name : feedback.parameters) overrides.push_back({"parameters." + name, "0"});
  }
  return read_standing_start(options, overrides);
}

// The largest impulse that this robot survives in the seed's world.
PushTrial play(const PushCase& pushed, const StandingStart& start, const PushRecoveryOptions& options,
               const sim_board::RobotDescription& robot, std::uint64_t seed) {
  const bool walks = pushed.state == kWalking;
  sim_board::RandomStream random(seed, "phase of the push");
  PushTrial trial{.phase = random.uniform()};
  const double wait_s = walks ? kWalk_s + trial.phase * cycle_s(start.scenario) : kStand_s;
  const double for_s = wait_s + kPush_s + kAftermath_s;
  const double mass_kg = robot_in_world(start.scenario, robot, seed).total_mass_kg();
  const Eigen::Vector3d along(std::cos(pushed.direction_rad), std::sin(pushed.direction_rad), 0.0);
  const auto survives = [&](double impulse_N_s_per_kg) {
    simulation::Scenario scenario =
        walks ? start.walking(Eigen::Vector3d::Zero(), for_s) : start.standing(for_s);
    scenario.pushes = {half_sine_push(robot.links.front().name, start.ready_us + to_us(wait_s), kPush_s,
                                      impulse_N_s_per_kg * mass_kg * along)};
    const ScenarioTrial played = play_in_world(scenario, seed);
    if (!played.lost()) return true;
    // Each push that is lost is weaker than the one before: a bisection goes down from there.
    trial.lost_by = played.outcome;
    trial.error = played.error;
    return false;
  };
  trial.impulse_N_s_per_kg = largest_survived(options.highest_N_s_per_kg, options.halvings, survives);
  return trial;
}

// Returns the estimate of all trials, or the least of the estimates by phase.
QuantileEstimate survived_by_95_of_100(const std::vector<PushTrial>& trials, std::size_t bins) {
  std::vector<std::vector<double>> by_phase(bins);
  for (const PushTrial& trial : trials) {
    const auto bin = static_cast<std::size_t>(trial.phase * static_cast<double>(bins));
    by_phase[std::min(bin, bins - 1)].push_back(trial.impulse_N_s_per_kg);
  }
  QuantileEstimate least = estimate_quantile({}, kStillFall);
  for (const std::vector<double>& values : by_phase) {
    const QuantileEstimate estimate = estimate_quantile(values, kStillFall);
    if (estimate.count > 0 && (least.count == 0 || estimate.value < least.value)) least = estimate;
  }
  return least;
}

std::string degrees(double angle_rad) { return fmt::format("{:.1f}", angle_rad * 360.0 / kTurn_rad); }

std::string push_table(const std::vector<PushColumn>& columns, TableStyle style) {
  Row head{"pushed towards [deg]"};
  std::vector<Row> rows;
  for (const SurvivedPush& push : columns.front().directions) rows.push_back({degrees(push.direction_rad)});
  for (const PushColumn& column : columns) {
    head.push_back(column.label() + " [N s/kg]");
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const auto& [count, value, interval] = column.directions[i].impulse_N_s_per_kg;
      rows[i].push_back(
          count == 0 ? "-" : fmt::format("{:.3f} ({:.3f} .. {:.3f})", value, interval.low, interval.high));
    }
  }
  return table_text(head, rows, style);
}

// How the weakest pushes that were not survived ended, summed over directions and seeds.
std::string loss_table(const std::vector<PushColumn>& columns, TableStyle style) {
  Row head{"the weakest push that was not survived"};
  for (const Loss& loss : kLosses) head.push_back(*loss.label == '\0' ? loss.name : loss.label);
  std::vector<Row> rows;
  for (const PushColumn& column : columns) {
    Row& row = rows.emplace_back(Row{column.label()});
    for (const Loss& loss : kLosses) {
      const auto found = column.losses.find(loss.outcome);
      row.push_back(std::to_string(found == column.losses.end() ? 0 : found->second));
    }
  }
  return table_text(head, rows, style);
}

// The same for a state and the feedback that is off, whatever else is drawn.
int colour_of(const PushColumn& column) {
  const auto& states = pushed_states();
  const auto state = std::ranges::find(states, column.state) - states.begin();
  const auto off = std::ranges::find(feedbacks(), column.without, &Feedback::name) - feedbacks().begin();
  const auto row = column.without == kNothing ? 0 : off + 1;
  constexpr int kPalette = 7;  // the eighth is that of the rings
  return static_cast<int>((state + static_cast<std::ptrdiff_t>(states.size()) * row) % kPalette);
}

tools::PlaneCurve ring(double radius) {
  tools::PlaneCurve curve{.colour = 7, .width = 0.5};
  for (int i = 0; i <= 72; ++i) {
    const double angle_rad = kTurn_rad * i / 72;
    curve.points.push_back({radius * std::cos(angle_rad), radius * std::sin(angle_rad)});
  }
  return curve;
}

tools::PlaneFigure polar_figure(const std::vector<PushColumn>& columns) {
  std::size_t fewest = kEnoughFor95Of100;
  for (const PushColumn& column : columns) {
    for (const SurvivedPush& push : column.directions)
      fewest = std::min(fewest, push.impulse_N_s_per_kg.count);
  }
  const std::string who = fewest < kEnoughFor95Of100
                              ? fmt::format("Impulse that the weakest of {} seeds survives", fewest)
                              : "Impulses that 95 of 100 survive";
  tools::PlaneFigure figure{.title = who + " [N s/kg], by the direction of the push",
                            .x_label = "to the right",
                            .y_label = "forward"};
  for (const double radius : {0.1, 0.2, 0.3, 0.4}) figure.curves.push_back(ring(radius));
  for (const PushColumn& column : columns) {
    tools::PlaneCurve curve{
        .label = column.label(),
        .style = column.without == kNothing ? tools::LineStyle::kSolid : tools::LineStyle::kDashed,
        .colour = colour_of(column)};
    for (const auto& [direction_rad, impulse] : column.directions) {
      curve.points.push_back(
          {-impulse.value * std::sin(direction_rad), impulse.value * std::cos(direction_rad)});
    }
    curve.points.push_back(curve.points.front());
    figure.curves.push_back(std::move(curve));
  }
  return figure;
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

const FieldTable<PushTrial>& push_fields() {
  using T = PushTrial;
  static const FieldTable<T> kFields{
      Fields<T>{{{"impulse_N_s_per_kg", "survived [N s/kg]"}, &T::impulse_N_s_per_kg},
                {{"phase"}, &T::phase}},
      outcome_fields<T>(&T::lost_by)};
  return kFields;
}

Experiment make_push_recovery(const PushRecoveryOptions& options) {
  std::map<std::string, StandingStart> starts{{kNothing, start_of(options, kNothing)}};
  for (const std::string& name : options.ablate) starts.emplace(name, start_of(options, name));
  const simulation::Scenario& scenario = starts.at(kNothing).scenario;
  Experiment experiment = begin_experiment("push-recovery", "What pushes it survives", options, scenario,
                                           {{"highest_N_s_per_kg", options.highest_N_s_per_kg},
                                            {"halvings", static_cast<double>(options.halvings)}});
  const std::vector<PushCase> cases = cases_of(options);
  for (const auto& [state, without, direction_rad] : cases) {
    const std::string direction = degrees(direction_rad);
    experiment.cells.push_back({fmt::format("{}-without-{}-{}", state, without, direction),
                                {{"state", state}, {"without", without}, {"direction_deg", direction}}});
  }
  set_trials(experiment, push_fields(),
             [options, cases, robot = simulation::read_robot(scenario), starts](std::size_t cell,
                                                                                std::uint64_t seed) {
               return play(cases[cell], starts.at(cases[cell].without), options, robot, seed);
             });
  experiment.conclude = [options](const Experiment&, const ExperimentResult& result) {
    return push_recovery_conclusions(survived_pushes(options, result));
  };
  return experiment;
}

std::string PushColumn::label() const { return without == kNothing ? state : state + " without " + without; }

std::vector<PushColumn> survived_pushes(const PushRecoveryOptions& options, const ExperimentResult& result) {
  std::vector<PushColumn> columns;
  std::size_t cell = 0;
  for (const auto& [state, without, direction_rad] : cases_of(options)) {
    const std::vector<PushTrial> trials = push_fields().trials(result.cells.at(cell++));
    if (columns.empty() || columns.back().state != state || columns.back().without != without)
      columns.push_back({.state = state, .without = without});
    const std::size_t bins = state == kWalking ? options.phase_bins : 1;
    columns.back().directions.push_back({direction_rad, survived_by_95_of_100(trials, bins)});
    for (const PushTrial& trial : trials) {
      if (trial.lost_by) ++columns.back().losses[*trial.lost_by];
    }
  }
  return columns;
}

Conclusions push_recovery_conclusions(const std::vector<PushColumn>& columns) {
  Conclusions conclusions;
  conclusions.figure = polar_figure(columns);
  conclusions.table = [columns](TableStyle style) {
    return push_table(columns, style) + "\n" + loss_table(columns, style);
  };
  const auto impulse_of = [](const SurvivedPush& push) { return push.impulse_N_s_per_kg.value; };
  for (const PushColumn& column : columns) {
    const auto played = [](const SurvivedPush& push) { return push.impulse_N_s_per_kg.count > 0; };
    if (!std::ranges::all_of(column.directions, played)) {
      conclusions.lines += column.label() + ": some directions were not played\n";
      continue;
    }
    const auto& [direction_rad, impulse] = *std::ranges::min_element(column.directions, {}, impulse_of);
    const std::string who = impulse.count < kEnoughFor95Of100
                                ? fmt::format("the weakest of {} survives", impulse.count)
                                : fmt::format("95 of 100 survive, by {} seeds,", impulse.count);
    conclusions.lines += fmt::format("{}: {} {:.3f} N s/kg, the least towards {} degrees\n", column.label(),
                                     who, impulse.value, degrees(direction_rad));
    const std::string ablated = column.without == kNothing ? "" : "_without_" + column.without;
    const std::string key = column.state + ablated + "_min_Ns_per_kg";
    conclusions.values[key] = impulse.value;
    conclusions.values[key + "_seeds"] = impulse.count;
    conclusions.values[key + "_confidence_95"] = {impulse.confidence_95.low, impulse.confidence_95.high};
  }
  return conclusions;
}

}  // namespace koboshi::lab
