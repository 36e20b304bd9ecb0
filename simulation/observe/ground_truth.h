#pragma once

#include <Eigen/Core>
#include <array>
#include <numbers>
#include <optional>
#include <vector>

#include "mechanics/hinge_tree.h"
#include "sim_board/description/description.h"
#include "sim_board/world/foot.h"
#include "sim_board/world/ground.h"
#include "sim_board/world/world.h"
#include "simulation/observe/telemetry.h"

namespace koboshi::simulation {

// Ground truth of the robot in the world at one instant, independent of the firmware's estimates.
struct GroundTruth {
  Eigen::Vector3d p_WB_W = Eigen::Vector3d::Zero();   // origin of the trunk
  Eigen::Vector3d rpy_rad = Eigen::Vector3d::Zero();  // roll, pitch, yaw: R_WB = Rz(yaw) Ry(pitch) Rx(roll)
  Eigen::Vector3d w_WB_W = Eigen::Vector3d::Zero();
  Eigen::Vector3d p_WCom_W = Eigen::Vector3d::Zero();
  double tilt_rad = 0.0;       // angle of the trunk's z axis from the vertical
  double height_m = 0.0;       // of the trunk's origin above the ground below it; above z = 0 without ground
  double pose_height_m = 0.0;  // height of the trunk above the lowest sole in the pose of the targets
  std::array<double, 2> foot_load_N{};  // normal force of the ground on each sole, by Side
  std::array<double, 2> foot_slip_m{};  // slip of each foot since it took load, by Side
  std::array<Eigen::Isometry3d, 2> X_WSole{Eigen::Isometry3d::Identity(), Eigen::Isometry3d::Identity()};
  // Centres of pressure: of each foot in its sole's frame, and of all loaded feet, weighted by load, in the
  // world. Empty below a load of sim_board::kLoaded_N.
  std::array<std::optional<Eigen::Vector2d>, 2> foot_zmp_S_m;
  std::optional<Eigen::Vector3d> p_WZmp_W;
  // Height of the lowest corner of each sole above the ground, by Side.
  std::array<double, 2> foot_height_m{};
  // Distance of `zmp_W` from the edge of the support polygon in plan view; positive inside. The polygon is
  // the convex hull of the contact points of the loaded feet (sim_board/world/foot.h).
  std::optional<double> zmp_margin_m;
};

// Computes the ground truth, including quantities that depend on the history.
class TruthObserver {
 public:
  // The robot must outlive the observer.
  explicit TruthObserver(const sim_board::RobotDescription& robot, sim_board::GroundDescription ground = {});

  // Observes the world; call it once per tick.
  const GroundTruth& observe(const sim_board::World& world, const Telemetry& telemetry);
  void archive(sim_board::StateArchive& archive);

 private:
  struct Anchor {
    bool loaded = false;
    Eigen::Vector3d p_W = Eigen::Vector3d::Zero();  // position at which the foot took load
  };

  void observe_feet(const sim_board::World& world);
  void observe_slip(std::size_t side);
  double pose_height_m(const Telemetry& telemetry);

  const sim_board::RobotDescription& robot_;
  const sim_board::GroundDescription ground_;
  mechanics::HingeTree tree_;
  std::array<std::optional<sim_board::Foot>, 2> feet_;
  std::array<Anchor, 2> anchors_;
  std::vector<double> targets_rad_;
  std::vector<Eigen::Isometry3d> X_BLs_;  // poses of the links for the targets
  GroundTruth truth_;
};

}  // namespace koboshi::simulation
