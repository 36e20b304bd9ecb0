#include "tools/motion_check/text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/text/user_units.h"

namespace koboshi::tools {
namespace {

using nlohmann::ordered_json;

double rounded(double value, double unit) { return std::round(value / unit) * unit; }

StepPlace place_of(const MotionReport& report, std::uint16_t step) {
  return step < report.places.size() ? report.places[step] : StepPlace{};
}

double max_speed_deg_per_s(const MotionChecker& checker, const JointShare& speed) {
  return speed.share * checker.robot().joints[speed.joint].max_speed_rad_per_s * kDegreesPerRad;
}

std::string step_table(const MotionReport& report, const MotionChecker& checker) {
  std::string text =
      "step  line  what                  start  lasts  margin  fastest joint                  torque\n"
      "                                    [s]    [s]    [mm]  [deg/s]                           [%]\n";
  for (const PathReport& path : report.paths) {
    for (const StepReport& step : path.steps) {
      const StepPlace place = place_of(report, step.step);
      const std::string margin =
          std::isfinite(step.least_margin_m) ? fmt::format("{:.1f}", step.least_margin_m * kMmPerM) : "-";
      const std::string speed = step.speed.share > 0.0
                                    ? fmt::format("{:5.0f} {}", max_speed_deg_per_s(checker, step.speed),
                                                  checker.robot().joints[step.speed.joint].name)
                                    : "    -";
      const std::string torque = step.torque.share > 0.0
                                     ? fmt::format("{:4.0f} {}", 100.0 * step.torque.share,
                                                   checker.robot().joints[step.torque.joint].name)
                                     : "   -";
      text +=
          fmt::format("{:>4}  {:>4}  {:<20}  {:>5.2f}  {:>5.2f}  {:>6}  {:<27}  {}\n", step.step, place.line,
                      place.text.substr(0, 20), step.start_s, step.duration_s, margin, speed, torque);
    }
    if (report.paths.size() > 1 && &path != &report.paths.back()) text += "\n";
  }
  return text;
}

std::string count(std::size_t number, const char* noun) {
  return fmt::format("{} {}{}", number, noun, number == 1 ? "" : "s");
}

std::string verdict_text(const MotionReport& report) {
  std::string text(kBalanceNames[static_cast<std::size_t>(report.balance)]);
  if (report.balance == Balance::kNotJudged) return text + ": the motion is not for a standing robot";
  const StepPlace place = place_of(report, report.least_margin_step);
  return text + fmt::format(": least margin {:.1f} mm at {:.2f} s, line {}, {}",
                            report.least_margin_m * kMmPerM, report.least_margin_s, place.line, place.text);
}

}  // namespace

std::string report_text(const MotionReport& report, const MotionChecker& checker, bool steps) {
  std::string text = simulation::print(report.diagnostics);
  if (steps) text += step_table(report, checker);
  const auto errors = static_cast<std::size_t>(std::ranges::count(
      report.diagnostics, simulation::Severity::kError, &simulation::Diagnostic::severity));
  const auto warnings = static_cast<std::size_t>(std::ranges::count(
      report.diagnostics, simulation::Severity::kWarning, &simulation::Diagnostic::severity));
  text += fmt::format("{}: {}, {}{:.2f} s{}, {} of {} joints, {}, {}\n", report.file.string(), report.name,
                      report.duration_cut ? "more than " : "", report.duration_s,
                      report.endless ? " with two rounds of endless loops" : "", report.joints.size(),
                      checker.robot().joints.size(), count(errors, "error"), count(warnings, "warning"));
  return text + verdict_text(report) + "\n";
}

std::string report_json(const MotionReport& report, const MotionChecker& checker) {
  ordered_json json;
  json["file"] = report.file.string();
  json["name"] = report.name;
  json["verdict"] = kBalanceNames[static_cast<std::size_t>(report.balance)];
  if (report.balance == Balance::kNotJudged)
    json["least_margin_mm"] = nullptr;
  else
    json["least_margin_mm"] = rounded(report.least_margin_m * kMmPerM, 0.01);
  json["least_margin_s"] = rounded(report.least_margin_s, kTick_s);
  json["duration_s"] = rounded(report.duration_s, kTick_s);
  json["duration_cut"] = report.duration_cut;
  json["endless"] = report.endless;
  json["paths"] = report.paths.size();
  json["paths_cut"] = report.cut;
  json["joints"] = report.joints;
  json["findings"] = ordered_json::parse(simulation::json_text(report.diagnostics));
  json["steps"] = ordered_json::array();
  for (std::size_t path = 0; path < report.paths.size(); ++path) {
    for (const StepReport& step : report.paths[path].steps) {
      const StepPlace place = place_of(report, step.step);
      ordered_json row{{"path", path},
                       {"step", step.step},
                       {"line", place.line},
                       {"text", place.text},
                       {"start_s", rounded(step.start_s, kTick_s)},
                       {"duration_s", rounded(step.duration_s, kTick_s)}};
      if (std::isfinite(step.least_margin_m))
        row["least_margin_mm"] = rounded(step.least_margin_m * kMmPerM, 0.01);
      row["fastest_joint"] = checker.robot().joints[step.speed.joint].name;
      row["fastest_deg_per_s"] = rounded(max_speed_deg_per_s(checker, step.speed), 0.1);
      row["torque_joint"] = checker.robot().joints[step.torque.joint].name;
      row["torque_percent"] = rounded(100.0 * step.torque.share, 0.1);
      json["steps"].push_back(std::move(row));
    }
  }
  return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace koboshi::tools
