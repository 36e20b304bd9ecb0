#pragma once

#include <cstdint>
#include <span>

#include "hal/port/ankle.h"
#include "hal/port/can.h"
#include "hal/port/imu.h"
#include "hal/port/safety.h"
#include "hal/port/storage.h"

namespace koboshi::hal {

// The hardware behind the firmware: a reference to each driver. The drivers must outlive the firmware. There
// is no clock driver: each call receives the time, in microseconds since reset, as an argument.
struct Board {
  CanPort& can;
  ImuPort& imu;
  AnklePort& ankles;
  StoragePort& storage;
  WatchdogPort& watchdog;
  DriveEnablePort& drive_enable;
  // Node ids of the sensors behind `imu` and `ankles` that are nodes of the CAN bus; the firmware is their
  // NMT master. Empty if the sensors are wired to the controller.
  std::span<const std::uint8_t> sensor_nodes{};
};

}  // namespace koboshi::hal
