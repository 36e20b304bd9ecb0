#include "sim_board/sensor/sensor_dictionary.h"

#include <span>

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

}  // namespace

canopen::NodeDescription sensor_node_description(SensorKind kind) {
  const bool inertial = kind == SensorKind::kInertial;
  return {
      .device_type = 0,         // no device profile
      .vendor_id = 0x4B4F4249,  // not assigned by CiA
      .product_code = inertial ? 0x4B02u : 0x4B03u,
      .revision_number = 0x0001'0000,
      .device_name = inertial ? "Koboshi inertial unit" : "Koboshi ankle sensor",
      .hardware_version = "simulated",
      .software_version = "0.1.0",
      .heartbeat_ms = kSensorHeartbeat_ms,
      .stored_groups = canopen::group_bit(canopen::ParameterGroup::kAll) |
                       canopen::group_bit(canopen::ParameterGroup::kCommunication),  // the only ones it has
      .field_device = true,
      .rows = inertial ? std::span<const canopen::Entry>(kInertialRows) : kAnkleRows,
      .rpdos = {},
      .tpdos = inertial ? kInertialTpdos : kForceTorqueTpdos,
  };
}

}  // namespace koboshi::sim_board
