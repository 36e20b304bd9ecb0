#include "bus/dictionary/node_kinds.h"

#include <span>

#include "firmware/app/controller_objects.h"
#include "firmware/app/dictionary.h"
#include "sim_board/drive/drive_objects.h"
#include "sim_board/sensor/sensor_objects.h"

namespace koboshi::bus {
namespace {

// As much as the nodes' own NodeMemory holds.
constexpr NodeCapacity kControllerCapacity{.rpdos = app::kRpdos,
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

NodeKind kind_of(sim_board::SensorKind sensor) {
  const auto make = [sensor](const char* name, std::span<const canopen::DescribedObject> table) {
    return make_kind<sim_board::SensorValues>(name, sim_board::sensor_node_description(sensor),
                                              kSensorCapacity, table);
  };
  switch (sensor) {
    case sim_board::SensorKind::kInertial:
      return make("inertial", sim_board::kInertialObjects);
    case sim_board::SensorKind::kForceTorque:
      return make("ankle", sim_board::kAnkleObjects);
    case sim_board::SensorKind::kPressureCells:
      return make("cells", sim_board::kPressureCellObjects);
    case sim_board::SensorKind::kContactSwitch:
      return make("switch", sim_board::kContactSwitchObjects);
  }
  return {};
}

InstanceDefaults drive_connections(const robot::RobotModel& robot) {
  InstanceDefaults made;
  // A large robot leaves some of the telemetry out.
  made.tpdos.resize(app::kTelemetryTpdos - app::controller_node(robot).tpdos.size());
  for (std::size_t joint = 0; joint < robot.joint_count; ++joint) {
    made.tpdos.push_back(
        app::drive_pdo(canopen::PdoDirection::kTransmit, app::kFirstDriveTpdo + joint, robot));
    made.heartbeat_consumers.push_back(app::drive_consumer(joint, robot));
  }
  // The RPDOs of the joint target stream have the numbers after those of the largest number of drives.
  for (std::size_t number = app::kFirstDriveRpdo; number < app::kRpdos; ++number)
    made.rpdos.push_back(app::drive_pdo(canopen::PdoDirection::kReceive, number, robot));
  return made;
}

}  // namespace

NodeKind controller_kind(const robot::RobotModel& robot, const app::ControllerValues& values) {
  return make_kind<app::ControllerValues>("controller", app::controller_node(robot), kControllerCapacity,
                                          app::kControllerObjects, drive_connections(robot), values);
}

NodeKind drive_kind() {
  return make_kind<sim_board::DriveValues>("drive", sim_board::drive_node_description({}), kDriveCapacity,
                                           sim_board::kDriveObjects);
}

NodeKind inertial_kind() { return kind_of(sim_board::SensorKind::kInertial); }

NodeKind ankle_kind(hal::AnkleKind kind) { return kind_of(sim_board::sensor_kind(kind)); }

std::vector<NodeKind> documented_kinds(const robot::RobotModel& robot, const app::ControllerValues& values) {
  return {controller_kind(robot, values),
          drive_kind(),
          inertial_kind(),
          ankle_kind(),
          ankle_kind(hal::AnkleKind::kPressureCells),
          ankle_kind(hal::AnkleKind::kContactSwitch)};
}

}  // namespace koboshi::bus
