#include "firmware/app/dictionary.h"

#include "firmware/canopen/object.h"
#include "firmware/canopen/pdo.h"
#include "firmware/drive/configuration.h"

namespace koboshi::app {
namespace {

using canopen::Access;
using canopen::Mappable;
using canopen::mapping;
using canopen::object;
using canopen::PdoConfiguration;

using Values = ControllerValues;

#define FIELD(member) KOBOSHI_FIELD(Values, member)

constexpr std::size_t kJoints = robot::kMaxJoints;
constexpr int kMaxGain = 4096;  // one second

constexpr canopen::Entry kRows[] = {
    object(0x2000, 1, FIELD(request.command), Access::kReadWrite, Mappable::kRpdo),
    object(0x2000, 2, FIELD(request.argument), Access::kReadWrite, Mappable::kRpdo),
    object(0x2001, 1, FIELD(behaviour.state), Access::kReadOnly, Mappable::kTpdo),
    object(0x2001, 2, FIELD(behaviour.reason), Access::kReadOnly, Mappable::kTpdo),
    object(0x2001, 3, FIELD(behaviour.motion), Access::kReadOnly, Mappable::kTpdo),
    object(0x2001, 4, FIELD(behaviour.trouble), Access::kReadOnly, Mappable::kTpdo),
    object(0x2001, 5, FIELD(behaviour.trouble_joint), Access::kReadOnly, Mappable::kTpdo),
    object(0x2001, 6, FIELD(behaviour.trouble_code), Access::kReadOnly, Mappable::kTpdo),
    object(0x2001, 7, FIELD(behaviour.faults), Access::kReadOnly, Mappable::kTpdo),
    object(0x2001, 8, FIELD(behaviour.refusal), Access::kReadOnly, Mappable::kTpdo),
    object(0x2010, 1, FIELD(attitude.roll), Access::kReadOnly, Mappable::kTpdo),
    object(0x2010, 2, FIELD(attitude.pitch), Access::kReadOnly, Mappable::kTpdo),
    object(0x2010, 3, FIELD(attitude.rate[0]), Access::kReadOnly, Mappable::kTpdo).repeated(3, 2),
    object(0x2010, 6, FIELD(attitude.acceleration[0]), Access::kReadOnly, Mappable::kTpdo).repeated(3, 2),
    object(0x2011, 1, FIELD(balance.foot_zmp[0][0]), Access::kReadOnly, Mappable::kTpdo).repeated(4, 2),
    object(0x2011, 5, FIELD(balance.zmp[0]), Access::kReadOnly, Mappable::kTpdo).repeated(2, 2),
    object(0x2011, 7, FIELD(balance.com[0]), Access::kReadOnly, Mappable::kTpdo).repeated(3, 2),
    object(0x2011, 10, FIELD(balance.flags), Access::kReadOnly, Mappable::kTpdo),
    object(0x2020, 1, FIELD(ankles[0][0]), Access::kReadOnly, Mappable::kTpdo).repeated(6, 2),
    object(0x2021, 1, FIELD(ankles[1][0]), Access::kReadOnly, Mappable::kTpdo).repeated(6, 2),
    object(0x2100, 1, FIELD(parameters.supply_min_mV), Access::kReadWrite),
    object(0x2100, 2, FIELD(parameters.supply_max_mV), Access::kReadWrite),
    object(0x2100, 3, FIELD(parameters.ramp_rate), Access::kReadWrite).within<std::int16_t>(68, 4096),
    object(0x2101, 1, FIELD(feedback.ankle_pitch), Access::kReadWrite).within(-kMaxGain, kMaxGain),
    object(0x2101, 2, FIELD(feedback.ankle_roll), Access::kReadWrite).within(-kMaxGain, kMaxGain),
    object(0x2101, 3, FIELD(feedback.hip_roll), Access::kReadWrite).within(-kMaxGain, kMaxGain),
    object(0x2101, 4, FIELD(feedback.knee), Access::kReadWrite).within(-kMaxGain, kMaxGain),
    object(0x2200, 1, FIELD(diagnosis.model_id), Access::kReadOnly),
    object(0x2200, 2, FIELD(diagnosis.motions), Access::kReadOnly),
    object(0x2200, 3, FIELD(diagnosis.frames_lost), Access::kReadOnly),
    object(0x2200, 4, FIELD(diagnosis.imu_overruns), Access::kReadOnly),
    object(0x2200, 5, FIELD(diagnosis.receive_overruns), Access::kReadOnly),
    object(0x2200, 6, FIELD(diagnosis.gyro_calibrations), Access::kReadOnly),
    object(0x2200, 7, FIELD(diagnosis.gyro_bias[0]), Access::kReadOnly).repeated(3, 2),
    object(0x2300, 1, FIELD(drives.controlword[0]), Access::kReadOnly, Mappable::kTpdo).repeated(kJoints, 2),
    object(0x2301, 1, FIELD(drives.target_position[0]), Access::kReadOnly, Mappable::kTpdo)
        .repeated(kJoints, 4),
    // What arrives in PDOs must be writable for them; by SDO it would be overwritten in the next cycle.
    object(0x2302, 1, FIELD(drives.statusword[0]), Access::kReadWrite, Mappable::kRpdo).repeated(kJoints, 2),
    object(0x2303, 1, FIELD(drives.position[0]), Access::kReadWrite, Mappable::kRpdo).repeated(kJoints, 4),
    object(0x2304, 1, FIELD(drives.torque_permille[0]), Access::kReadWrite, Mappable::kRpdo)
        .repeated(kJoints, 2),
};
static_assert(canopen::is_valid_table(kRows, sizeof(Values)));

#undef FIELD

constexpr PdoConfiguration kRpdos[] = {
    {.cob_id = canopen::kRpdo1Base,
     .plus_node_id = true,
     .transmission_type = canopen::kEventProfile,
     .mapping = {mapping(0x2000, 1, 8), mapping(0x2000, 2, 16)}},
};

// The predefined connection set has four TPDOs a node. The next are those of node 2, which the robot does not
// have.
constexpr PdoConfiguration telemetry(std::size_t number,
                                     std::array<std::uint32_t, canopen::kMaxMappedObjects> objects) {
  return {.cob_id =
              static_cast<std::uint32_t>(canopen::kTpdo1Base + number % 4 * canopen::kPdoStep + number / 4) |
              canopen::kCobIdNoRemote,
          .plus_node_id = true,
          .transmission_type = canopen::kSynchronousEverySync,
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
    telemetry(6, {mapping(0x2011, 9, 16), mapping(0x2011, 10, 8)}),
};

}  // namespace

const canopen::NodeDescription kControllerNode{
    .device_type = 0,  // of no standard profile
    .vendor_id = 0,    // not registered with CiA
    .product_code = 0x4B01,
    .revision_number = 0x0001'0000,
    .device_name = "Koboshi controller",
    .hardware_version = "any",
    .software_version = "0.1.0",
    .heartbeat_ms = drive::kControllerHeartbeat_ms,
    .sync_producer = true,
    // The behaviour state machine decides what a lost drive or bus means; until it has, the drives want SYNC.
    .communication_error = canopen::CommunicationError::kNoChange,
    .rows = kRows,
    .rpdos = kRpdos,
    .tpdos = kTpdos,
};

canopen::PdoConfiguration drive_rpdo(std::size_t joint, std::uint8_t node_id) {
  const auto subindex = static_cast<std::uint8_t>(joint + 1);
  return {.cob_id = static_cast<std::uint32_t>(canopen::kTpdo1Base + node_id),
          .transmission_type = canopen::kEventProfile,
          .mapping = {mapping(0x2302, subindex, 16), mapping(0x2303, subindex, 32),
                      mapping(0x2304, subindex, 16)}};
}

canopen::PdoConfiguration drive_tpdo(std::size_t joint, std::uint8_t node_id) {
  const auto subindex = static_cast<std::uint8_t>(joint + 1);
  return {.cob_id = static_cast<std::uint32_t>(canopen::kRpdo1Base + node_id) | canopen::kCobIdNoRemote,
          .transmission_type = canopen::kEventManufacturer,
          .mapping = {mapping(0x2300, subindex, 16), mapping(0x2301, subindex, 32)}};
}

}  // namespace koboshi::app
