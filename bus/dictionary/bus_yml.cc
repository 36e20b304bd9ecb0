#include "bus/dictionary/formats.h"

#include <iterator>
#include <string_view>

#include <fmt/core.h>

#include "bus/dictionary/configured_drive.h"
#include "bus/dictionary/node_kinds.h"
#include "firmware/app/dictionary.h"
#include "firmware/drive/configuration.h"
#include "sim_board/drive/drive_dictionary.h"
#include "sim_board/sensor/sensor_node.h"
#include "simulation/model/robot_model.h"

namespace koboshi::bus {
namespace {

using Text = std::back_insert_iterator<std::string>;

constexpr std::string_view kHead =
    R"(# Drives and sensors of the default robot for a CANopen master in the controller's place, as dcfgen of lely-core
# reads them: docs/guide/another-master.md. Written by `koboshi dictionary write`.

)";

double multiplier(std::uint16_t lost_ms, std::uint16_t period_ms) {
  return static_cast<double>(lost_ms) / period_ms;
}

void add_master(std::string& text) {
  const canopen::NodeDescription& node = app::kControllerNode;
  fmt::format_to(Text(text), "master:\n  node_id: {}\n  baudrate: 1000\n", drive::kControllerNodeId);
  fmt::format_to(Text(text), "  vendor_id: 0x{:08X}\n  product_code: 0x{:08X}\n  revision_number: 0x{:08X}\n",
                 node.vendor_id, node.product_code, node.revision_number);
  fmt::format_to(Text(text), "  sync_period: {}  # us\n  heartbeat_producer: {}  # ms\n", node.sync_period_us,
                 node.heartbeat_ms);
  fmt::format_to(Text(text), "  heartbeat_multiplier: {:.1f}\n  heartbeat_consumer: true\n",
                 multiplier(drive::kControllerHeartbeatLost_ms, node.heartbeat_ms));
  text += "  start_nodes: true\n";
}

void add_identity(std::string& text, std::string_view name, std::string_view data_sheet, std::uint8_t node_id,
                  std::uint32_t revision, std::uint32_t serial) {
  fmt::format_to(Text(text), "\n{}:\n  dcf: {}\n  node_id: {}\n  revision_number: 0x{:08X}\n", name,
                 data_sheet, node_id, revision);
  fmt::format_to(Text(text), "  serial_number: {}\n  mandatory: true\n", serial);
}

void add_pdos(std::string& text, std::string_view direction,
              std::span<const canopen::PdoConfiguration> configured) {
  if (configured.empty()) return;
  fmt::format_to(Text(text), "  {}:\n", direction);
  for (std::size_t i = 0; i < configured.size(); ++i) {
    const canopen::PdoConfiguration& pdo = configured[i];
    fmt::format_to(Text(text), "    {}:\n      cob_id: 0x{:08X}\n      transmission: {}\n      mapping:\n",
                   i + 1, pdo.cob_id, pdo.transmission_type);
    for (const std::uint32_t entry : pdo.mapping) {
      if (entry == 0) break;
      fmt::format_to(Text(text), "        - {{index: 0x{:04X}, sub_index: {}}}\n", entry >> 16,
                     entry >> 8 & 0xFF);
    }
  }
}

// Returns whether dcfgen makes these requests from the keys above. It has no working key for the event timer
// of an RPDO.
bool stands_in_keys(canopen::ObjectAddress address) {
  const bool pdo = address.index >= 0x1400 && address.index < 0x1C00;
  const bool rpdo_timer = address.index < 0x1600 && address.subindex == 5;
  return address.index == 0x1016 || address.index == 0x1017 || (pdo && !rpdo_timer);
}

void add_drive(std::string& text, const robot::Joint& joint, const sim_board::JointDescription& description) {
  const sim_board::DriveDescription& drive = description.drive;
  const ConfiguredDrive configured = configure_drive(joint, drive);
  add_identity(text, description.name, "drive.eds", drive.node_id,
               sim_board::drive_node_description(drive).revision_number, drive.serial_number);
  fmt::format_to(
      Text(text),
      "  heartbeat_consumer: true\n  heartbeat_producer: {}  # ms\n  heartbeat_multiplier: {:.1f}\n",
      configured.heartbeat_ms, multiplier(drive::kDriveHeartbeatLost_ms, configured.heartbeat_ms));
  add_pdos(text, "rpdo", configured.rpdos);
  add_pdos(text, "tpdo", configured.tpdos);
  text += "  sdo:\n";
  for (const ConfiguredDrive::Write& write : configured.writes) {
    if (stands_in_keys(write.address)) continue;
    fmt::format_to(Text(text), "    - {{index: 0x{:04X}, sub_index: {}, value: {}}}\n", write.address.index,
                   write.address.subindex, write.value);
  }
}

// A sensor runs with its defaults; the controller does not monitor its heartbeat.
void add_sensor(std::string& text, std::string_view name, const NodeKind& kind, std::uint8_t node_id) {
  add_identity(text, name, kind.name + ".eds", node_id, kind.description.revision_number, node_id);
  fmt::format_to(Text(text), "  heartbeat_producer: {}  # ms\n", kind.description.heartbeat_ms);
}

}  // namespace

std::string bus_text(const sim_board::RobotDescription& robot) {
  const simulation::NamedModel model = simulation::load_named_model(robot);
  std::string text(kHead);
  add_master(text);
  for (std::size_t i = 0; i < robot.joints.size(); ++i)
    add_drive(text, model.model.joints[i], robot.joints[i]);
  if (robot.imu) add_sensor(text, robot.imu->name, inertial_kind(), sim_board::kInertialNode);
  if (robot.left_ankle)
    add_sensor(text, robot.left_ankle->name, ankle_kind(robot.ankle_kind()), sim_board::kLeftAnkleNode);
  if (robot.right_ankle)
    add_sensor(text, robot.right_ankle->name, ankle_kind(robot.ankle_kind()), sim_board::kRightAnkleNode);
  return text;
}

}  // namespace koboshi::bus
