#pragma once

#include <cstdint>

namespace koboshi::drive {

// Why a drive cannot be used, as the controller sees it. The values appear in telemetry (object 0x2001).
enum class DriveFault : std::uint8_t {
  kNone = 0,
  kSilent = 1,         // it never booted up
  kNoAnswer = 2,       // an SDO request timed out
  kRefused = 3,        // it aborted an SDO request
  kWrongIdentity = 4,  // 0x1018 is not what the robot model says
  kLost = 5,           // its heartbeat or its answers to SYNC stopped
  kRestarted = 6,      // it booted up again on its own
  kFault = 7,          // it reports a fault, by statusword (CiA 402-2) or emergency message
  kNotEnabled = 8,     // it did not reach operation enabled in time, or left it
  kNotFollowing = 9,   // in operation enabled, but not in cyclic synchronous position mode
};

// The fault of one joint's drive.
struct JointFault {
  DriveFault kind = DriveFault::kNone;
  std::uint8_t joint = 0;
  std::uint16_t error_code = 0;  // of the emergency message, where there was one

  explicit constexpr operator bool() const { return kind != DriveFault::kNone; }
};

}  // namespace koboshi::drive
