#include "bus/dictionary/node_kinds.h"

#include <span>

#include "firmware/app/controller_objects.h"
#include "firmware/app/dictionary.h"
#include "sim_board/drive/drive_objects.h"
#include "sim_board/sensor/sensor_objects.h"

namespace koboshi::tools {
namespace {

// As much as the nodes' own NodeMemory holds.
constexpr NodeCapacity kControllerCapacity{.rpdos = app::kFirstDriveRpdo + robot::kMaxJoints,
                                           .tpdos = app::kTelemetryTpdos + robot::kMaxJoints,
                                           .heartbeat_consumers = robot::kMaxJoints};
constexpr NodeCapacity kDriveCapacity{.rpdos = 4, .tpdos = 4, .heartbeat_consumers = 2};
constexpr NodeCapacity kSensorCapacity{.rpdos = 0, .tpdos = 2, .heartbeat_consumers = 2};

template <typename Values>
NodeKind make_kind(std::string name, const canopen::NodeDescription& description,
                   const NodeCapacity& capacity, std::span<const canopen::DescribedObject> table,
                   const InstanceDefaults& instance = {}, const Values& values = {}) {
  return make_node_kind(std::move(name), description, capacity, table, std::as_bytes(std::span(&values, 1)),
                        instance);
}

InstanceDefaults drive_connections(const robot::RobotModel& robot) {
  InstanceDefaults made;
  for (std::size_t joint = 0; joint < robot.joint_count; ++joint) {
    using enum canopen::PdoDirection;
    made.rpdos.push_back(app::drive_pdo(kReceive, app::kFirstDriveRpdo + joint, robot));
    made.tpdos.push_back(app::drive_pdo(kTransmit, app::kFirstDriveTpdo + joint, robot));
    made.heartbeat_consumers.push_back(app::drive_consumer(joint, robot));
  }
  return made;
}

}  // namespace

NodeKind controller_kind(const robot::RobotModel& robot, const app::ControllerValues& values) {
  return make_kind<app::ControllerValues>("controller", app::kControllerNode, kControllerCapacity,
                                          app::kControllerObjects, drive_connections(robot), values);
}

NodeKind drive_kind() {
  return make_kind<sim_board::DriveValues>("drive", sim_board::drive_node_description({}), kDriveCapacity,
                                           sim_board::kDriveObjects);
}

NodeKind inertial_kind() {
  return make_kind<sim_board::SensorValues>(
      "inertial", sim_board::sensor_node_description(sim_board::SensorKind::kInertial), kSensorCapacity,
      sim_board::kInertialObjects);
}

NodeKind ankle_kind() {
  return make_kind<sim_board::SensorValues>(
      "ankle", sim_board::sensor_node_description(sim_board::SensorKind::kForceTorque), kSensorCapacity,
      sim_board::kAnkleObjects);
}

NodeKind pressure_cells_kind() {
  return make_kind<sim_board::SensorValues>(
      "cells", sim_board::sensor_node_description(sim_board::SensorKind::kPressureCells), kSensorCapacity,
      sim_board::kPressureCellObjects);
}

NodeKind contact_switch_kind() {
  return make_kind<sim_board::SensorValues>(
      "switch", sim_board::sensor_node_description(sim_board::SensorKind::kContactSwitch), kSensorCapacity,
      sim_board::kContactSwitchObjects);
}

NodeKind ankle_kind(hal::AnkleKind kind) {
  switch (kind) {
    case hal::AnkleKind::kPressureCells:
      return pressure_cells_kind();
    case hal::AnkleKind::kContactSwitch:
      return contact_switch_kind();
    case hal::AnkleKind::kSixAxis:
    case hal::AnkleKind::kNone:
      break;
  }
  return ankle_kind();
}

std::vector<NodeKind> documented_kinds(const robot::RobotModel& robot, const app::ControllerValues& values) {
  return {controller_kind(robot, values), drive_kind(),         inertial_kind(), ankle_kind(),
          pressure_cells_kind(),          contact_switch_kind()};
}

}  // namespace koboshi::tools
