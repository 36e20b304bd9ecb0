#include "sim_board/sensor/sensor_dictionary.h"

#include <span>
#include <string_view>

#include "firmware/canopen/dictionary.h"
#include "firmware/canopen/pdo.h"
#include "sim_board/sensor/sensor_objects.h"

namespace koboshi::sim_board {
namespace {

using canopen::mapping;

constexpr auto kInertialRows = canopen::rows_of<kInertialObjects>();
constexpr auto kAnkleRows = canopen::rows_of<kAnkleObjects>();
static_assert(canopen::is_valid_table(kInertialRows, sizeof(SensorValues)));
static_assert(canopen::is_valid_table(kAnkleRows, sizeof(SensorValues)));
constexpr auto kPressureCellRows = canopen::rows_of<kPressureCellObjects>();
constexpr auto kContactSwitchRows = canopen::rows_of<kContactSwitchObjects>();
static_assert(canopen::is_valid_table(kPressureCellRows, sizeof(SensorValues)));
static_assert(canopen::is_valid_table(kContactSwitchRows, sizeof(SensorValues)));

// Returns a TPDO of eight bytes: three axes of an object and the number of the sample.
constexpr canopen::PdoConfiguration axes(std::size_t number, std::uint16_t index, std::uint8_t type,
                                         std::uint16_t period_ms) {
  return {.cob_id = static_cast<std::uint32_t>(canopen::kTpdo1Base + number * canopen::kPdoStep) |
                    canopen::kCobIdNoRemote,
          .plus_node_id = true,
          .transmission_type = type,
          .event_timer_ms = period_ms,
          .mapping = {mapping(index, 1, 16), mapping(index, 2, 16), mapping(index, 3, 16),
                      mapping(0x2001, 0, 16)}};
}

constexpr canopen::PdoConfiguration kInertialTpdos[kSensorTpdos] = {
    axes(0, 0x2010, canopen::kEventManufacturer, kInertialPeriod_ms),
    axes(1, 0x2011, canopen::kEventManufacturer, kInertialPeriod_ms),
};
constexpr canopen::PdoConfiguration kForceTorqueTpdos[kSensorTpdos] = {
    axes(0, 0x2020, canopen::kSynchronousEverySync, 0),
    axes(1, 0x2021, canopen::kSynchronousEverySync, 0),
};

constexpr canopen::PdoConfiguration kPressureCellTpdos[] = {
    {.cob_id = canopen::kTpdo1Base | canopen::kCobIdNoRemote,
     .plus_node_id = true,
     .transmission_type = canopen::kSynchronousEverySync,
     .mapping = {mapping(0x7100, 1, 16), mapping(0x7100, 2, 16), mapping(0x7100, 3, 16),
                 mapping(0x7100, 4, 16)}},
};
constexpr canopen::PdoConfiguration kContactSwitchTpdos[] = {
    {.cob_id = canopen::kTpdo1Base | canopen::kCobIdNoRemote,
     .plus_node_id = true,
     .transmission_type = canopen::kSynchronousEverySync,
     .mapping = {mapping(0x6000, 1, 8), mapping(0x2001, 0, 16)}},
};

// The differences between the kinds of sensor nodes.
struct Kind {
  std::uint32_t device_type;
  std::uint32_t product_code;
  std::string_view name;
  std::span<const canopen::Entry> rows;
  std::span<const canopen::PdoConfiguration> tpdos;
};

Kind kind_of(SensorKind kind) {
  constexpr std::uint32_t kNoProfile = 0;
  constexpr std::uint32_t kAnalogueInputs404 = 0x0002'0194;
  constexpr std::uint32_t kDigitalInputs401 = 0x0001'0191;
  switch (kind) {
    case SensorKind::kInertial:
      return {kNoProfile, 0x4B02, "Koboshi inertial unit", kInertialRows, kInertialTpdos};
    case SensorKind::kForceTorque:
      return {kNoProfile, 0x4B03, "Koboshi ankle sensor", kAnkleRows, kForceTorqueTpdos};
    case SensorKind::kPressureCells:
      return {kAnalogueInputs404, 0x4B04, "Koboshi pressure cells", kPressureCellRows, kPressureCellTpdos};
    case SensorKind::kContactSwitch:
      return {kDigitalInputs401, 0x4B05, "Koboshi contact switch", kContactSwitchRows, kContactSwitchTpdos};
  }
  return {};
}

}  // namespace

SensorKind sensor_kind(hal::AnkleKind kind) {
  switch (kind) {
    case hal::AnkleKind::kPressureCells:
      return SensorKind::kPressureCells;
    case hal::AnkleKind::kContactSwitch:
      return SensorKind::kContactSwitch;
    case hal::AnkleKind::kSixAxis:
    case hal::AnkleKind::kNone:
      break;
  }
  return SensorKind::kForceTorque;
}

canopen::NodeDescription sensor_node_description(SensorKind kind) {
  const Kind described = kind_of(kind);
  return {
      .device_type = described.device_type,
      .vendor_id = 0x4B4F4249,  // not assigned by CiA
      .product_code = described.product_code,
      .revision_number = 0x0001'0000,
      .device_name = described.name,
      .hardware_version = "simulated",
      .software_version = "0.1.0",
      .heartbeat_ms = kSensorHeartbeat_ms,
      .stored_groups = canopen::group_bit(canopen::ParameterGroup::kAll) |
                       canopen::group_bit(canopen::ParameterGroup::kCommunication),  // the only ones it has
      .field_device = true,
      .rows = described.rows,
      .rpdos = {},
      .tpdos = described.tpdos,
  };
}

}  // namespace koboshi::sim_board
