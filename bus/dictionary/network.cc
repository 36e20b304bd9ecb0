#include "bus/dictionary/network.h"

#include <algorithm>
#include <cctype>
#include <numbers>
#include <stdexcept>
#include <utility>

#include <fmt/core.h>

#include "base/text/error.h"
#include "bus/dictionary/configured_drive.h"
#include "bus/dictionary/node_kinds.h"
#include "bus/dictionary/services.h"
#include "firmware/app/dictionary.h"
#include "firmware/drive/configuration.h"
#include "hal/port/period.h"
#include "sim_board/sensor/sensor_node.h"
#include "simulation/model/robot_model.h"

namespace koboshi::bus {
namespace {

using canopen::PdoConfiguration;

constexpr std::string_view kController = "controller";
constexpr std::string_view kOperator = "operator";  // a PC at the bus

// The resolutions of the robot's sensors.
class Resolutions {
 public:
  explicit Resolutions(const sim_board::RobotDescription& robot) : robot_(robot) {}

  double factor(const canopen::Unit& unit, bool right) const {
    const auto& ankle = right ? robot_.right_ankle : robot_.left_ankle;
    switch (unit.resolution) {
      case canopen::Resolution::kNone:
        return static_cast<double>(unit.numerator) / unit.denominator;
      case canopen::Resolution::kGyro:
        return robot_.imu ? robot_.imu->gyro.resolution * 180.0 / std::numbers::pi : 1.0;
      case canopen::Resolution::kAccelerometer:
        return robot_.imu ? robot_.imu->accelerometer.resolution : 1.0;
      case canopen::Resolution::kForce:
        return ankle ? ankle->force.resolution : 1.0;
      case canopen::Resolution::kTorque:
        return ankle ? ankle->torque.resolution : 1.0;
    }
    return 1.0;
  }

 private:
  const sim_board::RobotDescription& robot_;
};

// Makes an identifier of a name: "Rate x" becomes rate_x.
std::string identifier(std::string_view name) {
  std::string text;
  for (const char letter : name) {
    const auto code = static_cast<unsigned char>(letter);
    text += std::isalnum(code) != 0 ? static_cast<char>(std::tolower(code)) : '_';
  }
  return text;
}

class Builder {
 public:
  explicit Builder(const sim_board::RobotDescription& robot) : robot_(robot), resolutions_(robot) {}

  // The messages that every node has.
  void add_node(std::uint8_t node_id, const std::string& name, std::uint32_t heartbeat_ms) {
    network_.nodes.push_back({node_id, name});
    const bool controller = name == kController;
    const std::string client(controller ? kOperator : kController);
    add(emergency_message(node_id, name, client, controller));
    add(heartbeat_message(node_id, name, client, heartbeat_ms));
    for (Message& sdo : sdo_messages(node_id, name, client)) add(std::move(sdo));
  }

  void add_pdo(const NodeKind& kind, const NetworkNode& node, std::string_view name, PdoConfiguration pdo,
               const std::string& sender, const std::string& receiver) {
    if (pdo.plus_node_id) pdo.cob_id += node.node_id;
    if (sender != node.name) pdo.event_timer_ms = 0;  // of an RPDO it is a deadline
    Message message;
    message.identifier = static_cast<std::uint16_t>(pdo.cob_id & canopen::kCobIdMask);
    message.name = fmt::format("{}_{}", node.name, name);
    message.sender = sender;
    message.cycle_time_ms = cycle_time_ms(pdo);
    message.comment = pdo.transmission_type <= canopen::kMaxSynchronous ? "In time with SYNC."
                      : pdo.event_timer_ms != 0                         ? "By its own clock."
                                                                        : "When there is something to tell.";
    unsigned start_bit = 0;
    for (const std::uint32_t entry : pdo.mapping) {
      if (entry == 0) break;
      message.signals.push_back(make_signal(kind, node, entry, start_bit));
      message.signals.back().receivers = {receiver};
      start_bit += message.signals.back().size_bits;
    }
    message.size_bytes = start_bit / 8;
    add(std::move(message));
  }

  // PDOs numbered from 1 with this prefix, between a node and its peer.
  void add_pdos(const NodeKind& kind, const NetworkNode& node, std::string_view prefix,
                std::span<const PdoConfiguration> pdos, const std::string& sender,
                const std::string& receiver) {
    int number = 0;
    for (const PdoConfiguration& pdo : pdos)
      add_pdo(kind, node, fmt::format("{}{}", prefix, ++number), pdo, sender, receiver);
  }

  void add(Message message) { network_.messages.push_back(std::move(message)); }

  Network finish() {
    network_.nodes.push_back({0, std::string(kOperator)});
    auto& messages = network_.messages;
    std::sort(messages.begin(), messages.end(),
              [](const Message& a, const Message& b) { return a.identifier < b.identifier; });
    const auto twice =
        std::adjacent_find(messages.begin(), messages.end(),
                           [](const Message& a, const Message& b) { return a.identifier == b.identifier; });
    if (twice != messages.end()) {
      throw InputError(robot_.file, 0,
                       fmt::format("the identifier 0x{:03X} for {} and for {}", twice->identifier,
                                   twice->name, std::next(twice)->name),
                       "a node id for each node, and none that the telemetry takes");
    }
    return std::move(network_);
  }

 private:
  static std::uint32_t cycle_time_ms(const PdoConfiguration& pdo) {
    const bool synchronous = pdo.transmission_type >= 1 && pdo.transmission_type <= canopen::kMaxSynchronous;
    return synchronous ? pdo.transmission_type * hal::kControlPeriod_us / 1000 : pdo.event_timer_ms;
  }

  Signal make_signal(const NodeKind& kind, const NetworkNode& node, std::uint32_t entry,
                     unsigned start_bit) const {
    const canopen::ObjectAddress address{static_cast<std::uint16_t>(entry >> 16),
                                         static_cast<std::uint8_t>(entry >> 8)};
    const ObjectItem* item = kind.find(address);
    if (item == nullptr) throw std::logic_error("a PDO maps an object that its node does not have");
    const bool right = node.name.starts_with("right_") || address.index == 0x2021;
    return integer_signal({.name = identifier(item->name),
                           .start_bit = start_bit,
                           .size_bits = entry & 0xFF,
                           .is_signed = is_signed(item->data_type),
                           .factor = resolutions_.factor(item->unit, right),
                           .unit = std::string(item->unit.name),
                           .values = item->values,
                           .comment = item->comment});
  }

  const sim_board::RobotDescription& robot_;
  Resolutions resolutions_;
  Network network_;
};

void add_controller(Builder& builder) {
  const NodeKind kind = controller_kind();
  const NetworkNode node{drive::kControllerNodeId, std::string(kController)};
  const std::string pc(kOperator);
  builder.add(nmt_message(node.name));
  builder.add(sync_message(node.name, hal::kControlPeriod_us / 1000));
  builder.add_node(node.node_id, node.name, kind.description.heartbeat_ms);
  builder.add_pdos(kind, node, "RPDO", kind.description.rpdos, pc, node.name);
  builder.add_pdos(kind, node, "TPDO", kind.description.tpdos, node.name, pc);
}

void add_drives(Builder& builder, const sim_board::RobotDescription& robot) {
  const NodeKind kind = drive_kind();
  const simulation::NamedModel model = simulation::load_named_model(robot);
  for (std::size_t i = 0; i < robot.joints.size(); ++i) {
    const NetworkNode node{robot.joints[i].drive.node_id, robot.joints[i].name};
    const ConfiguredDrive drive = configure_drive(model.model.joints[i], robot.joints[i].drive);
    builder.add_node(node.node_id, node.name, drive.heartbeat_ms);
    builder.add_pdos(kind, node, "RPDO", drive.rpdos, std::string(kController), node.name);
    builder.add_pdos(kind, node, "TPDO", drive.tpdos, node.name, std::string(kController));
  }
}

void add_sensor(Builder& builder, const NodeKind& kind, const NetworkNode& node) {
  builder.add_node(node.node_id, node.name, kind.description.heartbeat_ms);
  builder.add_pdos(kind, node, "TPDO", kind.description.tpdos, node.name, std::string(kController));
}

void add_sensors(Builder& builder, const sim_board::RobotDescription& robot) {
  if (robot.imu) add_sensor(builder, inertial_kind(), {sim_board::kInertialNode, robot.imu->name});
  if (robot.left_ankle)
    add_sensor(builder, ankle_kind(robot.ankle_kind()), {sim_board::kLeftAnkleNode, robot.left_ankle->name});
  if (robot.right_ankle)
    add_sensor(builder, ankle_kind(robot.ankle_kind()),
               {sim_board::kRightAnkleNode, robot.right_ankle->name});
}

}  // namespace

std::vector<NetworkNode> network_nodes(const sim_board::RobotDescription& robot) {
  std::vector<NetworkNode> nodes{{drive::kControllerNodeId, std::string(kController)}};
  for (const sim_board::JointDescription& joint : robot.joints)
    nodes.push_back({joint.drive.node_id, joint.name});
  if (robot.imu) nodes.push_back({sim_board::kInertialNode, robot.imu->name});
  if (robot.left_ankle) nodes.push_back({sim_board::kLeftAnkleNode, robot.left_ankle->name});
  if (robot.right_ankle) nodes.push_back({sim_board::kRightAnkleNode, robot.right_ankle->name});
  return nodes;
}

Network make_network(const sim_board::RobotDescription& robot) {
  Builder builder(robot);
  add_controller(builder);
  add_drives(builder, robot);
  add_sensors(builder, robot);
  return builder.finish();
}

}  // namespace koboshi::bus
