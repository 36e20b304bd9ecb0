#include "sim_board/sensor/ankle_sensor.h"

#include <algorithm>

#include "sim_board/sensor/pressure_cells.h"

namespace koboshi::sim_board {
namespace {

// Returns the joint's anchor in the frame of its child link, in which it is fixed.
Eigen::Vector3d anchor_in_child(const RobotDescription& robot, int joint_index) {
  const JointDescription& joint = robot.joints.at(static_cast<std::size_t>(joint_index));
  return robot.links.at(static_cast<std::size_t>(joint.child)).X_ML.inverse() * joint.p_MJ;
}

}  // namespace

AnkleSensor::AnkleSensor(const AnkleSensorDescription& description, const RobotDescription& robot,
                         const SensorErrors& errors)
    : description_(description),
      sole_(foot_of(robot, description)),
      robot_(&robot),
      joint_(description.joint),
      foot_(robot.joints.at(static_cast<std::size_t>(description.joint)).child),
      R_SL_(description.X_LS.linear().transpose()),
      p_SJ_S_(description.X_LS.inverse() * anchor_in_child(robot, description.joint)),
      crosstalk_(description, errors),
      channels_(description.force, description.torque, description.name + ".force",
                description.name + ".torque", description.name, errors) {}

void AnkleSensor::step(const World& world, std::uint64_t time_us) {
  if (description_.kind != hal::AnkleKind::kSixAxis) return step_sole(world, time_us);
  step(world.body(foot_), world.joint_wrench(joint_), time_us);
}

void AnkleSensor::step_sole(const World& world, std::uint64_t time_us) {
  const FootPressure pressure = foot_pressure(*robot_, sole_, world);
  Eigen::Vector3d first = Eigen::Vector3d::UnitZ() * pressure.load_N;
  Eigen::Vector3d second = Eigen::Vector3d::Zero();
  if (description_.kind == hal::AnkleKind::kPressureCells) {
    // The sole's frame lies below the sensor and has its axes.
    const CellForces cells = distribute_load(description_.cells_S_m, pressure.load_N, pressure.zmp_S_m);
    first = {cells[0], cells[1], cells[2]};
    second = {cells[3], 0.0, 0.0};
  }
  channels_.step(first, second, time_us);
}

void AnkleSensor::step(const BodyState& foot, const Wrench& joint_W, std::uint64_t time_us) {
  if (!started_) R_WL_before_ = foot.X_WL.linear();
  started_ = true;
  // The solver computed the wrench for the poses at the beginning of the step.
  const Eigen::Matrix3d R_SW = R_SL_ * R_WL_before_.transpose();
  wrench_S_.force_N = R_SW * joint_W.force_N;
  wrench_S_.torque_Nm = R_SW * joint_W.torque_Nm + p_SJ_S_.cross(wrench_S_.force_N);
  const Wrench felt_S = crosstalk_.apply(wrench_S_);
  channels_.step(felt_S.force_N, felt_S.torque_Nm, time_us);
  R_WL_before_ = foot.X_WL.linear();
}

bool AnkleSensor::poll(std::uint64_t now_us, hal::AnkleSample& sample) {
  SixAxis::Sample raw;
  if (!channels_.poll(now_us, raw)) return false;
  sample = {static_cast<std::uint32_t>(raw.time_us), raw.first_raw, raw.second_raw};
  if (description_.kind == hal::AnkleKind::kPressureCells) {
    // Cells cannot pull; the two channels without a cell have none.
    for (std::int16_t& counts : sample.force_raw) counts = std::max<std::int16_t>(counts, 0);
    sample.torque_raw = {std::max<std::int16_t>(raw.second_raw[0], 0), 0, 0};
  } else if (description_.kind == hal::AnkleKind::kContactSwitch) {
    const double load_N = description_.force.resolution * raw.first_raw[2];
    closed_ = load_N >= (closed_ ? 0.5 : 1.0) * description_.closing_force_N;
    sample.force_raw = {0, 0, static_cast<std::int16_t>(closed_ ? 1 : 0)};
    sample.torque_raw = {};
  }
  return true;
}

}  // namespace koboshi::sim_board
