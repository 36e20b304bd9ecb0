#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <optional>
#include <vector>

#include "sim_board/robot/description.h"
#include "sim_board/world/ground.h"
#include "sim_board/world/world.h"

namespace koboshi::sim {

// A foot as the ground meets it.
struct Foot {
  int link = -1;
  Eigen::Isometry3d X_LSole = Eigen::Isometry3d::Identity();  // the sole frame of docs/design/frames.md
  std::vector<Eigen::Vector3d> corners_L;                     // undersides of the link's boxes
};

// By hal::Side; a robot without an ankle sensor on a side has no foot there.
std::array<std::optional<Foot>, 2> feet_of(const RobotDescription& robot);

// A foot that carries less than this, a twelfth of the robot, slides and presses without meaning.
inline constexpr double kLoaded_N = 1.0;

// What the ground does to a foot, from the forces that the engine found at its contacts in the last step. The
// ZMP of a foot is its centre of pressure: the mean of the contact points, weighted with the force normal to
// the sole.
struct FootPressure {
  double load_N = 0.0;                                // normal to the sole
  Eigen::Vector2d zmp_S_m = Eigen::Vector2d::Zero();  // in the sole's plane; without load its origin
  Eigen::Vector3d p_WZmp_W = Eigen::Vector3d::Zero();
};

FootPressure foot_pressure(const RobotDescription& robot, const Foot& foot, const World& world);

// Where a foot rests: those of its corners that are closer than this to the ground that it touched in the
// last step. A foot that stands flat and bears more on one side lifts the other by micrometres; one that
// rolls over an edge by millimetres. Where the ground is more than a plane, a corner may hang over the edge
// of a step or between two bumps: it rests on nothing, and the points of contact that are not near a corner
// count, too. Appended to `points_W`.
inline constexpr double kTouching_m = 0.001;
void add_support_points(const Foot& foot, const World& world, const RobotDescription& robot,
                        const GroundDescription& ground, std::vector<Eigen::Vector3d>& points_W);

}  // namespace koboshi::sim
