#pragma once

#include <cstdint>
#include <span>

#include "hal/port/ankle.h"
#include "hal/port/can.h"
#include "hal/port/imu.h"
#include "hal/port/safety.h"
#include "hal/port/storage.h"

namespace koboshi::hal {

// Everything the firmware knows of the world. The time comes as an argument of each call, in microseconds
// since reset.
struct Board {
  CanPort& can;
  ImuPort& imu;
  AnklePort& ankles;
  StoragePort& storage;
  WatchdogPort& watchdog;
  DriveEnablePort& drive_enable;
  // Nodes of the CAN bus behind `imu` and `ankles`: the firmware is their NMT master. None where the sensors
  // are wired to the controller.
  std::span<const std::uint8_t> sensor_nodes{};
};

}  // namespace koboshi::hal
