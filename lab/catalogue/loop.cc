#include "lab/catalogue/loop.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <utility>

#include "base/text/text.h"
#include "base/text/user_units.h"
#include "lab/trial/pushes.h"
#include "lab/trial/scenario_trial.h"

namespace koboshi::lab {
namespace {

constexpr double kBegin_s = 2.5;  // from the command to the sine: the walk has left its starting steps behind
constexpr double kSettle_s = 1.0;  // of the sine, before it is measured
constexpr double kPeriods = 8.0;   // of the measurement, at least

struct LoopCase {
  std::string state;
  std::string axis;
  double frequency_Hz = 0.0;
};

std::vector<LoopCase> cases_of(const LoopOptions& options) {
  std::vector<LoopCase> cases;
  for (const std::string& state : options.states) {
    for (const std::string& axis : options.axes) {
      for (const double frequency_Hz : options.frequencies_Hz) cases.push_back({state, axis, frequency_Hz});
    }
  }
  return cases;
}

// Whole periods, so that the correlation does not see a constant rate.
double measured_s(const LoopOptions& options, double frequency_Hz) {
  return std::ceil(std::max(kPeriods, options.shortest_s * frequency_Hz)) / frequency_Hz;
}

struct Response {
  ScenarioTrial trial;
  std::complex<double> rate{};  // of the trunk
};

// Plays one run with this sine at the gyro. The sine is a cosine of the simulated time.
Response respond(const LoopCase& played, const StandingStart& start, const LoopOptions& options,
                 double amplitude_rad_per_s, std::uint64_t seed) {
  const double begin_s = 1e-6 * static_cast<double>(start.ready_us) + kBegin_s;
  const double measure_s = begin_s + kSettle_s;
  const double end_s = measure_s + measured_s(options, played.frequency_Hz);
  const double for_s = end_s - 1e-6 * static_cast<double>(start.ready_us) + 0.01;
  const simulation::Scenario scenario = played.state == "walking"
                                            ? start.walking({options.speed_m_per_s, 0.0, 0.0}, for_s)
                                            : start.standing(for_s);
  const Eigen::Vector3d axis_L = played.axis == "pitch" ? Eigen::Vector3d::UnitY() : Eigen::Vector3d::UnitX();
  SineCorrelator rate(played.frequency_Hz);
  Response response;
  response.trial = watch_in_world(
      scenario, seed, [&](simulation::Simulation& simulation, const simulation::RunRecorder& recorder) {
        sim_board::SimBoard& board = simulation.board();
        const double now_s = board.world().time_s();
        const double next_s = now_s + 1e-6 * static_cast<double>(sim_board::SimBoard::kService_us);
        const double sine = std::cos(kTurn_rad * played.frequency_Hz * next_s);
        if (next_s >= begin_s) board.electronics().add_gyro_rate(amplitude_rad_per_s * sine * axis_L);
        if (now_s >= measure_s && now_s < end_s - 1e-9) {
          const sim_board::BodyState trunk = board.world().body(0);
          rate.add(now_s, (trunk.X_WL.linear() * axis_L).dot(trunk.w_WL_W));
        }
        return recorder.fell();
      });
  response.rate = rate.amplitude();
  return response;
}

LoopTrial play(const LoopCase& played, const StandingStart& start, const LoopOptions& options,
               std::uint64_t seed) {
  const double amplitude = kRadPerDegree * options.amplitude_deg_per_s;
  LoopTrial trial;
  std::complex<double> caused{};
  for (const double sign : {1.0, -1.0}) {
    const Response response = respond(played, start, options, sign * amplitude, seed);
    if (response.trial.lost()) return {.outcome = response.trial.outcome, .error = response.trial.error};
    caused += 0.5 * sign * response.rate;
  }
  const std::complex<double> gain = -caused / (caused + amplitude);
  trial.gain_real = gain.real();
  trial.gain_imaginary = gain.imag();
  return trial;
}

// The mean response of a state and an axis.
struct LoopCurve {
  std::string name;
  std::vector<LoopPoint> points;
};

std::vector<LoopCurve> curves_of(const LoopOptions& options, const ExperimentResult& result) {
  std::vector<LoopCurve> curves;
  std::size_t cell = 0;
  for (const auto& [state, axis, frequency_Hz] : cases_of(options)) {
    const std::string name = state + ", " + axis;
    if (curves.empty() || curves.back().name != name) curves.push_back({name, {}});
    const std::vector<LoopTrial> trials = loop_fields().trials(result.cells.at(cell++));
    const MeanEstimate real = mean_of(trials, &LoopTrial::gain_real);
    if (real.count == 0) continue;
    curves.back().points.push_back(
        {frequency_Hz, {real.mean, mean_of(trials, &LoopTrial::gain_imaginary).mean}});
  }
  return curves;
}

tools::PanelGrid bode_plot(const std::vector<LoopCurve>& curves) {
  tools::PanelGrid grid{
      .title = "Open loop of the balance feedback, broken at the gyro",
      .columns = 1,
      .panel_height_px = 320,
      .panels = {{.x_label = "frequency [Hz]", .y_label = "gain", .log_x = true, .log_y = true},
                 {.x_label = "frequency [Hz]", .y_label = "phase [deg]", .log_x = true}}};
  for (std::size_t i = 0; i < curves.size(); ++i) {
    tools::PlaneCurve gain{
        .label = curves[i].name, .style = tools::LineStyle::kLinesPoints, .colour = static_cast<int>(i)};
    tools::PlaneCurve phase = gain;
    const std::vector<double> phases = unwrapped_phases_deg(curves[i].points);
    for (std::size_t j = 0; j < phases.size(); ++j) {
      gain.points.push_back({curves[i].points[j].frequency_Hz, std::abs(curves[i].points[j].gain)});
      phase.points.push_back({curves[i].points[j].frequency_Hz, phases[j]});
    }
    grid.panels[0].curves.push_back(std::move(gain));
    grid.panels[1].curves.push_back(std::move(phase));
  }
  return grid;
}

std::string or_none(const std::optional<double>& value, const char* unit) {
  return value ? fmt::format("{:.2f}{}", *value, unit) : std::string("none");
}

nlohmann::ordered_json or_null(const std::optional<double>& value) {
  return value ? nlohmann::ordered_json(*value) : nlohmann::ordered_json();
}

std::string loop_table(const std::vector<LoopCurve>& curves, TableStyle style) {
  std::vector<Row> points;
  for (const LoopCurve& curve : curves) {
    const std::vector<double> phases = unwrapped_phases_deg(curve.points);
    for (std::size_t i = 0; i < phases.size(); ++i) {
      points.push_back({curve.name, number_text(curve.points[i].frequency_Hz),
                        fmt::format("{:.3f}", std::abs(curve.points[i].gain)),
                        fmt::format("{:.0f}", phases[i])});
    }
  }
  std::vector<Row> margins;
  for (const LoopCurve& curve : curves) {
    if (curve.points.size() < 2) continue;
    const LoopMargins found = margins_of(curve.points);
    margins.push_back({curve.name, or_none(found.crossover_Hz, " Hz"),
                       or_none(found.phase_margin_deg, " deg"), or_none(found.phase_crossover_Hz, " Hz"),
                       or_none(found.gain_margin, ""), fmt::format("{:.2f}", found.distance)});
  }
  return table_text({"loop", "gain crossover", "phase margin", "phase crossover", "gain margin",
                     "least distance from -1"},
                    margins, style) +
         "\n" + table_text({"loop", "frequency [Hz]", "gain", "phase [deg]"}, points, style);
}

Conclusions conclude(const LoopOptions& options, const ExperimentResult& result) {
  const std::vector<LoopCurve> curves = curves_of(options, result);
  Conclusions conclusions;
  for (const LoopCurve& curve : curves) {
    if (curve.points.size() < 2) continue;
    const LoopMargins margins = margins_of(curve.points);
    conclusions.values[curve.name] = {{"crossover_Hz", or_null(margins.crossover_Hz)},
                                      {"phase_margin_deg", or_null(margins.phase_margin_deg)},
                                      {"phase_crossover_Hz", or_null(margins.phase_crossover_Hz)},
                                      {"gain_margin", or_null(margins.gain_margin)},
                                      {"distance", margins.distance}};
  }
  conclusions.table = [curves](TableStyle style) { return loop_table(curves, style); };
  conclusions.grids.push_back({"bode", bode_plot(curves)});
  return conclusions;
}

}  // namespace

const FieldTable<LoopTrial>& loop_fields() {
  using T = LoopTrial;
  static const FieldTable<T> kFields{
      outcome_fields<T>(&T::outcome),
      Fields<T>{{{"gain_real"}, &T::gain_real}, {{"gain_imaginary"}, &T::gain_imaginary}}};
  return kFields;
}

Experiment make_loop(const LoopOptions& options) {
  const StandingStart start = read_standing_start(options, options.overrides);
  require_permitted_speed("--speed", options.speed_m_per_s, start.scenario);
  Experiment experiment =
      begin_experiment("loop", "The loop of the balance feedback", options, start.scenario,
                       {{"amplitude_deg_per_s", options.amplitude_deg_per_s},
                        {"speed_m_per_s", options.speed_m_per_s},
                        {"shortest_s", options.shortest_s}});
  const std::vector<LoopCase> cases = cases_of(options);
  for (const auto& [state, axis, frequency_Hz] : cases) {
    const std::string frequency = number_text(frequency_Hz);
    experiment.cells.push_back({fmt::format("{}-{}-{}", state, axis, frequency),
                                {{"state", state}, {"axis", axis}, {"frequency_Hz", frequency}}});
  }
  set_trials(experiment, loop_fields(), [options, cases, start](std::size_t cell, std::uint64_t seed) {
    return play(cases[cell], start, options, seed);
  });
  experiment.conclude = [options](const Experiment&, const ExperimentResult& result) {
    return conclude(options, result);
  };
  return experiment;
}

}  // namespace koboshi::lab
