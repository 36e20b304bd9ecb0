#include "sim_board/servo/drive_dictionary.h"

#include "firmware/canopen/cia402.h"
#include "firmware/canopen/object.h"
#include "firmware/canopen/pdo.h"

namespace koboshi::sim {
namespace {

using canopen::Access;
using canopen::constant;
using canopen::Mappable;
using canopen::mapping;
using canopen::object;
namespace cia402 = canopen::cia402;

#define FIELD(member) KOBOSHI_FIELD(DriveValues, member)

constexpr canopen::Entry kRows[] = {
    object(cia402::kAbortConnectionOption, 0, FIELD(abort_connection_option), Access::kReadWrite)
        .within<std::int16_t>(0, 3),
    object(cia402::kErrorCode, 0, FIELD(error_code), Access::kReadOnly, Mappable::kTpdo),
    object(cia402::kControlword, 0, FIELD(controlword), Access::kReadWrite, Mappable::kRpdo),
    object(cia402::kStatusword, 0, FIELD(statusword), Access::kReadOnly, Mappable::kTpdo),
    object(cia402::kQuickStopOption, 0, FIELD(quick_stop_option), Access::kReadWrite)
        .within<std::int16_t>(2, 2),
    object(cia402::kFaultReactionOption, 0, FIELD(fault_reaction_option), Access::kReadWrite)
        .within<std::int16_t>(2, 2),
    object(cia402::kModeOfOperation, 0, FIELD(mode), Access::kReadWrite, Mappable::kRpdo)
        .within<std::int8_t>(cia402::kCyclicSynchronousPosition, cia402::kCyclicSynchronousPosition),
    object(cia402::kModeOfOperationDisplay, 0, FIELD(mode_display), Access::kReadOnly, Mappable::kTpdo),
    object(cia402::kPositionActual, 0, FIELD(position_actual), Access::kReadOnly, Mappable::kTpdo),
    object(cia402::kRatedTorque, 0, FIELD(rated_torque_mNm), Access::kReadOnly),
    object(cia402::kTorqueActual, 0, FIELD(torque_actual_permille), Access::kReadOnly, Mappable::kTpdo),
    object(cia402::kSupplyVoltage, 0, FIELD(supply_mV), Access::kReadOnly, Mappable::kTpdo),
    object(cia402::kTargetPosition, 0, FIELD(target_position), Access::kReadWrite, Mappable::kRpdo),
    object(cia402::kSoftwarePositionLimit, 1, FIELD(position_limit[0]), Access::kReadWrite).repeated(2, 4),
    object(cia402::kQuickStopDeceleration, 0, FIELD(quick_stop_deceleration), Access::kReadWrite)
        .within<std::uint32_t>(1'000, 0x7FFF'FFFF),
    object(cia402::kInterpolationTimePeriod, 1, FIELD(interpolation_period), Access::kReadWrite)
        .within<std::uint8_t>(1, 250),
    object(cia402::kInterpolationTimePeriod, 2, FIELD(interpolation_exponent), Access::kReadWrite)
        .within<std::int8_t>(-3, -3),
    constant<std::uint32_t>(cia402::kSupportedDriveModes, 0, 1u << (cia402::kCyclicSynchronousPosition - 1)),
};
static_assert(canopen::is_valid_table(kRows, sizeof(DriveValues)));

#undef FIELD

constexpr canopen::PdoConfiguration kRpdos[] = {
    {.cob_id = canopen::kRpdo1Base,
     .plus_node_id = true,
     .transmission_type = canopen::kEventProfile,
     .mapping = {mapping(cia402::kControlword, 0, 16)}},
};

constexpr canopen::PdoConfiguration kTpdos[] = {
    {.cob_id = canopen::kTpdo1Base | canopen::kCobIdNoRemote,
     .plus_node_id = true,
     .transmission_type = canopen::kEventProfile,
     .mapping = {mapping(cia402::kStatusword, 0, 16)}},
};

}  // namespace

canopen::NodeDescription drive_node_description(const DriveDescription& drive) {
  return {
      .device_type = cia402::kDeviceType,
      .vendor_id = drive.vendor_id,
      .product_code = drive.product_code,
      .revision_number = 0x0001'0000,
      .device_name = "Koboshi servo drive",
      .hardware_version = "simulated",
      .software_version = "0.1.0",
      .heartbeat_ms = 0,
      // What a lost controller means is the drive profile's (0x6007); its statusword must stay to be seen.
      .communication_error = canopen::CommunicationError::kNoChange,
      .rows = kRows,
      .rpdos = kRpdos,
      .tpdos = kTpdos,
  };
}

}  // namespace koboshi::sim
