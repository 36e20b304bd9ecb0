#pragma once

#include <concepts>
#include <cstdint>
#include <optional>

namespace koboshi::behaviour {

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
  kProneOrSupine,   // on chest or back
  kOnSide,  // on a side
  kUpright,    // does not lie at all
  kRecoveryStepFailed,  // the body is not where it should be by now
  kFailure,    // a drive, a sensor or the bus failed
};

// Why the state is what it is, or why the last command was refused. The values stand in telemetry.
enum class Reason : std::uint8_t {
  kNone = 0,
  kCommand = 1,
  kProgress = 2,   // the last state had come to its end
  kSupplyLow = 3,  // for two seconds
  kFallForeseen = 4,
  kRecoveryStepFailed = 5,  // it did not rise, roll or come to rest as it should
  // How it lies.
  kProne = 6,
  kSupine = 7,
  kOnLeftSide = 8,
  kOnRightSide = 9,
  kHeldUpright = 10,
  kCaughtItself = 11,  // it came to rest on its feet after all
  kOnSeat = 12,        // one more of how it lies
  // Faults: they lead to State::kFault.
  kModelInvalid = 16,  // no valid RobotModel in storage
  kDriveFault = 17,    // its kind, joint and error code stand beside it
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
  kNoGait = 41,     // the parameters of the walk are not set, see walk::is_gait
};

// A set of states.
class States {
 public:
  template <std::same_as<State>... S>
  explicit constexpr States(S... states) : bits_((0u | ... | bit(states))) {}

  constexpr bool contains(State state) const { return (bits_ & bit(state)) != 0; }
  // All but these.
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
// The drives may make torque: the level of the drive-enable line. Only in kFault it stays as it was until the
// drives have stopped.
inline constexpr States kTorque =
    kMayFall | States{State::kEnabling, State::kFalling, State::kRighting, State::kRolling, State::kRising};
// Nothing moves the robot but who carries it: where the gyro's bias is measured.
inline constexpr States kResting{State::kBoot, State::kLimp, State::kFallen};
// Storage may be written: nothing plays from it, and nobody waits for the robot to move on.
inline constexpr States kMayStore{State::kLimp, State::kStanding};
// Only a reset leads out of them.
inline constexpr States kLatched{State::kFault, State::kEmergencyStop};

// In any of the states `from` the event leads to the state `to`.
struct Rule {
  States from;
  Event event;
  State to;
};

// All there are. No two have a state and the event in common; an event without a rule for the state is
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
