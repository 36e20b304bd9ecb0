#pragma once

#include <cstdint>
#include <limits>

#include "firmware/canopen/node.h"
#include "sim_board/robot/description.h"

namespace koboshi::sim {

// The values behind a drive's object dictionary, CiA 402. Positions in 2^-20 turn of the shaft.
struct DriveValues {
  std::int16_t abort_connection_option = 1;  // 0x6007: a lost controller is a fault
  std::uint16_t error_code = 0;              // 0x603F
  std::uint16_t controlword = 0;
  std::uint16_t statusword = 0;
  std::int16_t quick_stop_option = 2;      // 0x605A: slow down on the ramp, then switch on disabled
  std::int16_t fault_reaction_option = 2;  // 0x605E: slow down on the ramp
  std::int8_t mode = 0;
  std::int8_t mode_display = 0;
  std::int32_t position_actual = 0;
  std::int16_t torque_actual_permille = 0;  // of 0x6076
  std::uint32_t rated_torque_mNm = 0;       // 0x6076: the stall torque at nominal supply
  std::uint32_t supply_mV = 0;              // 0x6079: what the voltmeter shows
  std::int16_t winding_dC = 0;              // kWindingTemperature: 0.1 C, what the thermometer shows
  std::int32_t target_position = 0;
  // 0x607D: lowest, highest; none before the controller has set them
  std::int32_t position_limit[2] = {std::numeric_limits<std::int32_t>::min(),
                                    std::numeric_limits<std::int32_t>::max()};
  std::uint32_t quick_stop_deceleration = 0;  // 0x6085: 2^-20 turn/s^2
  std::uint8_t interpolation_period = 10;     // 0x60C2:1
  std::int8_t interpolation_exponent = -3;    // 0x60C2:2: powers of ten of a second
};

// The winding's temperature, manufacturer-specific: CiA 402 has none.
inline constexpr std::uint16_t kWindingTemperature = 0x2000;

// A drive's second SDO channel is there for the operator's PC: the first belongs to the controller. Bases to
// which the node id is added; for the ids 16 to 35 they fall into 0x690 to 0x6B7, which CiA 301 leaves free.
inline constexpr std::uint16_t kPcSdoRequestBase = 0x680;
inline constexpr std::uint16_t kPcSdoResponseBase = 0x694;

// What all drives share but their identity, which stands in the robot file.
canopen::NodeDescription drive_node_description(const DriveDescription& drive);

}  // namespace koboshi::sim
