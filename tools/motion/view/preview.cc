#include "tools/motion/view/preview.h"

#include <Eigen/Geometry>
#include <bit>
#include <cmath>
#include <limits>

#include "sim_board/world/gravity.h"
#include "sim_board/world/ground.h"
#include "tools/view/capture/scene.h"

namespace koboshi::tools {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr std::uint64_t kTick_us = 10'000;

// Keeps the support foot in place on the ground, tick by tick.
class Placement {
 public:
  explicit Placement(const sim::RobotDescription& robot) : body_(robot) {}

  // Returns X_WB with the robot at rest on its soles.
  Isometry3d place(std::span<const double> angles_rad) {
    body_.solve_at_rest(angles_rad, stance_);
    const GroundAxes axes(stance_.rest.up_B);
    Isometry3d X_GB = Isometry3d::Identity();  // G: on the ground below B's origin, heading with the trunk
    X_GB.linear().row(0) = axes.x_B.transpose();
    X_GB.linear().row(1) = axes.y_B.transpose();
    X_GB.linear().row(2) = stance_.rest.up_B.transpose();
    X_GB.translation().z() = -stance_.rest.height_m;
    if (has_anchor_) {
      const Isometry3d X_GF = foot(X_GB, side_);
      const double turn_rad = heading_rad(X_WF_) - heading_rad(X_GF);
      X_WG_.linear() = Eigen::AngleAxisd(turn_rad, Vector3d::UnitZ()).toRotationMatrix();
      X_WG_.translation() = X_WF_.translation() - X_WG_.linear() * X_GF.translation();
      X_WG_.translation().z() = 0.0;
    }
    side_ = Body::support_side(stance_);
    X_WF_ = X_WG_ * foot(X_GB, side_);
    has_anchor_ = true;
    X_WB_ = X_WG_ * X_GB;
    return X_WB_;
  }

  // A point of GroundAxes on the ground.
  Vector2d on_ground(const Vector2d& p_m) const {
    return (X_WG_ * Vector3d(p_m.x(), p_m.y(), 0.0)).head<2>();
  }
  const Body& body() const { return body_; }
  const Stance& stance() const { return stance_; }

 private:
  Isometry3d foot(const Isometry3d& X_GB, std::size_t side) const {
    const std::size_t link = body_.foot_link(side);
    Isometry3d X_BF = Isometry3d::Identity();
    X_BF.linear() = body_.places().R_BL[link];
    X_BF.translation() = body_.places().p_BL[link];
    return X_GB * X_BF;
  }
  static double heading_rad(const Isometry3d& X) { return std::atan2(X.linear()(1, 0), X.linear()(0, 0)); }

  Body body_;
  Stance stance_;
  bool has_anchor_ = false;
  std::size_t side_ = 0;
  Isometry3d X_WF_ = Isometry3d::Identity();
  Isometry3d X_WG_ = Isometry3d::Identity();
  Isometry3d X_WB_ = Isometry3d::Identity();
};

void add_contacts(const Placement& placement, const Isometry3d& X_WB, view::Sample& sample) {
  const Rest& rest = placement.stance().rest;
  const double force_N = placement.body().mass_kg() * sim::kGravity_m_per_s2 / std::popcount(rest.corners);
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
  recording.scene = view::make_scene(checker.robot(), sim::GroundDescription());
  recording.signals = {{.name = "planned_zmp_x", .unit = "m"}, {.name = "planned_zmp_y", .unit = "m"}};
  const Trajectory& trajectory = checker.trajectory();
  Placement placement(checker.robot());
  for (std::size_t tick = 0; tick < trajectory.ticks(); ++tick) {
    const Isometry3d X_WB = placement.place(trajectory.row(tick));
    view::Sample sample{.time_us = tick * kTick_us};
    const LinkPlaces& places = placement.body().places();
    for (std::size_t link = 0; link < places.R_BL.size(); ++link) {
      sample.links.push_back(
          {.p_WL_m = Vector3d(X_WB * places.p_BL[link]).cast<float>(),
           .q_WL = Eigen::Quaterniond(Matrix3d(X_WB.linear() * places.R_BL[link])).cast<float>()});
    }
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
