#pragma once

#include <cstdint>

namespace koboshi::hal {

// A watchdog without a window. When its time-out expires, the board resets and the drive-enable line goes
// low. The firmware kicks the watchdog in each `service`; the expected time-out is 0.5 s, set by hand
// (2026-11-23): it is the last resort, since the drives stop by themselves after 60 ms without the
// controller. The uncalibrated oscillator of hal/stm32/safety.h, 0.34 to 0.94 s, meets it.
class WatchdogPort {
 public:
  // Restarts the time-out.
  virtual void kick(std::uint64_t now_us) = 0;

 protected:
  ~WatchdogPort() = default;
};

// The safe-torque-off line from the controller to all drives, independent of the bus. While it is low no
// drive makes torque. It is low at reset, after a watchdog reset, and in fault handlers.
class DriveEnablePort {
 public:
  // Sets the level: high if `enabled`.
  virtual void set(bool enabled) = 0;

 protected:
  ~DriveEnablePort() = default;
};

}  // namespace koboshi::hal
