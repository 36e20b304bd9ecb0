#pragma once

#include <cstdint>

// The terms of the drive profile CiA 402-2 that controller and drives share: objects, the states of the power
// drive system and their coding in the statusword, and the commands of the controlword. The state machine
// itself is part of the drive.
namespace koboshi::canopen::cia402 {

// Objects, CiA 402-2. Positions are in 2^-kPositionUnitBits turns of the output shaft; velocities in that
// unit per second, accelerations in that unit per second squared.
inline constexpr std::uint16_t kAbortConnectionOption = 0x6007;
inline constexpr std::uint16_t kErrorCode = 0x603F;
inline constexpr std::uint16_t kControlword = 0x6040;
inline constexpr std::uint16_t kStatusword = 0x6041;
inline constexpr std::uint16_t kQuickStopOption = 0x605A;
inline constexpr std::uint16_t kShutdownOption = 0x605B;
inline constexpr std::uint16_t kDisableOperationOption = 0x605C;
inline constexpr std::uint16_t kHaltOption = 0x605D;
inline constexpr std::uint16_t kFaultReactionOption = 0x605E;
inline constexpr std::uint16_t kModeOfOperation = 0x6060;
inline constexpr std::uint16_t kModeOfOperationDisplay = 0x6061;
inline constexpr std::uint16_t kPositionDemand = 0x6062;
inline constexpr std::uint16_t kPositionActual = 0x6064;
inline constexpr std::uint16_t kFollowingErrorWindow = 0x6065;
inline constexpr std::uint16_t kFollowingErrorTimeOut = 0x6066;  // ms
inline constexpr std::uint16_t kPositionWindow = 0x6067;
inline constexpr std::uint16_t kPositionWindowTime = 0x6068;  // ms
inline constexpr std::uint16_t kVelocityActual = 0x606C;
inline constexpr std::uint16_t kMaxTorque = 0x6072;      // per mille of the rated torque
inline constexpr std::uint16_t kRatedCurrent = 0x6075;   // mA
inline constexpr std::uint16_t kRatedTorque = 0x6076;    // mNm
inline constexpr std::uint16_t kTorqueActual = 0x6077;   // per mille of the rated torque
inline constexpr std::uint16_t kCurrentActual = 0x6078;  // per mille of the rated current
inline constexpr std::uint16_t kSupplyVoltage = 0x6079;  // mV
inline constexpr std::uint16_t kTargetPosition = 0x607A;
inline constexpr std::uint16_t kHomeOffset = 0x607C;
inline constexpr std::uint16_t kSoftwarePositionLimit = 0x607D;
inline constexpr std::uint16_t kMaxMotorSpeed = 0x6080;  // r/min
inline constexpr std::uint16_t kProfileVelocity = 0x6081;
inline constexpr std::uint16_t kProfileAcceleration = 0x6083;
inline constexpr std::uint16_t kProfileDeceleration = 0x6084;
inline constexpr std::uint16_t kQuickStopDeceleration = 0x6085;
inline constexpr std::uint16_t kMotionProfileType = 0x6086;
inline constexpr std::uint16_t kHomingMethod = 0x6098;
inline constexpr std::uint16_t kHomingSpeeds = 0x6099;
inline constexpr std::uint16_t kInterpolationTimePeriod = 0x60C2;
inline constexpr std::uint16_t kMaxAcceleration = 0x60C5;
inline constexpr std::uint16_t kSupportedHomingMethods = 0x60E3;
inline constexpr std::uint16_t kFollowingErrorActual = 0x60F4;
// A record, whose entries are the manufacturer's. Of simulated drives entry 1 is the gain of the position
// loop in 0.001 of the drive's own.
inline constexpr std::uint16_t kPositionControlParameters = 0x60FB;
inline constexpr std::uint16_t kPositionDemandInternal = 0x60FC;
inline constexpr std::uint16_t kSupportedDriveModes = 0x6502;

inline constexpr std::int8_t kNoMode = 0;
inline constexpr std::int8_t kProfilePosition = 1;
inline constexpr std::int8_t kHoming = 6;
inline constexpr std::int8_t kCyclicSynchronousPosition = 8;
inline constexpr std::uint32_t kDeviceType = 0x0002'0192;  // 0x1000: servo drive, profile 402

// Positions on the bus are in 2^-20 turns of the output shaft, 256 to a count of a 12-bit encoder.
inline constexpr int kPositionUnitBits = 20;

// Option codes 0x605A to 0x605E.
inline constexpr std::int16_t kDisableDrive = 0;         // at once: the motor coasts
inline constexpr std::int16_t kStopOnSlowDownRamp = 1;   // 0x6084
inline constexpr std::int16_t kStopOnQuickStopRamp = 2;  // 0x6085
// Quick stop, 0x605A, only: deceleration at the current limit or the voltage limit. Codes 5 to 8 are codes 1
// to 4 after which the drive stays in quick stop active until the controller leaves it (transitions 12 and
// 16).
inline constexpr std::int16_t kStopAtCurrentLimit = 3;
inline constexpr std::int16_t kStopAtVoltageLimit = 4;
inline constexpr std::int16_t kStayInQuickStop = 4;  // added to codes 1 to 4

constexpr bool stays_in_quick_stop(std::int16_t option) { return option > kStayInQuickStop; }

// Error codes of emergency messages, CiA 301 table 26 and CiA 402-2.
inline constexpr std::uint16_t kErrorOverCurrent = 0x2310;   // continuous, at the device's output
inline constexpr std::uint16_t kErrorUnderVoltage = 0x3220;  // of the DC link
inline constexpr std::uint16_t kErrorTemperature = 0x4310;   // excess temperature of the drive
inline constexpr std::uint16_t kErrorParameter = 0x6320;     // also of limits that contradict each other
inline constexpr std::uint16_t kErrorEncoder = 0x7305;       // incremental sensor 1
inline constexpr std::uint16_t kErrorFollowing = 0x8611;
inline constexpr std::uint16_t kErrorHeartbeatLost = 0x8130;
inline constexpr std::uint16_t kErrorSyncLost = 0x8700;

enum class State : std::uint8_t {
  kNotReadyToSwitchOn = 0,
  kSwitchOnDisabled = 1,
  kReadyToSwitchOn = 2,
  kSwitchedOn = 3,
  kOperationEnabled = 4,
  kQuickStopActive = 5,
  kFaultReactionActive = 6,
  kFault = 7,
};

// Statusword bits besides those of the state.
inline constexpr std::uint16_t kVoltageEnabled = 1u << 4;  // the motor's supply is applied, in any state
inline constexpr std::uint16_t kRemote = 1u << 9;
inline constexpr std::uint16_t kTargetReached = 1u << 10;        // profile position mode
inline constexpr std::uint16_t kInternalLimit = 1u << 11;        // an internal limit is active
inline constexpr std::uint16_t kFollowsCommand = 1u << 12;       // cyclic synchronous modes
inline constexpr std::uint16_t kSetPointAcknowledge = 1u << 12;  // profile position mode
inline constexpr std::uint16_t kHomingAttained = 1u << 12;       // homing mode
inline constexpr std::uint16_t kHomingError = 1u << 13;          // homing mode
inline constexpr std::uint16_t kFollowingError = 1u << 13;       // position modes
inline constexpr std::uint16_t kTorqueOff = 1u << 14;            // manufacturer: the drive-enable line is low

// The bits of a statusword that code the state (CiA 402-2, table 28); the others zero.
constexpr std::uint16_t statusword_of(State state) {
  constexpr std::uint16_t kBits[] = {0x00, 0x40, 0x21, 0x23, 0x27, 0x07, 0x0F, 0x08};
  return kBits[static_cast<std::uint8_t>(state)];
}

constexpr bool is_operation_enabled(std::uint16_t statusword) { return (statusword & 0x6F) == 0x27; }

// Whether a drive in a cyclic synchronous mode is in operation enabled and follows its target. Bit 12 is
// clear in every other state, and once the drive has left the mode.
constexpr bool follows_command(std::uint16_t statusword) {
  return is_operation_enabled(statusword) && (statusword & kFollowsCommand) != 0;
}

constexpr State state_of(std::uint16_t statusword) {
  switch (statusword & 0x4F) {
    case 0x40:
      return State::kSwitchOnDisabled;
    case 0x0F:
      return State::kFaultReactionActive;
    case 0x08:
      return State::kFault;
    default:
      break;
  }
  switch (statusword & 0x6F) {
    case 0x21:
      return State::kReadyToSwitchOn;
    case 0x23:
      return State::kSwitchedOn;
    case 0x27:
      return State::kOperationEnabled;
    case 0x07:
      return State::kQuickStopActive;
    default:
      return State::kNotReadyToSwitchOn;
  }
}

// The commands of a controlword (CiA 402-2, table 27), besides fault reset, the rising edge of kFaultReset.
enum class Command : std::uint8_t { kShutdown, kSwitchOn, kDisableVoltage, kQuickStop, kEnableOperation };

inline constexpr std::uint16_t kFaultReset = 0x80;
inline constexpr std::uint16_t kControlDisableVoltage = 0x00;
inline constexpr std::uint16_t kControlQuickStop = 0x02;
inline constexpr std::uint16_t kControlShutdown = 0x06;
inline constexpr std::uint16_t kControlSwitchOn = 0x07;  // in operation enabled: disable operation
inline constexpr std::uint16_t kControlEnableOperation = 0x0F;

// Further bits of a controlword, of profile position mode.
inline constexpr std::uint16_t kNewSetPoint = 1u << 4;  // its rising edge
inline constexpr std::uint16_t kChangeImmediately = 1u << 5;
inline constexpr std::uint16_t kRelative = 1u << 6;
inline constexpr std::uint16_t kHalt = 1u << 8;
inline constexpr std::uint16_t kStartHoming = 1u << 4;  // of homing mode: its rising edge

// Homing methods: the present position becomes home, without a motion. 35 is the older number of 37.
inline constexpr std::int8_t kHomeOnPositionOld = 35;
inline constexpr std::int8_t kHomeOnPosition = 37;

constexpr Command command_of(std::uint16_t controlword) {
  if ((controlword & 0x02) == 0) return Command::kDisableVoltage;
  if ((controlword & 0x04) == 0) return Command::kQuickStop;
  if ((controlword & 0x01) == 0) return Command::kShutdown;
  return (controlword & 0x08) == 0 ? Command::kSwitchOn : Command::kEnableOperation;
}

}  // namespace koboshi::canopen::cia402
