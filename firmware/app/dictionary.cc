#include "firmware/app/dictionary.h"

#include <iterator>
#include <span>

#include "firmware/app/controller_objects.h"
#include "firmware/canopen/dictionary.h"
#include "firmware/canopen/pdo.h"
#include "firmware/drive/configuration.h"

namespace koboshi::app {
namespace {

using canopen::mapping;
using canopen::PdoConfiguration;

constexpr auto kRows = canopen::rows_of<kControllerObjects>();
static_assert(canopen::is_valid_table(kRows, sizeof(ControllerValues)));

// Transmission type of what changes slowly: ten times a second.
constexpr std::uint8_t kEveryTenthSync = 10;

constexpr PdoConfiguration kCommandRpdos[] = {
    {.cob_id = canopen::kRpdo1Base,
     .plus_node_id = true,
     .transmission_type = canopen::kEventProfile,
     .mapping = {mapping(0x2000, 1, 8), mapping(0x2000, 2, 16)}},
    {.cob_id = canopen::kRpdo1Base + canopen::kPdoStep,
     .plus_node_id = true,
     .transmission_type = canopen::kEventProfile,
     .event_timer_ms = kVelocityDeadline_ms,
     .mapping = {mapping(0x2110, 1, 16), mapping(0x2110, 2, 16), mapping(0x2110, 3, 16)}},
    {.cob_id = canopen::kRpdo1Base + 2 * canopen::kPdoStep,
     .plus_node_id = true,
     .transmission_type = canopen::kEventProfile,
     .mapping = {mapping(0x2410, 1, 16), mapping(0x2410, 2, 16), mapping(0x2410, 3, 16),
                 mapping(0x2410, 4, 16)}},
};
static_assert(std::size(kCommandRpdos) == kFirstDriveRpdo);

// The predefined connection set (CiA 301, 7.3.5) has four TPDOs for each node. TPDOs 4 to 7 take the
// identifiers of those of node 2, which does not exist on this robot, and TPDOs 8 and 9 those of its RPDOs.
constexpr PdoConfiguration telemetry(std::size_t number,
                                     std::array<std::uint32_t, canopen::kMaxMappedObjects> objects) {
  const std::size_t base = number < 8 ? canopen::kTpdo1Base + number / 4 : canopen::kRpdo1Base + 1;
  return {
      .cob_id = static_cast<std::uint32_t>(base + number % 4 * canopen::kPdoStep) | canopen::kCobIdNoRemote,
      .plus_node_id = true,
      .transmission_type = number < 8 ? canopen::kSynchronousEverySync : kEveryTenthSync,
      .mapping = objects};
}

constexpr PdoConfiguration kTpdos[kTelemetryTpdos] = {
    telemetry(0, {mapping(0x2001, 1, 8), mapping(0x2001, 2, 8), mapping(0x2001, 3, 8), mapping(0x2001, 4, 8),
                  mapping(0x2001, 5, 8), mapping(0x2001, 7, 16), mapping(0x2001, 8, 8)}),
    telemetry(
        1, {mapping(0x2010, 1, 16), mapping(0x2010, 2, 16), mapping(0x2010, 3, 16), mapping(0x2010, 4, 16)}),
    telemetry(
        2, {mapping(0x2020, 3, 16), mapping(0x2020, 4, 16), mapping(0x2020, 5, 16), mapping(0x2010, 5, 16)}),
    telemetry(
        3, {mapping(0x2021, 3, 16), mapping(0x2021, 4, 16), mapping(0x2021, 5, 16), mapping(0x2010, 8, 16)}),
    telemetry(
        4, {mapping(0x2011, 1, 16), mapping(0x2011, 2, 16), mapping(0x2011, 3, 16), mapping(0x2011, 4, 16)}),
    telemetry(
        5, {mapping(0x2011, 5, 16), mapping(0x2011, 6, 16), mapping(0x2011, 7, 16), mapping(0x2011, 8, 16)}),
    telemetry(6, {mapping(0x2011, 9, 16), mapping(0x2011, 10, 8), mapping(0x2011, 11, 16),
                  mapping(0x2011, 12, 16), mapping(0x2012, 9, 8)}),
    telemetry(
        7, {mapping(0x2012, 5, 16), mapping(0x2012, 6, 16), mapping(0x2012, 7, 16), mapping(0x2012, 8, 16)}),
    telemetry(
        8, {mapping(0x2014, 1, 16), mapping(0x2014, 2, 16), mapping(0x2014, 3, 16), mapping(0x2014, 4, 8)}),
    telemetry(
        9, {mapping(0x2014, 5, 16), mapping(0x2014, 6, 16), mapping(0x2014, 7, 16), mapping(0x2014, 8, 16)}),
};

constexpr canopen::NodeDescription described(std::span<const PdoConfiguration> tpdos) {
  return {
      .device_type = 0,  // of no standard profile
      .vendor_id = 0,    // not registered with CiA
      .product_code = 0x4B01,
      .revision_number = 0x0001'0000,
      .device_name = "Koboshi controller",
      .hardware_version = "any",
      .software_version = "0.1.0",
      .heartbeat_ms = drive::kControllerHeartbeat_ms,
      .sync_producer = true,
      .sync_period_us = hal::kControlPeriod_us,
      .sync_by_owner = true,
      // The behaviour state machine decides about a lost drive or bus; until then the drives need SYNC.
      .communication_error = canopen::CommunicationError::kNoChange,
      .stored_groups = canopen::kAllGroups,
      .rows = kRows,
      .rpdos = kCommandRpdos,
      .tpdos = tpdos,
      .watched_tpdos = kTelemetryTpdos,  // those of the drives are triggered in each cycle
  };
}

const canopen::NodeDescription kLargeRobotsNode = described(std::span(kTpdos).first(kTpdosOfALargeRobot));

}  // namespace

const canopen::NodeDescription kControllerNode = described(kTpdos);

const canopen::NodeDescription& controller_node(const robot::RobotModel& model) {
  return model.joint_count > kMaxJointsWithAllTpdos ? kLargeRobotsNode : kControllerNode;
}

canopen::PdoConfiguration drive_pdo(canopen::PdoDirection direction, std::size_t number,
                                    const robot::RobotModel& model) {
  const bool receive = direction == canopen::PdoDirection::kReceive;
  if (receive && number >= kStreamRpdo) return stream_pdo(number, model);
  const std::size_t joint = number - (receive ? kFirstDriveRpdo : kFirstDriveTpdo);
  if (joint >= model.joint_count) return {};
  const std::uint8_t node_id = model.joints[joint].drive.node_id;
  const auto subindex = static_cast<std::uint8_t>(joint + 1);
  if (!receive)
    return {.cob_id = static_cast<std::uint32_t>(canopen::kRpdo1Base + node_id) | canopen::kCobIdNoRemote,
            .transmission_type = canopen::kEventManufacturer,
            .mapping = {mapping(0x2300, subindex, 16), mapping(0x2301, subindex, 32)}};
  return {.cob_id = static_cast<std::uint32_t>(canopen::kTpdo1Base + node_id),
          .transmission_type = canopen::kEventProfile,
          .mapping = {mapping(0x2302, subindex, 16), mapping(0x2303, subindex, 32),
                      mapping(0x2304, subindex, 16)}};
}

canopen::PdoConfiguration stream_pdo(std::size_t number, const robot::RobotModel& model) {
  PdoConfiguration pdo{.transmission_type = canopen::kEventProfile};
  const std::size_t group = number - kStreamRpdo;
  if (group == 0) {
    pdo.cob_id = kStreamSequenceIdentifier;
    pdo.event_timer_ms = kStreamDeadline_ms;
    pdo.mapping = {mapping(kStreamObject, 1, 8)};
    return pdo;
  }
  const bool torques = group > kStreamTargetRpdos;
  const std::size_t place = torques ? group - 1 - kStreamTargetRpdos : group - 1;
  const std::size_t joints = torques ? 8 : 4;
  const std::size_t first = place * joints;
  if (first >= model.joint_count) return {};
  pdo.cob_id = static_cast<std::uint32_t>((torques ? kStreamTorqueBase : kStreamTargetBase) + place);
  for (std::size_t i = 0; i < joints && first + i < model.joint_count; ++i) {
    const auto subindex = static_cast<std::uint8_t>(first + i + 1);
    pdo.mapping[i] =
        torques ? mapping(kStreamTorqueObject, subindex, 8) : mapping(kStreamTargetObject, subindex, 16);
  }
  return pdo;
}

std::uint32_t drive_consumer(std::size_t number, const robot::RobotModel& model) {
  if (number >= model.joint_count) return 0;
  return std::uint32_t{model.joints[number].drive.node_id} << 16 | drive::kDriveHeartbeatLost_ms;
}

}  // namespace koboshi::app
