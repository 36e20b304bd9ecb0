#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lab/validate/servo_trial.h"
#include "lab/validate/validation.h"
#include "tools/plot/legend.h"

namespace koboshi::lab {
namespace {

double largest_magnitude(const std::vector<double>& values) {
  double most = 0.0;
  for (const double value : values) most = std::max(most, std::abs(value));
  return most;
}

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double most = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) most = std::max(most, std::abs(a[i] - b[i]));
  return most;
}

ServoTrial step_of(double target_rad) {
  ServoTrial trial;
  trial.target_rad = [target_rad](double) { return target_rad; };
  return trial;
}

ServoTrial sine_of(double amplitude_rad, double frequency_Hz) {
  ServoTrial trial;
  trial.duration_s = 1.0;
  trial.target_rad = [=](double time_s) {
    return amplitude_rad * std::sin(2.0 * std::numbers::pi * frequency_Hz * time_s);
  };
  return trial;
}

// The tolerance includes a count of the encoder, whose rounding may fall to either side.
void check_motion(const std::string& what, const ServoTrial& trial, const ValidationSetup& setup,
                  Findings& findings) {
  const ServoMotion exact = reference(trial);
  const ServoMotion found = simulated(trial, setup);
  const double count_rad = 2.0 * std::numbers::pi / std::ldexp(1.0, trial.encoder_bits);
  findings.check(what + ": largest position error", "rad", 0.0,
                 largest_difference(found.position_rad, exact.position_rad),
                 setup.world.step_s * largest_magnitude(exact.speed_rad_per_s) + count_rad);
}

Plot motion_figure(const std::string& name, const std::string& title, const std::string& caption,
                   const ServoTrial& trial, const ValidationSetup& setup) {
  const ServoMotion exact = reference(trial);
  const ServoMotion found = simulated(trial, setup);
  std::vector<double> target_rad, error_mrad;
  for (std::size_t i = 0; i < exact.time_s.size(); ++i) {
    target_rad.push_back(trial.target_rad(exact.time_s[i]));
    error_mrad.push_back(1e3 * (found.position_rad[i] - exact.position_rad[i]));
  }
  return {
      .name = name,
      .caption = caption,
      .columns = {{"time_s", exact.time_s},
                  {"target_rad", target_rad},
                  {"simulated_rad", found.position_rad},
                  {"reference_rad", exact.position_rad},
                  {"error_mrad", error_mrad}},
      .figure = {.title = title,
                 .panels = {{.y_label = "position [rad]",
                             .series = {tools::series(tools::Role::kPlanned, "target_rad", "target"),
                                        tools::series(tools::Role::kTrue, "simulated_rad", "simulated"),
                                        tools::series(tools::Role::kTheory, "reference_rad", "Runge-Kutta")}},
                            {.y_label = "error [mrad]", .series = {{.column = "error_mrad"}}}}}};
}

// Steady speed at full supply under loads from zero to near stall.
void check_line(const ValidationSetup& setup, Findings& findings) {
  Plot plot{.name = "torque-speed",
            .caption = "The motor's line at 7.5 V, less friction: every simulated point lies on it.",
            .columns = {{"load_Nm", {}}, {"simulated", {}}, {"theory", {}}},
            .figure = {.title = "Torque-speed line of the servo, full supply",
                       .panels = {{.y_label = "steady speed [rad/s]",
                                   .series = {tools::series(tools::Role::kTheory, "theory", "theory"),
                                              {.column = "simulated",
                                               .label = "simulated",
                                               .style = tools::LineStyle::kPoints,
                                               .colour = tools::colour_of(tools::Role::kTrue)}}}},
                       .x_column = "load_Nm",
                       .x_label = "load against the motion [N m]"}};
  for (const double load_Nm : {0.0, 0.3, 0.6, 0.9, 1.2}) {
    ServoTrial trial = step_of(100.0);
    trial.load_Nm = -load_Nm;
    const double theory = steady_speed_rad_per_s(trial.servo, -load_Nm);
    const double found = simulated(trial, setup).speed_rad_per_s.back();
    findings.check(fmt::format("steady speed against {} N m", load_Nm), "rad/s", theory, found,
                   1e-6 * steady_speed_rad_per_s(trial.servo, 0.0));
    plot.columns[0].second.push_back(load_Nm);
    plot.columns[1].second.push_back(found);
    plot.columns[2].second.push_back(theory);
  }
  findings.plots.push_back(plot);
}

Findings run_servo_response(const ValidationSetup& setup) {
  Findings findings;
  for (const double target_rad : {0.1, 0.5, 1.5}) {
    check_motion(fmt::format("step of {} rad", target_rad), step_of(target_rad), setup, findings);
  }
  for (const double frequency_Hz : {1.0, 4.0}) {
    check_motion(fmt::format("sine of 0.3 rad, {} Hz", frequency_Hz), sine_of(0.3, frequency_Hz), setup,
                 findings);
  }
  ServoTrial real = step_of(0.5);
  real.encoder_bits = 12;
  check_motion("step of 0.5 rad, encoder of 12 bits", real, setup, findings);
  findings.plots.push_back(motion_figure("servo-step", "Step of 1.5 rad",
                                         "Full voltage and nearly no-load speed, then the position loop; the "
                                         "error is that of the implicit back EMF.",
                                         step_of(1.5), setup));
  findings.plots.push_back(
      motion_figure("servo-sine", "Sine of 0.3 rad at 4 Hz",
                    "The servo lags as the equations say, its voltage saturated on the steepest part.",
                    sine_of(0.3, 4.0), setup));
  check_line(setup, findings);
  return findings;
}

}  // namespace

double servo_error_rad(const ValidationSetup& setup) {
  const ServoTrial trial = step_of(0.5);
  return largest_difference(simulated(trial, setup).position_rad, reference(trial).position_rad);
}

Validation servo_response() {
  return {
      .name = "servo",
      .title = "Servo responses",
      .theory =
          "Rhoban BAM (arXiv 2410.08650), friction model M1, with the default servo: (J + J_link) w' = kt "
          "(V - kt w)/R - Kv w - Kc sgn w + load, V = clip(k e, 7.5 V) held for a millisecond, integrated "
          "by Runge-Kutta in steps of 2 us; J_link = 1e-4 kg m^2. At the full supply w = (kt V/R - load - "
          "Kc)/(kt^2/R + Kv).",
      .tolerances =
          "An implicit method of first order is late by at most a step: h times the largest speed, and "
          "a count of the encoder, whose rounding may fall to either side. A steady speed does not "
          "depend on the step: 1e-6 of the no-load speed.",
      .run = run_servo_response};
}

}  // namespace koboshi::lab
