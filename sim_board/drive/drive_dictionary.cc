#include "sim_board/drive/drive_dictionary.h"

#include "firmware/canopen/cia402.h"
#include "firmware/canopen/dictionary.h"
#include "firmware/canopen/pdo.h"
#include "sim_board/drive/drive_objects.h"

namespace koboshi::sim_board {
namespace {

using canopen::mapping;

constexpr auto kRows = canopen::rows_of<kDriveObjects>();
static_assert(canopen::is_valid_table(kRows, sizeof(DriveValues)));

constexpr canopen::PdoConfiguration kRpdos[] = {
    {.cob_id = canopen::kRpdo1Base,
     .plus_node_id = true,
     .transmission_type = canopen::kEventProfile,
     .mapping = {mapping(cia402::kControlword, 0, 16)}},
};

// An event-driven PDO with a value that is never at rest, such as a position with the encoder's noise, takes
// no more of the bus than one in each of the controller's cycles, unless the master wants it to.
constexpr std::uint16_t kInhibitTime_100us = 100;
constexpr canopen::PdoConfiguration kFreeTpdo{.inhibit_time_100us = kInhibitTime_100us};

constexpr canopen::PdoConfiguration kTpdos[] = {
    {.cob_id = canopen::kTpdo1Base | canopen::kCobIdNoRemote,
     .plus_node_id = true,
     .transmission_type = canopen::kEventProfile,
     .inhibit_time_100us = kInhibitTime_100us,
     // The controller's mapping, so that a program decodes the bus by koboshi.dbc without a configured drive.
     .mapping = {mapping(cia402::kStatusword, 0, 16), mapping(cia402::kPositionActual, 0, 32),
                 mapping(cia402::kTorqueActual, 0, 16)}},
    kFreeTpdo,
    kFreeTpdo,
    kFreeTpdo,
};

}  // namespace

// Without a node id the description is that of the kind, whose robots begin at the first range.
canopen::SdoChannel pc_channel(std::uint8_t node_id) {
  const PcSdoRange* const range = node_id == 0 ? kPcSdoRanges.data() : pc_sdo_range(node_id);
  if (range == nullptr) return {};
  return {
      .request_cob_id = range->request_base, .response_cob_id = range->response_base, .plus_node_id = true};
}

canopen::NodeDescription drive_node_description(const DriveDescription& drive) {
  return {
      .device_type = cia402::kDeviceType,
      .vendor_id = drive.vendor_id,
      .product_code = drive.product_code,
      .revision_number = 0x0001'0000,
      .device_name = "Koboshi servo drive",
      .hardware_version = "simulated",
      .software_version = "0.1.0",
      .heartbeat_ms = kNodeHeartbeat_ms,
      // The drive profile decides about a lost controller (0x6007); its statusword must stay visible.
      .communication_error = canopen::CommunicationError::kNoChange,
      .stored_groups = canopen::kAllGroups,
      .field_device = true,
      .second_sdo = pc_channel(drive.node_id),
      .rows = kRows,
      .rpdos = kRpdos,
      .tpdos = kTpdos,
  };
}

}  // namespace koboshi::sim_board
