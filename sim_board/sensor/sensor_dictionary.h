#pragma once

#include <cstdint>

#include "firmware/canopen/node.h"

namespace koboshi::sim {

// What a sensor node measures: an inertial unit in the trunk, or force and torque below an ankle.
enum class SensorKind : std::uint8_t { kInertial = 1, kForceTorque = 2 };

// The values behind a sensor node's object dictionary, in the sensor's own frame and counts. A node has the
// objects of its own kind only.
struct SensorValues {
  SensorKind kind = SensorKind::kInertial;  // 0x2000
  std::uint16_t sample = 0;            // 0x2001: counts samples and wraps; both PDOs of a sample carry it
  std::int16_t gyro[3] = {};           // 0x2010
  std::int16_t accelerometer[3] = {};  // 0x2011: specific force, +1 g upwards at rest
  std::int16_t force[3] = {};          // 0x2020: what the ground side exerts on the shank side, at the sensor
  std::int16_t torque[3] = {};         // 0x2021
  std::uint32_t time_ms = 0;           // 0x2003: by the last TIME message, after midnight
  std::uint16_t time_days = 0;         // since 1 January 1984
};

inline constexpr std::uint16_t kInertialPeriod_ms = 4;      // the inertial unit's PDOs come by themselves,
inline constexpr std::uint16_t kSensorHeartbeat_ms = 1000;  // an ankle's at each SYNC
inline constexpr std::size_t kSensorTpdos = 2;

// TPDO 1 carries the first three of the node's values and the sample's number, TPDO 2 the others and the
// number.
canopen::NodeDescription sensor_node_description(SensorKind kind);

}  // namespace koboshi::sim
