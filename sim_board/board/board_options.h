#pragma once

#include <cstdint>

#include "sim_board/world/options.h"

namespace koboshi::sim_board {

struct BoardOptions {
  WorldOptions world;
  std::uint64_t seed = 1;
  double noise_scale = 1.0;               // scales all random errors of sensors and encoders
  std::uint64_t computing_time_us = 500;  // from a tick to its first frame
  std::uint64_t tick_jitter_us = 0;       // a tick is late by up to this; less than its period
  std::uint64_t service_time_us = 50;     // the same for a service call without a tick
  bool sensors_on_bus = false;  // IMU and ankle sensors are CANopen nodes instead of the controller's own
};

}  // namespace koboshi::sim_board
