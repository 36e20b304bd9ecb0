#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "sim_board/robot/description.h"
#include "sim_board/world/link_tree.h"
#include "sim_board/world/world.h"
#include "tools/run/telemetry.h"

namespace koboshi::tools {

// What is true of the robot in the world at one instant, beside what the firmware believes.
struct GroundTruth {
  Eigen::Vector3d p_WB_W = Eigen::Vector3d::Zero();   // origin of the trunk
  Eigen::Vector3d rpy_rad = Eigen::Vector3d::Zero();  // roll, pitch, yaw: R_WB = Rz(yaw) Ry(pitch) Rx(roll)
  Eigen::Vector3d w_WB_W = Eigen::Vector3d::Zero();
  Eigen::Vector3d p_WCom_W = Eigen::Vector3d::Zero();
  double tilt_rad = 0.0;       // of the trunk's z axis from the vertical
  double pose_height_m = 0.0;  // of the trunk above the lowest sole, in the pose that the targets make
  std::array<double, 2> foot_load_N{};  // normal force of the ground on the feet, by Side
  std::array<double, 2> foot_slip_m{};  // how far each foot has slid since it took load, by Side
};

// Observes the truth, and what only its history tells.
class TruthObserver {
 public:
  // The robot must outlive the observer.
  explicit TruthObserver(const sim::RobotDescription& robot);

  // Once a tick, in the order of time.
  const GroundTruth& observe(const sim::World& world, const Telemetry& telemetry);

 private:
  struct Foot {
    int link = -1;
    Eigen::Vector3d p_LSole_L = Eigen::Vector3d::Zero();  // the middle of the sole
    bool loaded = false;
    Eigen::Vector3d anchor_W = Eigen::Vector3d::Zero();  // where it took load
  };

  void observe_foot(std::size_t side, const sim::World& world);
  double pose_height_m(const Telemetry& telemetry);

  const sim::RobotDescription& robot_;
  sim::LinkTree tree_;
  std::array<Foot, 2> feet_;
  std::vector<double> targets_rad_;
  std::vector<Eigen::Isometry3d> X_BLs_;  // of the pose that the targets make
  GroundTruth truth_;
};

}  // namespace koboshi::tools
