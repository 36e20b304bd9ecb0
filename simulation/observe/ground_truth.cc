#include "simulation/observe/ground_truth.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "sim_board/description/hinge_tree.h"
#include "sim_board/world/ground_truth.h"
#include "sim_board/world/support_polygon.h"

namespace koboshi::simulation {
namespace {

Eigen::Vector3d roll_pitch_yaw(const Eigen::Matrix3d& R) {
  return {std::atan2(R(2, 1), R(2, 2)), std::atan2(-R(2, 0), std::hypot(R(2, 1), R(2, 2))),
          std::atan2(R(1, 0), R(0, 0))};
}

}  // namespace

TruthObserver::TruthObserver(const sim_board::RobotDescription& robot, sim_board::GroundDescription ground)
    : robot_(robot),
      ground_(std::move(ground)),
      tree_(sim_board::hinge_tree(robot)),
      feet_(sim_board::feet_of(robot)),
      targets_rad_(robot.joints.size(), 0.0) {}

const GroundTruth& TruthObserver::observe(const sim_board::World& world, const Telemetry& telemetry) {
  const sim_board::BodyState base = world.body(0);
  truth_.p_WB_W = base.X_WL.translation();
  truth_.rpy_rad = roll_pitch_yaw(base.X_WL.linear());
  truth_.w_WB_W = base.w_WL_W;
  truth_.p_WCom_W = sim_board::centre_of_mass(robot_, world).p_WCom_W;
  truth_.tilt_rad = std::acos(std::clamp(base.X_WL.linear()(2, 2), -1.0, 1.0));
  truth_.height_m = ground_.present ? sim_board::height_above(ground_, truth_.p_WB_W) : truth_.p_WB_W.z();
  truth_.pose_height_m = pose_height_m(telemetry);
  observe_feet(world);
  return truth_;
}

void TruthObserver::observe_feet(const sim_board::World& world) {
  double load_N = 0.0;
  Eigen::Vector3d moment_W = Eigen::Vector3d::Zero();
  std::vector<Eigen::Vector3d> corners_W;
  for (std::size_t side = 0; side < feet_.size(); ++side) {
    if (!feet_[side]) continue;
    const sim_board::Foot& foot = *feet_[side];
    const sim_board::FootPressure pressure = sim_board::foot_pressure(robot_, foot, world);
    truth_.X_WSole[side] = world.body(foot.link).X_WL * foot.X_LSole;
    truth_.foot_height_m[side] = std::numeric_limits<double>::infinity();
    for (const Eigen::Vector3d& corner_L : foot.corners_L) {
      const double height_m = sim_board::height_above(ground_, world.body(foot.link).X_WL * corner_L);
      truth_.foot_height_m[side] = std::min(truth_.foot_height_m[side], height_m);
    }
    truth_.foot_load_N[side] = pressure.load_N;
    observe_slip(side);
    truth_.foot_zmp_S_m[side].reset();
    if (pressure.load_N < sim_board::kLoaded_N) continue;
    truth_.foot_zmp_S_m[side] = pressure.zmp_S_m;
    load_N += pressure.load_N;
    moment_W += pressure.load_N * pressure.p_WZmp_W;
    sim_board::add_support_points(foot, world, robot_, ground_, corners_W);
  }
  truth_.p_WZmp_W.reset();
  truth_.zmp_margin_m.reset();
  if (load_N == 0.0) return;
  truth_.p_WZmp_W = moment_W / load_N;
  std::vector<Eigen::Vector2d> corners_m;
  for (const Eigen::Vector3d& corner_W : corners_W) corners_m.push_back(corner_W.head<2>());
  truth_.zmp_margin_m =
      sim_board::distance_inside(sim_board::convex_hull(corners_m), truth_.p_WZmp_W->head<2>());
}

void TruthObserver::observe_slip(std::size_t side) {
  Anchor& anchor = anchors_[side];
  const Eigen::Vector3d p_W = truth_.X_WSole[side].translation();
  const bool loaded = truth_.foot_load_N[side] >= sim_board::kLoaded_N;
  if (loaded && !anchor.loaded) anchor.p_W = p_W;
  anchor.loaded = loaded;
  truth_.foot_slip_m[side] = loaded ? (p_W - anchor.p_W).head<2>().norm() : 0.0;
}

double TruthObserver::pose_height_m(const Telemetry& telemetry) {
  for (std::size_t joint = 0; joint < targets_rad_.size(); ++joint) {
    targets_rad_[joint] = telemetry.joints[joint].target_rad;
  }
  tree_.poses(Eigen::Isometry3d::Identity(), targets_rad_, X_BLs_);
  double height_m = 0.0;
  for (const auto& foot : feet_) {
    if (!foot) continue;
    const Eigen::Isometry3d X_BSole = X_BLs_[static_cast<std::size_t>(foot->link)] * foot->X_LSole;
    height_m = std::max(height_m, -X_BSole.translation().z());
  }
  return height_m;
}

void TruthObserver::archive(sim_board::StateArchive& archive) { archive(anchors_, truth_); }

}  // namespace koboshi::simulation
