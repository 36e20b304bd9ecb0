#include "tools/run/ground_truth.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "sim_board/world/ground_truth.h"

namespace koboshi::tools {
namespace {

// A foot that carries less than this slides without meaning.
constexpr double kLoaded_N = 1.0;

Eigen::Vector3d roll_pitch_yaw(const Eigen::Matrix3d& R) {
  return {std::atan2(R(2, 1), R(2, 2)), std::atan2(-R(2, 0), std::hypot(R(2, 1), R(2, 2))),
          std::atan2(R(1, 0), R(0, 0))};
}

}  // namespace

TruthObserver::TruthObserver(const sim::RobotDescription& robot)
    : robot_(robot), tree_(robot), targets_rad_(robot.joints.size(), 0.0) {
  const std::optional<sim::AnkleSensorDescription>* sensors[] = {&robot.left_ankle, &robot.right_ankle};
  for (std::size_t side = 0; side < feet_.size(); ++side) {
    if (!*sensors[side]) continue;
    const sim::AnkleSensorDescription& sensor = **sensors[side];
    feet_[side].link = robot.joints[static_cast<std::size_t>(sensor.joint)].child;
    feet_[side].p_LSole_L = sensor.X_LS.translation() - sensor.height_above_sole_m * Eigen::Vector3d::UnitZ();
  }
}

const GroundTruth& TruthObserver::observe(const sim::World& world, const Telemetry& telemetry) {
  const sim::BodyState base = world.body(0);
  truth_.p_WB_W = base.X_WL.translation();
  truth_.rpy_rad = roll_pitch_yaw(base.X_WL.linear());
  truth_.w_WB_W = base.w_WL_W;
  truth_.p_WCom_W = sim::centre_of_mass(robot_, world).p_WCom_W;
  truth_.tilt_rad = std::acos(std::clamp(base.X_WL.linear()(2, 2), -1.0, 1.0));
  truth_.pose_height_m = pose_height_m(telemetry);
  for (std::size_t side = 0; side < feet_.size(); ++side) observe_foot(side, world);
  return truth_;
}

void TruthObserver::observe_foot(std::size_t side, const sim::World& world) {
  Foot& foot = feet_[side];
  if (foot.link < 0) return;
  double load_N = 0.0;
  for (const sim::Contact& contact : world.contacts()) {
    if (contact.link == foot.link && contact.other_link < 0) load_N += contact.f_W.z();
  }
  truth_.foot_load_N[side] = load_N;
  const Eigen::Vector3d p_W = world.body(foot.link).X_WL * foot.p_LSole_L;
  const bool loaded = load_N >= kLoaded_N;
  if (loaded && !foot.loaded) foot.anchor_W = p_W;
  foot.loaded = loaded;
  truth_.foot_slip_m[side] = loaded ? (p_W - foot.anchor_W).head<2>().norm() : 0.0;
}

double TruthObserver::pose_height_m(const Telemetry& telemetry) {
  for (std::size_t joint = 0; joint < targets_rad_.size(); ++joint) {
    targets_rad_[joint] = telemetry.joints[joint].target_rad;
  }
  tree_.poses(robot_, Eigen::Isometry3d::Identity(), targets_rad_, X_BLs_);
  double height_m = 0.0;
  for (const Foot& foot : feet_) {
    if (foot.link < 0) continue;
    height_m = std::max(height_m, -(X_BLs_[static_cast<std::size_t>(foot.link)] * foot.p_LSole_L).z());
  }
  return height_m;
}

}  // namespace koboshi::tools
