#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "lab/validate/rigs.h"
#include "lab/validate/validation.h"
#include "sim_board/servo/encoder.h"
#include "simulation/assembly/simulation.h"

namespace koboshi::lab {
namespace {

const std::vector<double> kSteps_ms{1.0, 0.5, 0.1, 0.05};

struct Subject {
  std::string name;
  std::function<double(const ValidationSetup&)> error;  // of any unit
};

ValidationSetup at_step(ValidationSetup setup, double step_ms) {
  setup.world.step_s = 1e-3 * step_ms;
  return setup;
}

// Relative to the largest.
std::vector<double> relative(const std::vector<double>& errors) {
  std::vector<double> result;
  for (const double error : errors) result.push_back(error / errors.front());
  return result;
}

void add_curve(Plot& plot, const std::string& name, const std::vector<double>& values,
               tools::LineStyle style) {
  plot.columns.emplace_back(name, values);
  plot.figure.panels[0].series.push_back({.column = name, .label = name, .style = style});
}

void check_known(const ValidationSetup& setup, Findings& findings, Plot& plot) {
  const std::vector<Subject> subjects{{"free fall", free_fall_error_m},
                                      {"pendulum", pendulum_error_rad},
                                      {"inverted pendulum", inverted_pendulum_error_m},
                                      {"servo step", servo_error_rad}};
  for (const Subject& subject : subjects) {
    std::vector<double> errors;
    for (const double step_ms : kSteps_ms) {
      errors.push_back(std::abs(subject.error(at_step(setup, step_ms))));
    }
    findings.check(subject.name + ": order of convergence", "1", 1.0, observed_order(kSteps_ms, errors), 0.1);
    add_curve(plot, subject.name, relative(errors), tools::LineStyle::kLinesPoints);
  }
}

// The trunk's height at each tick of a squat. The encoders have the resolution of the bus: rounding to 12
// bits would hide the effect of the step.
struct Heights {
  std::vector<double> time_s;
  std::vector<double> height_m;
};
Heights squat_heights(const ValidationSetup& setup) {
  simulation::Simulation simulation(squat_scenario(setup), simulation::in_process(),
                                    [](sim_board::RobotDescription& robot) {
                                      for (sim_board::JointDescription& joint : robot.joints)
                                        joint.encoder.bits = sim_board::kPositionBits;
                                    });
  const std::uint64_t end_us = kSquatBegins_us + (setup.short_form ? 500'000 : 2'000'000);
  Heights heights;
  while (simulation.board().now_us() < end_us) {
    simulation.advance();
    const std::uint64_t now_us = simulation.board().now_us();
    if (now_us < kSquatBegins_us || now_us % sim_board::SimBoard::kTick_us != 0) continue;
    heights.time_s.push_back(1e-6 * static_cast<double>(now_us));
    heights.height_m.push_back(simulation.board().world().body(0).X_WL.translation().z());
  }
  return heights;
}

double rms_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return std::sqrt(sum / static_cast<double>(a.size()));
}

double fastest_m_per_s(const Heights& heights) {
  double fastest = 0.0;
  for (std::size_t i = 1; i < heights.time_s.size(); ++i) {
    fastest = std::max(fastest, std::abs(heights.height_m[i] - heights.height_m[i - 1]) /
                                    (heights.time_s[i] - heights.time_s[i - 1]));
  }
  return fastest;
}

// The exact motion of a squat is unknown: compares with the finest step. An error c h then shows as
// c (h - h_finest).
void check_squat(const ValidationSetup& setup, Findings& findings, Plot& plot) {
  const std::vector<double> steps_ms = setup.short_form ? std::vector{1.0, 0.5, 0.25} : kSteps_ms;
  std::vector<Heights> runs;
  for (const double step_ms : steps_ms) runs.push_back(squat_heights(at_step(setup, step_ms)));
  const Heights& finest = runs.back();
  std::vector<double> distances_ms, errors_m;
  Plot heights{
      .name = "squat",
      .caption = "The whole robot's squat at four steps; the heights differ by micrometres.",
      .columns = {{"time_s", finest.time_s}},
      .figure = {.title = "Squat at different time steps",
                 .panels = {{.y_label = "trunk height [mm]"}, {.y_label = "against the finest [um]"}}}};
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const std::string label = fmt::format("{} ms", steps_ms[i]);
    std::vector<double> height_mm, off_um;
    for (std::size_t k = 0; k < finest.time_s.size(); ++k) {
      height_mm.push_back(1e3 * runs[i].height_m[k]);
      off_um.push_back(1e6 * (runs[i].height_m[k] - finest.height_m[k]));
    }
    heights.columns.emplace_back("height_mm at " + label, height_mm);
    heights.figure.panels[0].series.push_back({.column = "height_mm at " + label, .label = label});
    if (i + 1 == runs.size()) break;
    heights.columns.emplace_back("off_um at " + label, off_um);
    heights.figure.panels[1].series.push_back({.column = "off_um at " + label, .label = label});
    distances_ms.push_back(steps_ms[i] - steps_ms.back());
    errors_m.push_back(rms_difference(runs[i].height_m, finest.height_m));
    findings.check(fmt::format("squat: height at {} ms against {} ms, RMS", steps_ms[i], steps_ms.back()),
                   "m", 0.0, errors_m.back(), 1e-3 * steps_ms[i] * fastest_m_per_s(finest));
  }
  findings.check("squat: order of convergence", "1", 1.0, observed_order(distances_ms, errors_m), 0.5);
  findings.plots.push_back(heights);
  if (setup.short_form) return;
  std::vector<double> shown = relative(errors_m);
  shown.push_back(std::nan(""));
  add_curve(plot, "squat against the finest", shown, tools::LineStyle::kLinesPoints);
}

Findings run_convergence(const ValidationSetup& setup) {
  Findings findings;
  Plot plot{
      .name = "convergence",
      .caption =
          "Errors relative to those at 1 ms: all fall with the first power of the step. The squat is held to "
          "its finest step, so that at 0.1 ms half of its error is not seen.",
      .columns = {{"step_ms", kSteps_ms}},
      .figure = {.title = "Error against time step, relative to 1 ms",
                 .panels = {{.y_label = "relative error"}},
                 .x_column = "step_ms",
                 .x_label = "time step [ms]",
                 .log_log = true}};
  check_known(setup, findings, plot);
  check_squat(setup, findings, plot);
  add_curve(plot, "first order", kSteps_ms, tools::LineStyle::kDashed);
  findings.plots.insert(findings.plots.begin(), plot);
  return findings;
}

}  // namespace

double observed_order(const std::vector<double>& steps, const std::vector<double>& errors) {
  double x_mean = 0.0, y_mean = 0.0;
  const double count = static_cast<double>(steps.size());
  for (std::size_t i = 0; i < steps.size(); ++i) {
    x_mean += std::log(steps[i]) / count;
    y_mean += std::log(errors[i]) / count;
  }
  double xy = 0.0, xx = 0.0;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const double x = std::log(steps[i]) - x_mean;
    xy += x * (std::log(errors[i]) - y_mean);
    xx += x * x;
  }
  return xy / xx;
}

Validation convergence() {
  return {
      .name = "convergence",
      .title = "Convergence with the time step",
      .theory =
          "Semi-implicit Euler is of first order: halving the step halves the error. Steps of 1, 0.5, 0.1 "
          "and 0.05 ms whatever `--step-ms` says, the ground's stiffness and damping held (ERP and CFM "
          "follow from them; encoders of 20 bits). Errors: the fall after 0.5 s, the angle of a pendulum let "
          "go at 1.5 rad after "
          "1 s, the mass on a massless leg after 0.4 s, the largest error of a servo's step of 0.5 rad; of "
          "the whole robot's squat the trunk's height, RMS over a squat, against the finest step, whose own "
          "error is taken off: c h shows as c (h - h_finest).",
      .tolerances =
          "Order: 0.1 for terms of second order; 0.5 for the squat, whose joints stick and slip. "
          "Heights: a step late, h times the trunk's largest speed.",
      .run = run_convergence};
}

}  // namespace koboshi::lab
