#include "tools/run/run_figures.h"

#include <algorithm>
#include <string>

#include "sim_board/input/user_units.h"

namespace koboshi::tools {
namespace {

std::string label_of(const sim::Command& command, const sim::Scenario& scenario) {
  switch (command.kind) {
    case sim::Command::Kind::kEnable:
      return "enable";
    case sim::Command::Kind::kWalk:
      return "walk";
    case sim::Command::Kind::kPlay:
      return "play " + (command.motion < scenario.motions.size() ? scenario.motions[command.motion].name()
                                                                 : std::string(sim::kGaitMotion));
    case sim::Command::Kind::kStop:
      return "stop";
    case sim::Command::Kind::kGetUp:
      return "get up";
    case sim::Command::Kind::kEmergencyStop:
      return "emergency stop";
    case sim::Command::Kind::kReset:
      return "reset";
  }
  return {};
}

std::vector<Mark> marks_of(const sim::Scenario& scenario) {
  std::vector<Mark> marks;
  for (const sim::Command& command : scenario.commands) {
    marks.push_back({1e-6 * static_cast<double>(command.at_us), label_of(command, scenario)});
  }
  if (scenario.initial.release_us) {
    marks.push_back({1e-6 * static_cast<double>(*scenario.initial.release_us), "let go"});
  }
  for (const sim::Push& push : scenario.pushes)
    marks.push_back({1e-6 * static_cast<double>(push.at_us), "push"});
  std::ranges::stable_sort(marks, {}, &Mark::x);
  return marks;
}

Figure body_figure(const sim::Scenario& scenario) {
  return {
      .title = "Trunk and feet",
      .panels = {{.y_label = "height of trunk [mm]",
                  .series = {{.column = "pose_base_z_m",
                              .label = "of the pose",
                              .style = LineStyle::kDashed,
                              .factor = sim::kMmPerM},
                             {.column = "true_base_z_m", .label = "true", .factor = sim::kMmPerM}},
                  .smallest_span = 10.0},
                 {.y_label = "pitch [deg]",
                  .series = {{.column = "imu_pitch_rad",
                              .label = "inclination sensor",
                              .factor = sim::kDegreesPerRad},
                             {.column = "true_pitch_rad", .label = "true", .factor = sim::kDegreesPerRad}},
                  .smallest_span = 2.0},
                 {.y_label = "load of foot [N]",
                  .series = {{.column = "true_left_load_N", .label = "left, true"},
                             {.column = "true_right_load_N", .label = "right, true"}},
                  .smallest_span = 2.0},
                 {.y_label = "slip of foot [mm]",
                  .series = {{.column = "true_left_slip_m", .label = "left", .factor = sim::kMmPerM},
                             {.column = "true_right_slip_m", .label = "right", .factor = sim::kMmPerM}},
                  .smallest_span = 0.1}},
      .marks = marks_of(scenario)};
}

Panel joint_panel(const std::string& joint, const std::string& name) {
  return {.y_label = name + " [deg]",
          .series = {{.column = joint + "_target_rad",
                      .label = "target",
                      .style = LineStyle::kDashed,
                      .factor = sim::kDegreesPerRad},
                     {.column = joint + "_true_rad", .label = "true", .factor = sim::kDegreesPerRad}},
          .smallest_span = 2.0};
}

}  // namespace

void draw_run_figures(const sim::Scenario& scenario, const std::filesystem::path& folder) {
  const std::filesystem::path trace = folder / "trace.csv";
  draw(body_figure(scenario), trace, folder / "body");
  const Figure legs{.title = "Left leg",
                    .panels = {joint_panel("left_hip_pitch", "hip pitch"), joint_panel("left_knee", "knee"),
                               joint_panel("left_ankle_pitch", "ankle pitch")},
                    .marks = marks_of(scenario)};
  draw(legs, trace, folder / "legs");
}

}  // namespace koboshi::tools
