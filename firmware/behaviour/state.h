#pragma once

#include <concepts>
#include <cstdint>
#include <optional>

namespace koboshi::behaviour {

// The states of the behaviour. The values are those of telemetry (object 0x2001).
enum class State : std::uint8_t {
  kBoot = 0,       // limp; drives and sensors start
  kLimp = 1,       // limp and ready
  kEnabling = 2,   // the drives go to operation enabled, each holding its position
  kSoftStart = 3,  // slow ramp to the standing pose
  kStanding = 4,
  kMotion = 5,
  kFault = 6,          // the drives stop quickly, then limp
  kEmergencyStop = 7,  // limp at once, by the drive-enable line; latched
  kWalking = 8,        // at the commanded velocity
  kLowBattery = 9,     // stands; refuses to move until it has been limp
  kFalling = 10,       // moves into the protective pose
  kFallen = 11,        // limp until the robot is at rest
  kRighting = 12,      // the drives go to operation enabled again, each holding the position it has
  kRolling = 13,       // from its side onto chest or back
  kRising = 14,
  kSteadying = 15,  // has risen; waits until the robot is at rest
};

enum class Event : std::uint8_t {
  kReady,   // all drives are configured and all sensors have sent samples
  kEnable,  // commands
  kLimp,
  kPlay,
  kWalk,
  kReset,
  kEmergencyStop,
  kEnabled,  // all drives are in operation enabled
  kArrived,  // at the standing pose
  kGetUp,
  kEnded,  // of a motion or a walk
  kLowBattery,
  kFall,                // detected, before the impact
  kDown,                // on the ground, or about to be
  kStill,               // at rest on the ground
  kProneOrSupine,       // on chest or back
  kOnSide,              // on a side
  kUpright,             // the robot is not lying down
  kRecoveryStepFailed,  // the body is not where it should be by now
  kFailure,             // a drive, a sensor or the bus failed
};

// The reason of the last change of state, or of the refusal of the last command. The values are those of
// telemetry.
enum class Reason : std::uint8_t {
  kNone = 0,
  kCommand = 1,
  kProgress = 2,   // the last state was complete
  kSupplyLow = 3,  // for two seconds
  kFallPredicted = 4,
  kRecoveryStepFailed = 5,  // it did not rise, roll or come to rest as it should
  // The pose in which the robot lies.
  kProne = 6,
  kSupine = 7,
  kOnLeftSide = 8,
  kOnRightSide = 9,
  kHeldUpright = 10,
  kCaughtItself = 11,  // it came to rest on its feet after all
  kOnSeat = 12,        // another pose of a robot that lies, as kProne to kOnRightSide
  // Faults: they lead to State::kFault.
  kModelInvalid = 16,  // no valid RobotModel in storage
  kDriveFault = 17,    // its kind, joint and error code stand beside it
  kImuSilent = 18,
  kAnkleSilent = 19,
  kBusOff = 20,
  kNoAcknowledge = 21,   // no other node acknowledges on the bus
  kCannotGetUp = 22,     // no motion for this pose, or no attempt left
  kNotOperational = 23,  // another NMT master stopped the controller
  kSecondMaster = 24,    // another node sends frames that only the controller may send
  // Refusals; the state stays.
  kNotInThisState = 32,
  kEncoderBeyondLimits = 33,
  kSupplyOutOfRange = 34,
  kImuImplausible = 35,
  kNoSuchMotion = 36,
  kUnknownCommand = 37,
  kDriveNotReady = 38,  // a drive is in fault, or still moves since it was last enabled
  kVelocityOutOfRange = 39,
  kNotAtRest = 40,        // the robot moved in the second of its calibration
  kNoGait = 41,           // the parameters of the walk are not set, see walk::is_gait
  kJointsInUse = 43,      // another motion or the walk moves a joint of the motion
  kGyroBiasUnknown = 42,  // no second of rest since power-on, and no bias in the parameters
};

// A set of states.
class States {
 public:
  template <std::same_as<State>... S>
  explicit constexpr States(S... states) : bits_((0u | ... | bit(states))) {}

  constexpr bool contains(State state) const { return (bits_ & bit(state)) != 0; }
  // Returns all other states.
  constexpr States operator~() const { return States(kAll & ~bits_); }
  constexpr States operator|(States other) const { return States(bits_ | other.bits_); }

 private:
  static constexpr std::uint32_t kAll = (1u << (static_cast<unsigned>(State::kSteadying) + 1)) - 1;

  explicit constexpr States(std::uint32_t bits) : bits_(bits) {}
  static constexpr std::uint32_t bit(State state) { return 1u << static_cast<unsigned>(state); }

  std::uint32_t bits_;
};

// The robot is on its feet, and feedback may correct its joints.
inline constexpr States kBalancing{State::kStanding, State::kMotion, State::kWalking, State::kLowBattery,
                                   State::kSteadying};
inline constexpr States kMayFall = kBalancing | States{State::kSoftStart};
// The drives may make torque: the drive-enable line is high. In kFault it keeps its level until the drives
// have stopped.
inline constexpr States kTorque =
    kMayFall | States{State::kEnabling, State::kFalling, State::kRighting, State::kRolling, State::kRising};
// A second motion may play on joints that nothing else moves.
inline constexpr States kMayOverlay{State::kStanding, State::kMotion, State::kWalking, State::kLowBattery};
// The drives make no torque, so that the robot rests unless somebody carries it: the gyro's bias is measured.
inline constexpr States kResting{State::kBoot, State::kLimp, State::kFallen};
// Storage may be written. A motion that is played is pinned in storage, so that it stays. The check of a new
// motion takes milliseconds, which are too long for the balance of a walk or of getting up.
inline constexpr States kMayStore{State::kLimp, State::kStanding, State::kMotion};
// Only a reset leads out of them.
inline constexpr States kLatched{State::kFault, State::kEmergencyStop};

// A transition: in any of the states `from`, the event leads to the state `to`.
struct Rule {
  States from;
  Event event;
  State to;
};

// All transitions. No two rules share both a state and an event; an event without a rule for the state is
// ignored.
inline constexpr Rule kRules[] = {
    {States{State::kBoot}, Event::kReady, State::kLimp},
    {States{State::kLimp}, Event::kEnable, State::kEnabling},
    {States{State::kEnabling}, Event::kEnabled, State::kSoftStart},
    {States{State::kSoftStart}, Event::kArrived, State::kStanding},
    {States{State::kStanding}, Event::kPlay, State::kMotion},
    {States{State::kStanding}, Event::kWalk, State::kWalking},
    {States{State::kMotion, State::kWalking}, Event::kEnded, State::kStanding},
    {States{State::kStanding}, Event::kLowBattery, State::kLowBattery},
    {kMayFall, Event::kFall, State::kFalling},
    {States{State::kFalling}, Event::kDown, State::kFallen},
    {States{State::kLimp}, Event::kGetUp, State::kFallen},
    {States{State::kFallen}, Event::kStill, State::kRighting},
    {States{State::kRighting}, Event::kOnSide, State::kRolling},
    {States{State::kRolling}, Event::kEnded, State::kRighting},
    {States{State::kRighting}, Event::kProneOrSupine, State::kRising},
    {States{State::kRising}, Event::kEnded, State::kSteadying},
    {States{State::kSteadying}, Event::kArrived, State::kStanding},
    {States{State::kFalling, State::kRighting}, Event::kUpright, State::kSoftStart},
    {States{State::kRighting, State::kRolling, State::kRising, State::kSteadying}, Event::kRecoveryStepFailed,
     State::kFallen},
    {kTorque | States{State::kFallen}, Event::kLimp, State::kLimp},
    {~kLatched, Event::kFailure, State::kFault},
    {~States{State::kEmergencyStop}, Event::kEmergencyStop, State::kEmergencyStop},
    {kLatched, Event::kReset, State::kBoot},
};

constexpr std::optional<State> next_state(State from, Event event) {
  for (const Rule& rule : kRules) {
    if (rule.event == event && rule.from.contains(from)) return rule.to;
  }
  return std::nullopt;
}

}  // namespace koboshi::behaviour
