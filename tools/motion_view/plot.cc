#include "tools/motion_view/plot.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>
#include <system_error>

#include <fmt/format.h>

#include "base/file/output_file.h"
#include "base/text/error.h"
#include "base/text/foreign_text.h"
#include "base/text/user_units.h"
#include "tools/plot/figure.h"
#include "tools/plot/legend.h"

namespace koboshi::tools {
namespace {

constexpr std::size_t kMaxJoints = 6;
constexpr double kLeastRange_rad = 0.001;  // two units of a 14-bit angle are 0.00077
constexpr double kMaxMargin_m = 0.08;      // more on either side is not shown
constexpr double kPercent = 100.0;

// The joints with the largest ranges of those that move, at least one, in the robot's order.
std::vector<std::size_t> moving_joints(const Trajectory& trajectory) {
  std::vector<double> ranges_rad(trajectory.joints);
  for (std::size_t j = 0; j < trajectory.joints; ++j) {
    double low = std::numeric_limits<double>::infinity();
    double high = -low;
    for (std::size_t tick = 0; tick < trajectory.ticks(); ++tick) {
      low = std::min(low, trajectory.row(tick)[j]);
      high = std::max(high, trajectory.row(tick)[j]);
    }
    ranges_rad[j] = high - low;
  }
  std::vector<std::size_t> joints(trajectory.joints);
  std::iota(joints.begin(), joints.end(), 0U);
  std::ranges::stable_sort(joints,
                           [&](std::size_t a, std::size_t b) { return ranges_rad[a] > ranges_rad[b]; });
  joints.resize(std::min(joints.size(), kMaxJoints));
  while (joints.size() > 1 && ranges_rad[joints.back()] < kLeastRange_rad) joints.pop_back();
  std::ranges::sort(joints);
  return joints;
}

Columns columns_of_motion(MotionChecker const& checker, const std::vector<std::size_t>& joints) {
  const Trajectory& trajectory = checker.trajectory();
  std::vector<std::string> names{"time_s", "speed",   "torque",   "zmp_m",
                                 "com_m",  "close_m", "beyond_m", "edge_m"};
  for (const std::size_t joint : joints) names.push_back(checker.robot().joints[joint].name);
  Columns columns = make_columns(names);
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  for (std::size_t tick = 0; tick < trajectory.ticks(); ++tick) {
    const TickState& state = checker.states()[tick];
    double speed = 0.0;
    for (std::size_t j = 0; tick > 0 && j < trajectory.joints; ++j) {
      const double change_rad = std::abs(trajectory.row(tick)[j] - trajectory.row(tick - 1)[j]);
      speed = std::max(speed, change_rad / kTick_s / checker.robot().joints[j].max_speed_rad_per_s);
    }
    const bool judged = trajectory.on_feet[tick];
    const auto shown = [&](const Margin& margin) {
      return judged ? std::clamp(margin.distance_m, -kMaxMargin_m, kMaxMargin_m) : kNaN;
    };
    std::vector<double> row{static_cast<double>(tick) * kTick_s,
                            speed,
                            judged ? state.torque.share : kNaN,
                            shown(state.zmp),
                            shown(state.com),
                            CheckLimits::kClose_m,
                            -CheckLimits::kBeyond_m,
                            0.0};
    for (const std::size_t joint : joints) row.push_back(trajectory.row(tick)[joint]);
    add_row(columns, row);
  }
  return columns;
}

}  // namespace

void plot_motion(const MotionReport& report, const MotionChecker& checker, const std::filesystem::path& out) {
  if (extension_of(out) != ".png" && extension_of(out) != ".svg")
    throw InputError(out, 0, "a picture '" + out.filename().string() + "'",
                     "a name that ends in .png or .svg");
  const std::vector<std::size_t> joints = moving_joints(checker.trajectory());
  Figure figure{.title = fmt::format("Motion {}: {}", report.name,
                                     kBalanceNames[static_cast<std::size_t>(report.balance)])};
  Panel angles{.y_label = "target [deg]", .smallest_span = 2.0};
  for (const std::size_t joint : joints) {
    const std::string& name = checker.robot().joints[joint].name;
    angles.series.push_back({.column = name, .label = name, .factor = kDegreesPerRad});
  }
  figure.panels.push_back(angles);
  figure.panels.push_back(
      {.y_label = "share of limit [%]",
       .series = {series(Role::kFirst, "speed", "speed, fastest joint", kPercent),
                  series(Role::kPlanned, "torque", "torque at the lowest supply, worst joint", kPercent)},
       .smallest_span = 20.0});
  Series close = series(Role::kTheory, "close_m", "close to the edge", kMmPerM);
  Series beyond = series(Role::kTheory, "beyond_m", "", kMmPerM);
  Series edge = series(Role::kTrue, "edge_m", "edge of the support polygon", kMmPerM);
  figure.panels.push_back(
      {.y_label = "margin [mm]",
       .series = {series(Role::kPlanned, "zmp_m", "ZMP", kMmPerM),
                  series(Role::kFirst, "com_m", "centre of mass", kMmPerM), edge, close, beyond},
       .smallest_span = 20.0});
  if (!report.paths.empty()) {
    for (const Finding& finding : report.paths.front().findings)
      figure.marks.push_back({finding.time_s, finding.code});
  }
  // draw() makes both kinds of picture; the other one goes.
  const std::filesystem::path base = std::filesystem::path(out).replace_extension(".drawing");
  draw(figure, columns_of_motion(checker, joints), base);
  std::error_code failed;
  for (const char* const extension : {".png", ".svg"}) {
    const std::filesystem::path drawn = base.string() + extension;
    if (extension_of(out) == extension)
      std::filesystem::rename(drawn, out, failed);
    else
      std::filesystem::remove(drawn);
  }
  if (failed) throw WriteError(out, failed.value());
}

}  // namespace koboshi::tools
