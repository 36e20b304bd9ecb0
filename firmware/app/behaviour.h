#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

namespace koboshi::app {

// What the robot as a whole is doing. The values stand in telemetry (object 0x2001).
enum class State : std::uint8_t {
  kBoot = 0,       // limp; drives and sensors are being started
  kLimp = 1,       // limp and ready
  kEnabling = 2,   // the drives go to operation enabled, each holding the position it has
  kSoftStart = 3,  // a slow ramp to the standing pose
  kStanding = 4,
  kMotion = 5,
  kFault = 6,          // the drives stop quickly, then limp
  kEmergencyStop = 7,  // limp at once, by the drive-enable line; latched
  kWalking = 8,        // where the velocity says
  kLowBattery = 9,     // stands, and does nothing else before it was limp
  kFalling = 10,       // takes the pose in which it is to meet the ground
  kFallen = 11,        // limp until it lies still
  kRighting = 12,      // the drives go to operation enabled again, each holding the position it has
  kRolling = 13,       // from a side to chest or back
  kRising = 14,
  kSteadying = 15,  // has risen, and is to come to rest
};

enum class Event : std::uint8_t {
  kReady,   // every drive is configured and every sensor has spoken
  kEnable,  // commands
  kLimp,
  kPlay,
  kWalk,
  kReset,
  kEmergencyStop,
  kEnabled,  // every drive is in operation enabled
  kArrived,  // at the standing pose
  kGetUp,
  kEnded,  // of a motion or a walk
  kLowBattery,
  kFall,       // is foreseen
  kDown,       // on the ground, or as good as
  kStill,      // lies still
  kLiesFlat,   // on chest or back
  kLiesAside,  // on a side
  kUpright,    // does not lie at all
  kElsewhere,  // the body is not where it should be by now
  kTrouble,    // a drive, a sensor or the bus failed
};

// Why the state is what it is, or why the last command was refused. The values stand in telemetry.
enum class Reason : std::uint8_t {
  kNone = 0,
  kCommand = 1,
  kProgress = 2,   // the last state had come to its end
  kSupplyLow = 3,  // for two seconds
  kFallForeseen = 4,
  kBodyElsewhere = 5,  // it did not rise, roll or come to rest as it should
  // How it lies.
  kProne = 6,
  kSupine = 7,
  kOnLeftSide = 8,
  kOnRightSide = 9,
  kHeldUpright = 10,
  kCaughtItself = 11,  // it came to rest on its feet after all
  kOnSeat = 12,        // one more of how it lies
  // Troubles that lead to kFault.
  kModelInvalid = 16,  // no valid RobotModel in storage
  kDriveTrouble = 17,  // see the trouble's kind, joint and error code beside it
  kImuSilent = 18,
  kAnkleSilent = 19,
  kBusOff = 20,
  kNoAcknowledge = 21,   // nobody answers on the bus
  kCannotGetUp = 22,     // no motion for it, or no attempt left
  kNotOperational = 23,  // another NMT master took the controller out of operational
  kSecondMaster = 24,    // another node sends what only the controller may
  // Refusals; the state stays.
  kNotInThisState = 32,
  kEncoderBeyondLimits = 33,
  kSupplyOutOfRange = 34,
  kImuImplausible = 35,
  kNoSuchMotion = 36,
  kUnknownCommand = 37,
  kDriveNotReady = 38,  // a drive is in fault, or has not come to rest since it was enabled last
  kVelocityOutOfRange = 39,
  kNotAtRest = 40,  // the robot moved in the second of its calibration
};

struct Transition {
  State from;
  Event event;
  State to;
};

// All there are; an event without a row for the state is ignored. kTrouble and kEmergencyStop come last: they
// hold for many states.
inline constexpr Transition kTransitions[] = {
    {State::kBoot, Event::kReady, State::kLimp},
    {State::kLimp, Event::kEnable, State::kEnabling},
    {State::kEnabling, Event::kEnabled, State::kSoftStart},
    {State::kSoftStart, Event::kArrived, State::kStanding},
    {State::kStanding, Event::kPlay, State::kMotion},
    {State::kMotion, Event::kEnded, State::kStanding},
    {State::kStanding, Event::kWalk, State::kWalking},
    {State::kWalking, Event::kEnded, State::kStanding},
    {State::kStanding, Event::kLowBattery, State::kLowBattery},
    {State::kSoftStart, Event::kFall, State::kFalling},
    {State::kStanding, Event::kFall, State::kFalling},
    {State::kMotion, Event::kFall, State::kFalling},
    {State::kWalking, Event::kFall, State::kFalling},
    {State::kLowBattery, Event::kFall, State::kFalling},
    {State::kSteadying, Event::kFall, State::kFalling},
    {State::kFalling, Event::kDown, State::kFallen},
    {State::kFalling, Event::kUpright, State::kSoftStart},
    {State::kLimp, Event::kGetUp, State::kFallen},
    {State::kFallen, Event::kStill, State::kRighting},
    {State::kRighting, Event::kLiesAside, State::kRolling},
    {State::kRighting, Event::kLiesFlat, State::kRising},
    {State::kRighting, Event::kUpright, State::kSoftStart},
    {State::kRighting, Event::kElsewhere, State::kFallen},
    {State::kRolling, Event::kEnded, State::kRighting},
    {State::kRolling, Event::kElsewhere, State::kFallen},
    {State::kRising, Event::kEnded, State::kSteadying},
    {State::kRising, Event::kElsewhere, State::kFallen},
    {State::kSteadying, Event::kArrived, State::kStanding},
    {State::kSteadying, Event::kElsewhere, State::kFallen},
    {State::kEnabling, Event::kLimp, State::kLimp},
    {State::kSoftStart, Event::kLimp, State::kLimp},
    {State::kStanding, Event::kLimp, State::kLimp},
    {State::kMotion, Event::kLimp, State::kLimp},
    {State::kWalking, Event::kLimp, State::kLimp},
    {State::kLowBattery, Event::kLimp, State::kLimp},
    {State::kFalling, Event::kLimp, State::kLimp},
    {State::kFallen, Event::kLimp, State::kLimp},
    {State::kRighting, Event::kLimp, State::kLimp},
    {State::kRolling, Event::kLimp, State::kLimp},
    {State::kRising, Event::kLimp, State::kLimp},
    {State::kSteadying, Event::kLimp, State::kLimp},
    {State::kFault, Event::kReset, State::kBoot},
    {State::kEmergencyStop, Event::kReset, State::kBoot},
    {State::kBoot, Event::kTrouble, State::kFault},
    {State::kLimp, Event::kTrouble, State::kFault},
    {State::kEnabling, Event::kTrouble, State::kFault},
    {State::kSoftStart, Event::kTrouble, State::kFault},
    {State::kStanding, Event::kTrouble, State::kFault},
    {State::kMotion, Event::kTrouble, State::kFault},
    {State::kWalking, Event::kTrouble, State::kFault},
    {State::kLowBattery, Event::kTrouble, State::kFault},
    {State::kFalling, Event::kTrouble, State::kFault},
    {State::kFallen, Event::kTrouble, State::kFault},
    {State::kRighting, Event::kTrouble, State::kFault},
    {State::kRolling, Event::kTrouble, State::kFault},
    {State::kRising, Event::kTrouble, State::kFault},
    {State::kSteadying, Event::kTrouble, State::kFault},
    {State::kBoot, Event::kEmergencyStop, State::kEmergencyStop},
    {State::kLimp, Event::kEmergencyStop, State::kEmergencyStop},
    {State::kEnabling, Event::kEmergencyStop, State::kEmergencyStop},
    {State::kSoftStart, Event::kEmergencyStop, State::kEmergencyStop},
    {State::kStanding, Event::kEmergencyStop, State::kEmergencyStop},
    {State::kMotion, Event::kEmergencyStop, State::kEmergencyStop},
    {State::kWalking, Event::kEmergencyStop, State::kEmergencyStop},
    {State::kLowBattery, Event::kEmergencyStop, State::kEmergencyStop},
    {State::kFalling, Event::kEmergencyStop, State::kEmergencyStop},
    {State::kFallen, Event::kEmergencyStop, State::kEmergencyStop},
    {State::kRighting, Event::kEmergencyStop, State::kEmergencyStop},
    {State::kRolling, Event::kEmergencyStop, State::kEmergencyStop},
    {State::kRising, Event::kEmergencyStop, State::kEmergencyStop},
    {State::kSteadying, Event::kEmergencyStop, State::kEmergencyStop},
    {State::kFault, Event::kEmergencyStop, State::kEmergencyStop},
};

constexpr std::optional<State> next_state(State from, Event event) {
  for (const Transition& transition : kTransitions) {
    if (transition.from == from && transition.event == event) return transition.to;
  }
  return std::nullopt;
}

// Whether the drives may make torque: the level of the drive-enable line. Only in kFault it stays as it was
// until the drives have stopped.
constexpr bool makes_torque(State state) {
  switch (state) {
    case State::kBoot:
    case State::kLimp:
    case State::kFault:
    case State::kEmergencyStop:
    case State::kFallen:
      return false;
    default:
      return true;
  }
}

// Nothing moves the robot but who carries it: where the gyro's bias is measured.
constexpr bool rests(State state) {
  return state == State::kBoot || state == State::kLimp || state == State::kFallen;
}

// The robot is on its feet, and feedback may correct its joints.
constexpr bool balances(State state) {
  return state == State::kStanding || state == State::kMotion || state == State::kWalking ||
         state == State::kLowBattery || state == State::kSteadying;
}

constexpr bool may_fall(State state) { return balances(state) || state == State::kSoftStart; }

// Storage may be written: nothing plays from it, and nobody waits for the robot to move on.
constexpr bool may_store(State state) { return state == State::kLimp || state == State::kStanding; }

}  // namespace koboshi::app
