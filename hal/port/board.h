#pragma once

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
};

}  // namespace koboshi::hal
