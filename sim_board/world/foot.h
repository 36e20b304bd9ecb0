#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <optional>
#include <vector>

#include "sim_board/description/description.h"
#include "sim_board/world/ground.h"
#include "sim_board/world/world.h"

namespace koboshi::sim_board {

// Geometry of a foot for ground contact.
struct Foot {
  int link = -1;
  Eigen::Isometry3d X_LSole = Eigen::Isometry3d::Identity();  // the sole frame of docs/design/frames.md
  std::vector<Eigen::Vector3d> corners_L;                     // undersides of the link's boxes
};

// Returns the foot with this sensor: its sole lies below the sensor.
Foot foot_of(const RobotDescription& robot, const AnkleSensorDescription& sensor);
// Returns the feet by hal::Side. Without an ankle sensor the sole lies below the last joint of the leg, and
// has the axes of the model at joint angles zero; without a leg a side has no foot.
std::array<std::optional<Foot>, 2> feet_of(const RobotDescription& robot);

// Load below which slip and pressure of a foot are not evaluated: a twelfth of the robot's weight.
inline constexpr double kLoaded_N = 1.0;

// Load of a foot, from the engine's contact forces in the last step. The foot's ZMP is its centre of
// pressure: the mean of the contact points weighted by the force normal to the sole.
struct FootPressure {
  double load_N = 0.0;                                // normal to the sole
  Eigen::Vector2d zmp_S_m = Eigen::Vector2d::Zero();  // in the sole's plane; the origin if there is no load
  Eigen::Vector3d p_WZmp_W = Eigen::Vector3d::Zero();
};

FootPressure foot_pressure(const RobotDescription& robot, const Foot& foot, const World& world);

// Appends the support points of a foot to `points_W`: the corners within this distance of the ground that the
// foot touched in the last step. The unloaded side of a flat foot lifts by micrometres, a foot that rolls
// over an edge by millimetres. On ground other than a plane, a corner may overhang a step or a dip, so the
// contact points that are not near a corner are appended as well.
inline constexpr double kTouching_m = 0.001;
void add_support_points(const Foot& foot, const World& world, const RobotDescription& robot,
                        const GroundDescription& ground, std::vector<Eigen::Vector3d>& points_W);

}  // namespace koboshi::sim_board
