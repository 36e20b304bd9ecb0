#include "tools/dictionary/node_kinds.h"

#include <span>

#include "firmware/app/controller_objects.h"
#include "firmware/app/dictionary.h"
#include "sim_board/sensor/sensor_objects.h"
#include "sim_board/servo/drive_objects.h"

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
                   const NodeCapacity& capacity, std::span<const canopen::DescribedObject> table) {
  const Values values;
  return make_node_kind(std::move(name), description, capacity, table, std::as_bytes(std::span(&values, 1)));
}

NodeKind sensor_kind(sim::SensorKind kind) {
  return make_kind<sim::SensorValues>("sensor", sim::sensor_node_description(kind), kSensorCapacity,
                                      sim::kSensorObjects);
}

}  // namespace

NodeKind controller_kind() {
  return make_kind<app::ControllerValues>("controller", app::kControllerNode, kControllerCapacity,
                                          app::kControllerObjects);
}

NodeKind drive_kind() {
  return make_kind<sim::DriveValues>("drive", sim::drive_node_description({}), kDriveCapacity,
                                     sim::kDriveObjects);
}

NodeKind inertial_kind() { return sensor_kind(sim::SensorKind::kInertial); }

NodeKind ankle_kind() { return sensor_kind(sim::SensorKind::kForceTorque); }

std::vector<NodeKind> documented_kinds() { return {controller_kind(), drive_kind(), inertial_kind()}; }

}  // namespace koboshi::tools
