#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <vector>

#include "mechanics/hinge_tree.h"
#include "sim_board/random/random_stream.h"

namespace koboshi::mechanics {

// A tree with links of 0.1 kg to 1.1 kg in general position; its hinges are not in the order of the tree.
HingeTree random_tree(sim_board::RandomStream& random, std::size_t links);

// Returns a vector with coordinates within +-bound.
Eigen::Vector3d random_vector(sim_board::RandomStream& random, double bound);

// Returns numbers within +-bound.
std::vector<double> random_numbers(sim_board::RandomStream& random, std::size_t count, double bound);

// Returns the pose of a link in the root's frame, independently of HingeTree: it follows the hinges from the
// link to the root, with a rotation matrix after Rodrigues.
Eigen::Isometry3d reference_pose(const HingeTree& tree, std::size_t link,
                                 const std::vector<double>& positions_rad);

}  // namespace koboshi::mechanics
