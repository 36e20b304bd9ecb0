#pragma once

#include <Eigen/Geometry>
#include <span>

#include "sim_board/robot/description.h"
#include "sim_board/world/ground.h"

namespace koboshi::sim {

// How far the robot has to be moved along the world's z axis until its boxes touch the ground from above, in
// m; negative for one that hangs. Links by X_WL. Exact for planes and boxes: two convex bodies are apart when
// one of the 15 axes of Gottschalk, Lin and Manocha (OBBTree, SIGGRAPH 1996) says so, and each axis says how
// far up that is. Of height fields, the robot's corners and the field's points count. Zero without ground.
double lift_onto_ground(const RobotDescription& robot, std::span<const Eigen::Isometry3d> X_WLs,
                        const GroundDescription& ground);

}  // namespace koboshi::sim
