#include "sim_board/sensor/ankle_zmp.h"

#include <Eigen/Geometry>

namespace koboshi::sim_board {
namespace {

Wrench weight_below(const AnkleSensorDescription& sensor, const RobotDescription& robot,
                    double gravity_m_per_s2) {
  const JointDescription& joint = robot.joints.at(static_cast<std::size_t>(sensor.joint));
  const LinkDescription& foot = robot.links.at(static_cast<std::size_t>(joint.child));
  const Eigen::Vector3d p_SCom_S = sensor.X_LS.inverse() * foot.p_LCom_L;
  const Eigen::Vector3d carried_N = foot.mass_kg * gravity_m_per_s2 * Eigen::Vector3d::UnitZ();
  return {carried_N, p_SCom_S.cross(carried_N)};
}

// Returns a sample of a constant value.
Eigen::Vector3d shown(Channel& channel, const Eigen::Vector3d& value, double resolution) {
  channel.filter().settle(value);
  const std::array<std::int16_t, 3> counts = channel.sample();
  return resolution * Eigen::Vector3d(counts[0], counts[1], counts[2]);
}

}  // namespace

AnkleZmp::AnkleZmp(const AnkleSensorDescription& description, const RobotDescription& robot,
                   double gravity_m_per_s2, const SensorErrors& errors)
    : height_m_(description.height_above_sole_m),
      foot_weight_S_(weight_below(description, robot, gravity_m_per_s2)),
      force_resolution_N_(description.force.resolution),
      torque_resolution_Nm_(description.torque.resolution),
      crosstalk_(description, errors),
      force_(description.force, description.name + ".force", errors),
      torque_(description.torque, description.name + ".torque", errors) {}

AnkleZmp::Reading AnkleZmp::read(const Wrench& wrench_S) {
  const Wrench felt_S = crosstalk_.apply(wrench_S);
  const Eigen::Vector3d f_N = shown(force_, felt_S.force_N, force_resolution_N_) + foot_weight_S_.force_N;
  const Eigen::Vector3d tau_Nm =
      shown(torque_, felt_S.torque_Nm, torque_resolution_Nm_) + foot_weight_S_.torque_Nm;
  if (!(f_N.z() > 0.0)) return {f_N.z(), Eigen::Vector2d::Zero()};
  return {f_N.z(),
          Eigen::Vector2d(-tau_Nm.y() - f_N.x() * height_m_, tau_Nm.x() - f_N.y() * height_m_) / f_N.z()};
}

}  // namespace koboshi::sim_board
