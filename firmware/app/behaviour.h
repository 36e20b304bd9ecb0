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
  kEnded,    // of a motion or a walk
  kLowBattery,
  kTrouble,  // a drive, a sensor or the bus failed
};

// Why the state is what it is, or why the last command was refused. The values stand in telemetry.
enum class Reason : std::uint8_t {
  kNone = 0,
  kCommand = 1,
  kProgress = 2,   // the last state had come to its end
  kSupplyLow = 3,  // for two seconds
  // Troubles that lead to kFault.
  kModelInvalid = 16,  // no valid RobotModel in storage
  kDriveTrouble = 17,  // see the trouble's kind, joint and error code beside it
  kImuSilent = 18,
  kAnkleSilent = 19,
  kBusOff = 20,
  kNoAcknowledge = 21,  // nobody answers on the bus
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
    {State::kEnabling, Event::kLimp, State::kLimp},
    {State::kSoftStart, Event::kLimp, State::kLimp},
    {State::kStanding, Event::kLimp, State::kLimp},
    {State::kMotion, Event::kLimp, State::kLimp},
    {State::kWalking, Event::kLimp, State::kLimp},
    {State::kLowBattery, Event::kLimp, State::kLimp},
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
    {State::kBoot, Event::kEmergencyStop, State::kEmergencyStop},
    {State::kLimp, Event::kEmergencyStop, State::kEmergencyStop},
    {State::kEnabling, Event::kEmergencyStop, State::kEmergencyStop},
    {State::kSoftStart, Event::kEmergencyStop, State::kEmergencyStop},
    {State::kStanding, Event::kEmergencyStop, State::kEmergencyStop},
    {State::kMotion, Event::kEmergencyStop, State::kEmergencyStop},
    {State::kWalking, Event::kEmergencyStop, State::kEmergencyStop},
    {State::kLowBattery, Event::kEmergencyStop, State::kEmergencyStop},
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
  return state == State::kEnabling || state == State::kSoftStart || state == State::kStanding ||
         state == State::kMotion || state == State::kWalking || state == State::kLowBattery;
}

// Nothing moves the robot but who carries it: where the gyro's bias is measured.
constexpr bool rests(State state) { return state == State::kBoot || state == State::kLimp; }

// The robot is on its feet, and feedback may correct its joints.
constexpr bool balances(State state) {
  return state == State::kStanding || state == State::kMotion || state == State::kWalking ||
         state == State::kLowBattery;
}

// Storage may be written: nothing plays from it, and nobody waits for the robot to move on.
constexpr bool may_store(State state) { return state == State::kLimp || state == State::kStanding; }

}  // namespace koboshi::app
