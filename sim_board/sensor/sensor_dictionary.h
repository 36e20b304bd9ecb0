#pragma once

#include <cstdint>

#include "firmware/canopen/node/node.h"
#include "hal/port/ankle.h"

namespace koboshi::sim_board {

// An inertial unit, or the sensor of a foot.
enum class SensorKind : std::uint8_t {
  kInertial = 1,
  kForceTorque = 2,
  kPressureCells = 3,
  kContactSwitch = 4,
};

// The node of an ankle sensor; not for AnkleKind::kNone.
SensorKind sensor_kind(hal::AnkleKind kind);

// Values of the objects of a sensor node, in the sensor's frame and counts. A node has only the objects of
// its kind.
struct SensorValues {
  SensorKind kind = SensorKind::kInertial;  // 0x2000
  std::uint16_t sample = 0;                 // 0x2001: number of the sample, wraps; in both PDOs of a sample
  std::int16_t gyro[3] = {};                // 0x2010
  std::int16_t accelerometer[3] = {};       // 0x2011: specific force, +1 g upwards at rest
  std::int16_t force[3] = {};               // 0x2020: exerted by the ground side on the shank side
  std::int16_t torque[3] = {};              // 0x2021: same, about the sensor's origin
  std::int16_t cells[hal::kPressureCells] = {};  // 0x7100: force of each cell, as CiA 404 has analogue inputs
  std::uint8_t contact = 0;                      // 0x6000: bit 0, as CiA 401 has digital inputs
  std::uint32_t time_ms = 0;                     // 0x2003: after midnight, by the last TIME message
  std::uint16_t time_days = 0;                   // since 1 January 1984
};

// Event timer of the inertial unit's PDOs. An ankle sensor sends its PDOs at each SYNC.
inline constexpr std::uint16_t kInertialPeriod_ms = 4;
inline constexpr std::uint16_t kSensorHeartbeat_ms = 1000;
inline constexpr std::size_t kSensorTpdos = 2;

// Returns the node's description. TPDO 1 maps gyro or force and the number of the sample, TPDO 2
// accelerometer or torque and the number. Pressure cells have one TPDO with the four cells, a contact switch
// one with its input and the number.
canopen::NodeDescription sensor_node_description(SensorKind kind);

}  // namespace koboshi::sim_board
