#include "tools/run/walk_figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "base/text/user_units.h"
#include "firmware/behaviour/behaviour.h"
#include "sim_board/world/foot.h"
#include "sim_board/world/gravity.h"
#include "sim_board/world/support_polygon.h"
#include "simulation/assembly/parameters.h"
#include "tools/plot/legend.h"

namespace koboshi::tools {
namespace {
constexpr double kShownCycles = 3.0;
constexpr double kLongWalk = 6.0;  // cycles
// Minimum duration of a stance, and of a gap between two stances.
constexpr double kStance_s = 0.05;
constexpr double kWordFromHeel_m = 0.012;

constexpr double kMinLoadShare = 0.1;  // of the weight; a ZMP under less load is noise
using sim_board::kGravity_m_per_s2;
constexpr int kOutlineColour = 7;

// A range of rows.
struct Rows {
  std::size_t begin = 0;
  std::size_t end = 0;
};

Rows rows_within(const std::vector<double>& times_s, Span span) {
  const auto begin = std::ranges::lower_bound(times_s, span.low);
  const auto end = std::ranges::upper_bound(times_s, span.high);
  return {static_cast<std::size_t>(begin - times_s.begin()), static_cast<std::size_t>(end - times_s.begin())};
}

std::vector<Rows> stances(const std::vector<double>& times_s, const std::vector<double>& loads_N,
                          Rows shown) {
  std::vector<Rows> found;
  for (std::size_t row = shown.begin; row < shown.end; ++row) {
    if (loads_N[row] < sim_board::kLoaded_N) continue;
    const bool goes_on = !found.empty() && times_s[row] - times_s[found.back().end - 1] < kStance_s;
    if (!goes_on) found.push_back({row, row});
    found.back().end = row + 1;
  }
  std::erase_if(
      found, [&](const Rows& stance) { return times_s[stance.end - 1] - times_s[stance.begin] < kStance_s; });
  return found;
}

std::vector<Eigen::Vector2d> outline_in_sole(const sim_board::Foot& foot) {
  std::vector<Eigen::Vector2d> corners_m;
  for (const Eigen::Vector3d& corner_L : foot.corners_L) {
    corners_m.push_back((foot.X_LSole.inverse() * corner_L).head<2>());
  }
  return sim_board::convex_hull(corners_m);
}

void add_footprints(PlaneFigure& figure, const Columns& trace, const sim_board::Foot& foot,
                    const std::string& side, Rows shown) {
  const std::vector<Eigen::Vector2d> outline_m = outline_in_sole(foot);
  // Near the heel, where the ZMP rarely is.
  const double heel_m = std::ranges::min(outline_m, {}, [](const auto& p) { return p.x(); }).x();
  const Eigen::Vector2d word_S_m(heel_m + kWordFromHeel_m, 0.0);
  const std::string sole = "true_" + side + "_sole_";
  for (const Rows& stance :
       stances(values_of(trace, "time_s"), values_of(trace, "true_" + side + "_load_N"), shown)) {
    const std::size_t middle = (stance.begin + stance.end) / 2;
    const Eigen::Translation2d p_W_m(values_of(trace, sole + "x_m")[middle],
                                     values_of(trace, sole + "y_m")[middle]);
    const Eigen::Rotation2Dd yaw(values_of(trace, sole + "yaw_rad")[middle]);
    const auto place = [&](const Eigen::Vector2d& p_S_m) {
      const Eigen::Vector2d at_mm = kMmPerM * (p_W_m * (yaw * p_S_m));
      return Point{at_mm.x(), at_mm.y()};
    };
    Outline footprint{.colour = kOutlineColour, .word = side, .word_at = place(word_S_m)};
    for (const Eigen::Vector2d& corner_m : outline_m) footprint.corners.push_back(place(corner_m));
    figure.outlines.push_back(footprint);
  }
}

// The course of a point. Leaves gaps where the loads together are below `min_N`.
std::vector<Point> path_mm(const Columns& trace, const std::string& name, Rows shown,
                           const std::vector<std::string>& loads = {}, double min_N = 0.0) {
  const std::vector<double>& x_m = values_of(trace, name + "_x_m");
  const std::vector<double>& y_m = values_of(trace, name + "_y_m");
  std::vector<Point> points;
  for (std::size_t row = shown.begin; row < shown.end; ++row) {
    double load_N = 0.0;
    for (const std::string& load : loads) load_N += values_of(trace, load)[row];
    const double factor = load_N >= min_N ? kMmPerM : std::numeric_limits<double>::quiet_NaN();
    points.push_back({factor * x_m[row], factor * y_m[row]});
  }
  return points;
}

void add_path(PlaneFigure& figure, Role role, const std::string& label, std::vector<Point> points) {
  if (std::ranges::all_of(points, [](const Point& point) { return std::isnan(point.x); })) return;
  const double width = role == Role::kTrue ? 1.0 : 1.8;
  figure.curves.push_back({label, std::move(points), style_of(role), colour_of(role), width});
}

Panel both_legs_panel(const std::string& joint, const std::string& name) {
  Panel panel{.y_label = name + " [deg]", .smallest_span = 2.0};
  for (const auto& [side, role] : {std::pair("left", Role::kLeft), std::pair("right", Role::kRight)}) {
    const std::string column = std::string(side) + "_" + joint;
    panel.series.push_back(
        planned_series(role, column + "_target_rad", std::string(side) + ", target", kDegreesPerRad));
    panel.series.push_back(series(role, column + "_true_rad", std::string(side) + ", true", kDegreesPerRad));
  }
  return panel;
}

Panel attitude_panel(const std::string& y_label, const std::string& told, const std::string& told_label,
                     const std::string& truth) {
  return {.y_label = y_label,
          .series = {series(Role::kTrue, truth, "true", kDegreesPerRad),
                     series(Role::kMeasured, told, told_label, kDegreesPerRad)},
          .smallest_span = 2.0};
}

// Explains the offset of the estimate: the bias of the accelerometer, which is equivalent to a tilt.
std::string offset_note(const Columns& trace, Span time_s) {
  const Rows shown = rows_within(values_of(trace, "time_s"), time_s);
  const auto mean_deg = [&](const std::string& angle) {
    const std::vector<double>& estimated_rad = values_of(trace, "imu_" + angle + "_rad");
    const std::vector<double>& true_rad = values_of(trace, "true_" + angle + "_rad");
    double sum_rad = 0.0;
    for (std::size_t row = shown.begin; row < shown.end; ++row) sum_rad += estimated_rad[row] - true_rad[row];
    return sum_rad / static_cast<double>(shown.end - shown.begin) * kDegreesPerRad;
  };
  return fmt::format(
      "Estimated less true, on average: roll {:+.1f} deg, pitch {:+.1f} deg. A constant part is the "
      "accelerometer's bias, drawn by the seed (sensors.md).",
      mean_deg("roll"), mean_deg("pitch"));
}

Figure joints_figure(Span time_s) {
  return {.title = "Joints of the legs while walking",
          .panels = {both_legs_panel("hip_roll", "hip roll"), both_legs_panel("hip_pitch", "hip pitch"),
                     both_legs_panel("knee", "knee"), both_legs_panel("ankle_pitch", "ankle pitch"),
                     both_legs_panel("ankle_roll", "ankle roll")},
          .x_span = time_s};
}

Figure attitude_figure(Span time_s) {
  return {.title = "Attitude of the trunk while walking",
          .panels = {attitude_panel("roll [deg]", "imu_roll_rad", "estimated", "true_roll_rad"),
                     attitude_panel("pitch [deg]", "imu_pitch_rad", "estimated", "true_pitch_rad"),
                     attitude_panel("roll rate [deg/s]", "gyro_x_rad_per_s", "filtered gyro",
                                    "true_rate_x_rad_per_s"),
                     attitude_panel("pitch rate [deg/s]", "gyro_y_rad_per_s", "filtered gyro",
                                    "true_rate_y_rad_per_s")},
          .x_span = time_s};
}

}  // namespace

std::optional<Span> walk_to_show(const Columns& trace, double cycle_s) {
  const std::vector<double>& times_s = values_of(trace, "time_s");
  const std::vector<double>& states = values_of(trace, "state");
  const std::vector<double>& planned_m = values_of(trace, "planned_zmp_x_m");
  std::optional<Span> longest;
  std::optional<Span> walk;
  for (std::size_t row = 0; row < times_s.size(); ++row) {
    const bool at_velocity = states[row] == static_cast<double>(behaviour::State::kWalking);
    if (!at_velocity && std::isnan(planned_m[row])) {
      walk.reset();
      continue;
    }
    if (!walk) walk = Span{times_s[row], times_s[row]};
    walk->high = times_s[row];
    if (!longest || walk->high - walk->low > longest->high - longest->low) longest = walk;
  }
  if (!longest || longest->high - longest->low < kLongWalk * cycle_s) return longest;
  const double middle_s = 0.5 * (longest->low + longest->high);
  return Span{middle_s, middle_s + kShownCycles * cycle_s};
}

double commanded_cycle_s(const simulation::Scenario& scenario) {
  return 2.0 * 1e-3 * simulation::controller_values(scenario).walk.step.time_ms;
}

std::set<std::string> walk_columns() {
  std::set<std::string> names{"state"};
  for (const std::string axis : {"_x_m", "_y_m"}) {
    for (const char* path : {"zmp", "true_zmp", "planned_zmp"}) names.insert(path + axis);
  }
  for (const std::string side : {"left", "right"}) {
    for (const std::string name : {"load_N", "sole_x_m", "sole_y_m", "sole_yaw_rad"})
      names.insert("true_" + side + "_" + name);
    names.insert(side + "_load_N");
  }
  for (const Figure& figure : {joints_figure({}), attitude_figure({})}) names.merge(columns_of(figure));
  return names;
}

PlaneFigure zmp_figure(const Columns& trace, const sim_board::RobotDescription& robot, Span time_s) {
  const Rows shown = rows_within(values_of(trace, "time_s"), time_s);
  PlaneFigure figure{
      .title = fmt::format("ZMP over the footprints, {:.1f} s to {:.1f} s", time_s.low, time_s.high),
      .x_label = "x, ahead [mm]",
      .y_label = "y, left [mm]"};
  const auto feet = sim_board::feet_of(robot);
  if (feet[0]) add_footprints(figure, trace, *feet[0], "left", shown);
  if (feet[1]) add_footprints(figure, trace, *feet[1], "right", shown);
  const double min_N = kMinLoadShare * robot.total_mass_kg() * kGravity_m_per_s2;
  add_path(figure, Role::kTrue, "true",
           path_mm(trace, "true_zmp", shown, {"true_left_load_N", "true_right_load_N"}, min_N));
  add_path(figure, Role::kMeasured, "measured",
           path_mm(trace, "zmp", shown, {"left_load_N", "right_load_N"}, min_N));
  add_path(figure, Role::kPlanned, "planned", path_mm(trace, "planned_zmp", shown));
  return figure;
}

std::string draw_walk_figures(const Columns& trace, const sim_board::RobotDescription& robot, double cycle_s,
                              const std::filesystem::path& folder) {
  const std::optional<Span> time_s = walk_to_show(trace, cycle_s);
  if (!time_s) return {};
  // A single frame with this state, for example one that another node has sent.
  if (time_s->high <= time_s->low)
    return fmt::format("no figures zmp, joints and attitude: the walk at {:.2f} s has a single sample",
                       time_s->low);
  const PlaneFigure zmp = zmp_figure(trace, robot, *time_s);
  if (!zmp.curves.empty()) draw(zmp, folder / "zmp");
  draw(joints_figure(*time_s), trace, folder / "joints");
  Figure attitude = attitude_figure(*time_s);
  attitude.note = offset_note(trace, *time_s);
  draw(attitude, trace, folder / "attitude");
  if (!zmp.curves.empty()) return {};
  return fmt::format("no figure zmp: no ZMP was planned or measured from {:.2f} s to {:.2f} s", time_s->low,
                     time_s->high);
}

}  // namespace koboshi::tools
