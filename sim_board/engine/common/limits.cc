#include "sim_board/engine/common/limits.h"

#include <cmath>

namespace koboshi::sim_board {

void blow_up(double time_s, const std::string& what, const std::string& reason) {
  throw WorldBlewUp("the world blew up at " + std::to_string(time_s) + " s: " + what + ": " + reason);
}

void check_servo(double time_s, const JointDescription& joint, const ServoTorque& servo) {
  const auto is_amount = [](double value) { return value >= 0.0 && value <= kMaxForce; };
  if (std::abs(servo.drive_Nm) <= kMaxForce && is_amount(servo.damping_Nm_s) &&
      is_amount(servo.rotor_inertia_kg_m2) && is_amount(servo.friction_Nm))
    return;
  blow_up(time_s, "joint '" + joint.name + "'", "a servo torque that is not finite or beyond 1e6");
}

void check_push(double time_s, const LinkDescription& link, const Eigen::Vector3d& p_L,
                const Eigen::Vector3d& f_W) {
  if (f_W.cwiseAbs().maxCoeff() <= kMaxForce && f_W.allFinite() && p_L.allFinite()) return;
  blow_up(time_s, "body '" + link.name + "'", "a push that is not finite or beyond 1e6 N");
}

void check_body(double time_s, const LinkDescription& link, const WorldOptions& options,
                const Eigen::Isometry3d& X, const Eigen::Vector3d& v_W, const Eigen::Vector3d& w_W) {
  const double speed_m_per_s = v_W.norm();
  const double rate_rad_per_s = w_W.norm();
  const bool finite = X.matrix().allFinite();
  if (finite && speed_m_per_s <= options.max_speed_m_per_s && rate_rad_per_s <= options.max_rate_rad_per_s)
    return;
  blow_up(time_s, "body '" + link.name + "'",
          finite ? "moves at " + std::to_string(speed_m_per_s) + " m/s and " +
                       std::to_string(rate_rad_per_s) + " rad/s"
                 : "its pose is not finite");
}

}  // namespace koboshi::sim_board
