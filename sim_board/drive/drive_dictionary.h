#pragma once

#include <cstdint>
#include <limits>

#include "firmware/canopen/cia402.h"
#include "firmware/canopen/node/node.h"
#include "sim_board/description/description.h"
#include "sim_board/drive/pc_sdo.h"

namespace koboshi::sim_board {

// 0x6065 and 0x6067: nothing is watched.
inline constexpr std::uint32_t kWindowOff = 0xFFFF'FFFF;

// The most that a drive does before anybody has told it otherwise. The targets that the controller sent in
// the scenarios of the repository, at a cycle of 10 ms, asked for at most 17.1 degrees in a cycle (the knees
// in a fall, scenarios/get_up.yaml), which is 1,710 degrees/s, and for a change from one cycle to the next
// of 24.9 degrees, which is 249,000 degrees/s^2 (measured in November 2026 from their can.log). These
// are 1.75 times as much, for falls and pushes that no scenario has. All are beyond what a motor can do: the
// demand may run ahead of the shaft, which has the whole voltage from an error of some degrees on.
inline constexpr std::uint32_t kDefaultCyclicStep = 87'500;              // 30.0 degrees
inline constexpr std::uint32_t kDefaultMotorSpeed_rpm = 500;             // 3,000 degrees/s
inline constexpr std::uint32_t kDefaultMaxAcceleration = 1'270'000'000;  // 436,000 degrees/s^2

// 0x6072: as much torque as the supply gives.
inline constexpr std::uint16_t kFullTorque_permille = 1000;

// 0x60FB:1: the gain of the servo's data, and the highest one that the drive accepts.
inline constexpr std::uint16_t kOwnGain_permille = 1000;
inline constexpr std::uint16_t kMaxGain_permille = 2000;

// The values behind a drive's object dictionary, CiA 402. Positions in 2^-20 turn of the shaft.
struct DriveValues {
  std::int16_t abort_connection_option = 1;  // 0x6007: a lost controller is a fault
  std::uint16_t error_code = 0;              // 0x603F
  std::uint16_t controlword = 0;
  std::uint16_t statusword = 0;
  std::int16_t quick_stop_option = 2;         // 0x605A: slow down on the ramp, then switch on disabled
  std::int16_t shutdown_option = 0;           // 0x605B: without a ramp
  std::int16_t disable_operation_option = 0;  // 0x605C: the same; CiA 402-2 would have the ramp
  std::int16_t fault_reaction_option = 2;     // 0x605E: slow down on the ramp
  std::int16_t halt_option = 1;               // 0x605D: slow down on the profile's ramp
  std::int8_t mode = 0;
  std::int8_t mode_display = 0;
  std::int32_t position_demand = 0;  // 0x6062
  std::int32_t position_actual = 0;
  std::int32_t velocity_actual = 0;                          // 0x606C: 2^-20 turn/s
  std::uint16_t max_torque_permille = kFullTorque_permille;  // 0x6072: of 0x6076
  std::uint16_t position_gain_permille = kOwnGain_permille;  // 0x60FB:1: of the drive's own
  std::uint32_t rated_current_mA = 0;                        // 0x6075: the stall current at nominal supply
  std::int16_t current_actual_permille = 0;                  // 0x6078: of 0x6075
  std::int16_t torque_actual_permille = 0;                   // of 0x6076
  std::uint32_t rated_torque_mNm = 0;                        // 0x6076: the stall torque at nominal supply
  std::uint32_t supply_mV = 0;                               // 0x6079: as measured by the drive
  std::int16_t winding_dC = 0;                  // kWindingTemperature: 0.1 C, as measured by the drive
  std::uint32_t following_window = kWindowOff;  // 0x6065: of the following error
  std::uint16_t following_timeout_ms = 0;       // 0x6066: how long it may be larger
  std::uint32_t position_window = kWindowOff;   // 0x6067: of the shaft around a target that it has reached
  std::uint16_t position_window_ms = 0;         // 0x6068: how long it must have been there
  std::int32_t target_position = 0;
  std::int32_t home_offset = 0;  // 0x607C: the position that the shaft has at home
  // 0x607D: lowest, highest; none before the controller has set them
  std::int32_t position_limit[2] = {std::numeric_limits<std::int32_t>::min(),
                                    std::numeric_limits<std::int32_t>::max()};
  std::uint32_t max_motor_speed_rpm = kDefaultMotorSpeed_rpm;    // 0x6080
  std::uint32_t profile_velocity = 0;                            // 0x6081: 2^-20 turn/s
  std::uint32_t profile_acceleration = 0;                        // 0x6083: 2^-20 turn/s^2
  std::uint32_t profile_deceleration = 0;                        // 0x6084
  std::uint32_t quick_stop_deceleration = 0;                     // 0x6085
  std::int16_t motion_profile_type = 0;                          // 0x6086: linear ramps
  std::int8_t homing_method = canopen::cia402::kHomeOnPosition;  // 0x6098
  std::uint32_t homing_speed[2] = {};                        // 0x6099: of methods that move: there are none
  std::uint8_t interpolation_period = 10;                    // 0x60C2:1
  std::uint32_t max_acceleration = kDefaultMaxAcceleration;  // 0x60C5: 2^-20 turn/s^2
  std::int32_t following_error = 0;                          // 0x60F4
  std::int8_t interpolation_exponent = -3;                   // 0x60C2:2: powers of ten of a second
  std::uint32_t largest_cyclic_step = kDefaultCyclicStep;    // kMaxCyclicStep: 2^-20 turn
  std::uint32_t limited_ms = 0;                              // kLimitedTime; saturates
  std::uint32_t time_ms = 0;                                 // kTimeOfDay: after midnight
  std::uint16_t time_days = 0;                               // since 1 January 1984
};

// Manufacturer-specific: CiA 402 has none of them.
inline constexpr std::uint16_t kWindingTemperature = 0x2000;
inline constexpr std::uint16_t kMaxCyclicStep = 0x2001;
inline constexpr std::uint16_t kLimitedTime = 0x2002;
// The time by the last TIME message.
inline constexpr std::uint16_t kTimeOfDay = 0x2003;
// After a reset, of drives and sensors.
inline constexpr std::uint16_t kNodeHeartbeat_ms = 1000;

// The second SDO channel of a drive with this node id (pc_sdo.h): none outside of its ranges.
canopen::SdoChannel pc_channel(std::uint8_t node_id);

// Describes a drive's node. Drives differ in their identity only, which stands in the robot file.
canopen::NodeDescription drive_node_description(const DriveDescription& drive);

}  // namespace koboshi::sim_board
