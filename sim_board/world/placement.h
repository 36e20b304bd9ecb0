#pragma once

#include <Eigen/Geometry>
#include <span>

#include "sim_board/description/description.h"
#include "sim_board/world/ground.h"

namespace koboshi::sim_board {

// Returns the displacement along the world's z axis after which the robot's boxes touch the ground from
// above, in m; negative if the robot is above the ground. The links are at X_WLs. Exact for planes and boxes:
// two convex bodies are separate if one of the 15 axes of Gottschalk, Lin and Manocha (OBBTree, SIGGRAPH
// 1996) separates them, and each axis gives the required displacement. Height fields are tested by the
// robot's corners and the field's points. Zero without ground.
double lift_onto_ground(const RobotDescription& robot, std::span<const Eigen::Isometry3d> X_WLs,
                        const GroundDescription& ground);

}  // namespace koboshi::sim_board
