#include "sim_board/world/ground_truth.h"

namespace koboshi::sim {

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

double energy_J(const RobotDescription& robot, const World& world,
                const Eigen::Vector3d& gravity_W_m_per_s2) {
  double energy_J = 0.0;
  for (std::size_t l = 0; l < robot.links.size(); ++l) {
    const LinkDescription& link = robot.links[l];
    const BodyState body = world.body(static_cast<int>(l));
    const Eigen::Vector3d w_L = body.X_WL.linear().transpose() * body.w_WL_W;
    energy_J += 0.5 * link.mass_kg * body.v_WCom_W.squaredNorm() + 0.5 * w_L.dot(link.I_LCom_L * w_L) -
                link.mass_kg * gravity_W_m_per_s2.dot(body.X_WL * link.p_LCom_L);
  }
  return energy_J;
}

}  // namespace koboshi::sim
