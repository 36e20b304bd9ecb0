#pragma once

#include <Eigen/Geometry>
#include <span>
#include <vector>

#include "sim_board/description/description.h"

namespace koboshi::sim_board {

// The kinematic tree: links[0] is the root, the joints are the edges.
class LinkTree {
 public:
  // Throws std::invalid_argument unless the joints form one tree of all links.
  explicit LinkTree(const RobotDescription& robot);

  // Returns X_WL of every link, given that of links[0] and the joint positions in rad, by joint.
  std::vector<Eigen::Isometry3d> poses(const RobotDescription& robot, const Eigen::Isometry3d& X_WB,
                                       std::span<const double> joint_positions_rad) const;
  // The same into `X_WLs`, whose memory is reused.
  void poses(const RobotDescription& robot, const Eigen::Isometry3d& X_WB,
             std::span<const double> joint_positions_rad, std::vector<Eigen::Isometry3d>& X_WLs) const;
  // Indices of the joints, parents before children.
  const std::vector<int>& joints_from_root() const { return joints_from_root_; }
  // Returns the number of joints between the two links.
  int distance(int link, int other_link) const;

 private:
  std::vector<int> joints_from_root_;
  std::vector<int> parent_link_;  // by link; -1 for the root
  std::vector<int> depth_;        // by link
};

}  // namespace koboshi::sim_board
