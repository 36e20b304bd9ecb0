#include "sim_board/description/hinge_tree.h"

#include <stdexcept>
#include <utility>
#include <vector>

namespace koboshi::sim_board {

mechanics::HingeTree hinge_tree(const RobotDescription& robot) {
  std::vector<mechanics::Link> links;
  for (const LinkDescription& link : robot.links)
    links.push_back({link.mass_kg, link.p_LCom_L, link.I_LCom_L, link.X_ML});
  std::vector<mechanics::Hinge> hinges;
  for (std::size_t i = 0; i < robot.hinge_count(); ++i) {
    const JointDescription& joint = robot.hinge(i);
    hinges.push_back({static_cast<std::size_t>(joint.parent), static_cast<std::size_t>(joint.child),
                      joint.p_MJ, joint.axis_M});
  }
  std::vector<mechanics::Coupling> couplings;
  for (const FollowerDescription& follower : robot.followers)
    couplings.push_back(
        {static_cast<std::size_t>(follower.leader), follower.multiplier, follower.offset_rad});
  try {
    return mechanics::HingeTree(std::move(links), std::move(hinges), std::move(couplings));
  } catch (const std::invalid_argument& fault) {
    throw std::invalid_argument("robot '" + robot.name + "': " + fault.what());
  }
}

}  // namespace koboshi::sim_board
