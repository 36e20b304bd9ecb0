#pragma once

#include <cstdint>

namespace koboshi::hal {

// A window-less watchdog. Once it starves, the board resets and the drive-enable line is low.
class WatchdogPort {
 public:
  virtual void kick(std::uint64_t now_us) = 0;

 protected:
  ~WatchdogPort() = default;
};

// The safe-torque-off line that goes to all drives beside the bus: while it is low no drive makes torque.
// Low at reset, while the watchdog has bitten, and in fault handlers.
class DriveEnablePort {
 public:
  virtual void set(bool enabled) = 0;

 protected:
  ~DriveEnablePort() = default;
};

}  // namespace koboshi::hal
