#include "sim_board/world/ground_truth.h"

namespace koboshi::sim_board {

CentreOfMass centre_of_mass(const RobotDescription& robot, const World& world) {
  CentreOfMass sum;
  double mass_kg = 0.0;
  for (std::size_t l = 0; l < robot.links.size(); ++l) {
    const LinkDescription& link = robot.links[l];
    const BodyState body = world.body(static_cast<int>(l));
    sum.p_WCom_W += link.mass_kg * (body.X_WL * link.p_LCom_L);
    sum.v_WCom_W += link.mass_kg * body.v_WCom_W;
    mass_kg += link.mass_kg;
  }
  return {sum.p_WCom_W / mass_kg, sum.v_WCom_W / mass_kg};
}

Eigen::Isometry3d pose_before_step(const RobotDescription& robot, const World& world, int link) {
  const Eigen::Vector3d& p_LCom_L = robot.links.at(static_cast<std::size_t>(link)).p_LCom_L;
  const BodyState body = world.body(link);
  const Eigen::Vector3d turn_W = -world.step_s() * body.w_WL_W;
  const double angle_rad = turn_W.norm();
  Eigen::Isometry3d X_WL = body.X_WL;
  if (angle_rad > 0.0) {
    X_WL.linear() = Eigen::AngleAxisd(angle_rad, turn_W / angle_rad) * X_WL.linear();
  }
  const Eigen::Vector3d p_WCom_W = body.X_WL * p_LCom_L - world.step_s() * body.v_WCom_W;
  X_WL.translation() = p_WCom_W - X_WL.linear() * p_LCom_L;
  return X_WL;
}

double link_energy_J(const RobotDescription& robot, const World& world, int link,
                     const Eigen::Vector3d& gravity_W_m_per_s2) {
  const LinkDescription& description = robot.links[static_cast<std::size_t>(link)];
  const BodyState body = world.body(link);
  const Eigen::Vector3d w_L = body.X_WL.linear().transpose() * body.w_WL_W;
  return 0.5 * description.mass_kg * body.v_WCom_W.squaredNorm() + 0.5 * w_L.dot(description.I_LCom_L * w_L) -
         description.mass_kg * gravity_W_m_per_s2.dot(body.X_WL * description.p_LCom_L);
}

double energy_J(const RobotDescription& robot, const World& world,
                const Eigen::Vector3d& gravity_W_m_per_s2) {
  double energy_J = 0.0;
  for (std::size_t l = 0; l < robot.links.size(); ++l)
    energy_J += link_energy_J(robot, world, static_cast<int>(l), gravity_W_m_per_s2);
  return energy_J;
}

}  // namespace koboshi::sim_board
