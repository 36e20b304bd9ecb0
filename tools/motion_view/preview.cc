#include "tools/motion_view/preview.h"

#include <Eigen/Geometry>
#include <bit>
#include <cmath>
#include <limits>

#include "sim_board/world/gravity.h"
#include "sim_board/world/ground.h"
#include "tools/motion_view/placement.h"
#include "view/capture/scene.h"

namespace koboshi::tools {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr std::uint64_t kTick_us = 10'000;

void add_contacts(const Placement& placement, const Isometry3d& X_WB, view::Sample& sample) {
  const Rest& rest = placement.stance().rest;
  const double force_N =
      placement.body().mass_kg() * sim_board::kGravity_m_per_s2 / std::popcount(rest.corners);
  for (std::size_t i = 0; i < placement.body().corners_B().size(); ++i) {
    if ((rest.corners >> i & 1U) == 0) continue;
    const Vector3d corner_W = X_WB * placement.body().corners_B()[i];
    sample.contacts.push_back({.link = static_cast<int>(placement.body().foot_link(i / 4)),
                               .p_W_m = corner_W.cast<float>(),
                               .f_W_N = Vector3d(0.0, 0.0, force_N).cast<float>()});
  }
}

}  // namespace

view::Recording preview_recording(const MotionReport& report, const MotionChecker& checker) {
  view::Recording recording;
  recording.title = report.name + ", preview";
  recording.scene = view::make_scene(checker.robot(), sim_board::GroundDescription());
  recording.signals = {{.name = "planned_zmp_x", .unit = "m"}, {.name = "planned_zmp_y", .unit = "m"}};
  const Trajectory& trajectory = checker.trajectory();
  Placement placement(checker.robot());
  for (std::size_t tick = 0; tick < trajectory.ticks(); ++tick) {
    const Isometry3d X_WB = placement.place(trajectory.row(tick));
    view::Sample sample{.time_us = tick * kTick_us};
    sample.links = placement.links();
    add_contacts(placement, X_WB, sample);
    const bool judged = trajectory.on_feet[tick];
    const Vector2d zmp_m = placement.on_ground(checker.states()[tick].zmp_m);
    constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
    sample.values = {judged ? static_cast<float>(zmp_m.x()) : kNaN,
                     judged ? static_cast<float>(zmp_m.y()) : kNaN};
    recording.samples.push_back(std::move(sample));
  }
  if (!report.paths.empty()) {
    for (const Finding& finding : report.paths.front().findings)
      recording.events.push_back({.time_us = static_cast<std::uint64_t>(std::llround(1e6 * finding.time_s)),
                                  .kind = "finding",
                                  .text = finding.code + ": " + finding.found});
  }
  return recording;
}

}  // namespace koboshi::tools
