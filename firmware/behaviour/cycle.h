#pragma once

#include <cstdint>
#include <span>

#include "firmware/behaviour/state.h"
#include "firmware/drive/drive_group.h"
#include "firmware/drive/status.h"
#include "firmware/estimation/robot_state.h"

namespace koboshi::behaviour {

// The state of the network in one cycle, as the controller sees it.
struct NetworkStatus {
  bool left = false;              // the controller is no longer operational: another NMT master stopped it
  Reason bus = Reason::kNone;     // why the bus cannot be used; kNone if it can
  bool sensors_starting = false;  // silent sensors are no fault yet: the boot began less than 0.5 s ago
};

// Values of the object dictionary that motions can read, by joint and by number of the input.
struct BusValues {
  std::span<const std::int16_t> torques_permille{};
  std::span<const std::int16_t> inputs{};
};

// The inputs of one control cycle.
struct Cycle {
  const estimation::RobotState& robot;
  const drive::DriveStatus& drives;
  const NetworkStatus& network;
  BusValues values;
  std::uint64_t now_us;
};

// The circumstances by which a command is judged, between two cycles.
struct Circumstances {
  const estimation::RobotState& robot;
  const drive::EnableConditions& drives;
  BusValues values;
  std::uint64_t now_us;
};

}  // namespace koboshi::behaviour
