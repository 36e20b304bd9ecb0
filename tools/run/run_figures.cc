#include "tools/run/run_figures.h"

#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include "base/text/user_units.h"
#include "firmware/behaviour/behaviour.h"
#include "tools/plot/legend.h"
#include "tools/run/walk_figures.h"

namespace koboshi::tools {
namespace {

std::string label_of(const simulation::Command& command, const simulation::Scenario& scenario) {
  switch (command.kind) {
    case simulation::Command::Kind::kEnable:
      return "enable";
    case simulation::Command::Kind::kWalk:
      return "walk";
    case simulation::Command::Kind::kPlay:
      return "play " + (command.motion < scenario.motions.size() ? scenario.motions[command.motion].name()
                                                                 : std::string(simulation::kGaitMotion));
    case simulation::Command::Kind::kStop:
      return "stop";
    case simulation::Command::Kind::kGetUp:
      return "get up";
    case simulation::Command::Kind::kEmergencyStop:
      return "emergency stop";
    case simulation::Command::Kind::kReset:
      return "reset";
    case simulation::Command::Kind::kStream:
      return "stream";
  }
  return {};
}

std::vector<Mark> marks_of(const simulation::Scenario& scenario) {
  std::vector<Mark> marks;
  for (const simulation::Command& command : scenario.commands) {
    marks.push_back({1e-6 * static_cast<double>(command.at_us), label_of(command, scenario)});
  }
  if (scenario.initial.release_us) {
    marks.push_back({1e-6 * static_cast<double>(*scenario.initial.release_us), "release"});
  }
  for (const simulation::Push& push : scenario.pushes)
    marks.push_back({1e-6 * static_cast<double>(push.at_us), "push"});
  std::ranges::stable_sort(marks, {}, &Mark::x);
  return marks;
}

// The time when the controller has found all drives. Before, targets and estimates are zero or settle.
double begin_s(const Columns& trace) {
  const std::vector<double>& states = values_of(trace, "state");
  const auto begun = std::ranges::find_if(
      states, [](double state) { return state != static_cast<double>(behaviour::State::kBoot); });
  return begun == states.end() ? 0.0
                               : values_of(trace, "time_s")[static_cast<std::size_t>(begun - states.begin())];
}

Series from(double begin_s, Series series) {
  series.from_x = begin_s;
  return series;
}

Figure body_figure(const simulation::Scenario& scenario, double begin_s) {
  using enum Role;
  return {
      .title = "Trunk and feet",
      .panels = {{.y_label = "height of trunk [mm]",
                  .series = {from(begin_s,
                                  series(kPlanned, "pose_base_z_m", "of the commanded pose", kMmPerM)),
                             series(kTrue, "true_base_z_m", "true", kMmPerM)},
                  .smallest_span = 10.0},
                 {.y_label = "pitch [deg]",
                  .series = {from(begin_s, series(kMeasured, "imu_pitch_rad", "estimated", kDegreesPerRad)),
                             series(kTrue, "true_pitch_rad", "true", kDegreesPerRad)},
                  .smallest_span = 2.0},
                 {.y_label = "load of foot [N]",
                  .series = {series(kLeft, "true_left_load_N", "left, true"),
                             series(kRight, "true_right_load_N", "right, true")},
                  .smallest_span = 2.0},
                 {.y_label = "slip of foot [mm]",
                  .series = {series(kLeft, "true_left_slip_m", "left, true", kMmPerM),
                             series(kRight, "true_right_slip_m", "right, true", kMmPerM)},
                  .smallest_span = 0.1}},
      .marks = marks_of(scenario)};
}

Panel joint_panel(const std::string& joint, const std::string& name, double begin_s) {
  return {.y_label = name + " [deg]",
          .series = {from(begin_s, series(Role::kPlanned, joint + "_target_rad", "target", kDegreesPerRad)),
                     series(Role::kTrue, joint + "_true_rad", "true", kDegreesPerRad)},
          .smallest_span = 2.0};
}

Figure legs_figure(const simulation::Scenario& scenario, double begin_s) {
  return {.title = "Left leg",
          .panels = {joint_panel("left_hip_pitch", "hip pitch", begin_s),
                     joint_panel("left_knee", "knee", begin_s),
                     joint_panel("left_ankle_pitch", "ankle pitch", begin_s)},
          .marks = marks_of(scenario)};
}

// The title of a joint's column with the role in place of the name: left_knee_true_rad for l_knee_true_rad.
std::string title_by_role(const std::string& title, const sim_board::RobotDescription& robot) {
  for (const sim_board::JointDescription& joint : robot.joints) {
    for (const char* signal : {"_target_rad", "_true_rad"})
      if (title == joint.name + signal) return joint.role() + signal;
  }
  return title;
}

std::set<std::string> shown_columns() {
  std::set<std::string> names{"state"};
  for (const Figure& figure : {body_figure({}, 0.0), legs_figure({}, 0.0)}) names.merge(columns_of(figure));
  names.merge(walk_columns());
  return names;
}

}  // namespace

ShownTrace::ShownTrace(const std::vector<simulation::TraceColumn>& columns,
                       const sim_board::RobotDescription& robot)
    : columns_(make_columns({"time_s"})) {
  const std::set<std::string> shown = shown_columns();
  for (std::size_t cell = 0; cell < columns.size(); ++cell) {
    const std::string title = title_by_role(columns[cell].title(), robot);
    if (!shown.contains(title)) continue;
    cells_.push_back(cell);
    columns_.push_back({title, {}});
  }
}

void ShownTrace::thin_out() {
  for (auto& [name, values] : columns_) {
    for (std::size_t i = 0; 2 * i < values.size(); ++i) values[i] = values[2 * i];
    values.resize((values.size() + 1) / 2);
  }
  stride_ *= 2;
}

void ShownTrace::add(std::uint64_t time_us, std::span<const simulation::TraceValue> row) {
  if (rows_++ % stride_ != 0) return;
  if (columns_[0].second.size() == kMaxRows) thin_out();
  columns_[0].second.push_back(static_cast<double>(time_us) / 1e6);
  for (std::size_t i = 0; i < cells_.size(); ++i) columns_[i + 1].second.push_back(row[cells_[i]].number());
}

void draw_run_figures(const simulation::Scenario& scenario, const Columns& trace,
                      const std::filesystem::path& folder) {
  const double begin = begin_s(trace);
  draw(body_figure(scenario, begin), trace, folder / "body");
  draw(legs_figure(scenario, begin), trace, folder / "legs");
}

}  // namespace koboshi::tools
