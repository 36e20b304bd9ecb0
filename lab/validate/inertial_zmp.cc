#include "lab/validate/inertial_zmp.h"

#include <Eigen/Geometry>

namespace koboshi::lab {

InertialZmp::Momentum InertialZmp::momentum_of(const sim_board::World& world) const {
  Momentum sum{.time_s = world.time_s()};
  for (std::size_t l = 0; l < robot_.links.size(); ++l) {
    const sim_board::LinkDescription& link = robot_.links[l];
    const sim_board::BodyState body = world.body(static_cast<int>(l));
    const Eigen::Vector3d p_W = body.X_WL * link.p_LCom_L;
    const Eigen::Matrix3d& R = body.X_WL.linear();
    const Eigen::Vector3d momentum = link.mass_kg * body.v_WCom_W;
    sum.first_kg_m += link.mass_kg * p_W;
    sum.linear_N_s += momentum;
    sum.angular_Nm_s += p_W.cross(momentum) + R * (link.I_LCom_L * (R.transpose() * body.w_WL_W));
  }
  return sum;
}

std::optional<Eigen::Vector2d> InertialZmp::observe(const sim_board::World& world) {
  const Momentum now = momentum_of(world);
  const std::optional<Momentum> before = before_;
  before_ = now;
  if (!before) return std::nullopt;
  // Gravity acted on the pose before the step. p x m v after it, less the same before, is p before it times
  // the change of m v: a body is moved by the velocity that it then has.
  const double duration_s = now.time_s - before->time_s;
  const Eigen::Vector3d g_W(0.0, 0.0, -gravity_m_per_s2_);
  double mass_kg = 0.0;
  for (const sim_board::LinkDescription& link : robot_.links) mass_kg += link.mass_kg;
  const Eigen::Vector3d force_N = (now.linear_N_s - before->linear_N_s) / duration_s - mass_kg * g_W;
  const Eigen::Vector3d torque_Nm =
      (now.angular_Nm_s - before->angular_Nm_s) / duration_s - before->first_kg_m.cross(g_W);
  if (!(force_N.z() > 0.0)) return std::nullopt;
  return Eigen::Vector2d(-torque_Nm.y(), torque_Nm.x()) / force_N.z();
}

}  // namespace koboshi::lab
