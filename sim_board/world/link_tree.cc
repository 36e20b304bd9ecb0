#include "sim_board/world/link_tree.h"

#include <stdexcept>

namespace koboshi::sim_board {

LinkTree::LinkTree(const RobotDescription& robot) {
  const std::size_t link_count = robot.links.size();
  if (link_count == 0) throw std::invalid_argument("robot '" + robot.name + "' has no link");
  parent_link_.assign(link_count, -1);
  depth_.assign(link_count, -1);
  depth_[0] = 0;
  // Each pass finds at least one more joint with a reached parent; the loop ends when a pass finds none.
  for (bool found = true; found;) {
    found = false;
    for (std::size_t j = 0; j < robot.joints.size(); ++j) {
      const auto parent = static_cast<std::size_t>(robot.joints[j].parent);
      const auto child = static_cast<std::size_t>(robot.joints[j].child);
      if (parent >= link_count || child >= link_count)
        throw std::invalid_argument("joint '" + robot.joints[j].name + "' names no link");
      if (depth_[parent] < 0 || depth_[child] >= 0) continue;
      parent_link_[child] = robot.joints[j].parent;
      depth_[child] = depth_[parent] + 1;
      joints_from_root_.push_back(static_cast<int>(j));
      found = true;
    }
  }
  if (joints_from_root_.size() != robot.joints.size() || robot.joints.size() + 1 != link_count)
    throw std::invalid_argument("the joints of robot '" + robot.name + "' do not make one tree of its links");
}

std::vector<Eigen::Isometry3d> LinkTree::poses(const RobotDescription& robot, const Eigen::Isometry3d& X_WB,
                                               std::span<const double> joint_positions_rad) const {
  std::vector<Eigen::Isometry3d> X_WLs;
  poses(robot, X_WB, joint_positions_rad, X_WLs);
  return X_WLs;
}

void LinkTree::poses(const RobotDescription& robot, const Eigen::Isometry3d& X_WB,
                     std::span<const double> joint_positions_rad,
                     std::vector<Eigen::Isometry3d>& X_WLs) const {
  // Initially X_moved[l] transforms a point of link l from its position at joint angles zero, in the model
  // frame, to its position in the world.
  std::vector<Eigen::Isometry3d>& X_moved = X_WLs;
  X_moved.resize(robot.links.size());
  X_moved[0] = X_WB * robot.links[0].X_ML.inverse();
  for (const int index : joints_from_root_) {
    const JointDescription& joint = robot.joints[static_cast<std::size_t>(index)];
    const Eigen::AngleAxisd turn(joint_positions_rad[static_cast<std::size_t>(index)], joint.axis_M);
    const Eigen::Isometry3d X_turn =
        Eigen::Translation3d(joint.p_MJ) * turn * Eigen::Translation3d(-joint.p_MJ);
    X_moved[static_cast<std::size_t>(joint.child)] = X_moved[static_cast<std::size_t>(joint.parent)] * X_turn;
  }
  for (std::size_t l = 0; l < X_moved.size(); ++l) X_moved[l] = X_moved[l] * robot.links[l].X_ML;
}

int LinkTree::distance(int link, int other_link) const {
  auto a = static_cast<std::size_t>(link);
  auto b = static_cast<std::size_t>(other_link);
  int joints = 0;
  for (; a != b; ++joints) {
    std::size_t& deeper = depth_[a] >= depth_[b] ? a : b;
    deeper = static_cast<std::size_t>(parent_link_[deeper]);
  }
  return joints;
}

}  // namespace koboshi::sim_board
