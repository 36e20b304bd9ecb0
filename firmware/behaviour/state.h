#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <optional>
#include <string_view>

namespace koboshi::behaviour {

// The states of the behaviour. The values are those of telemetry (object 0x2001), without a gap; each has a
// row in kStates.
enum class State : std::uint8_t {
  kBoot = 0,
  kLimp = 1,
  kEnabling = 2,
  kSoftStart = 3,
  kStanding = 4,
  kMotion = 5,
  kFault = 6,
  kEmergencyStop = 7,
  kWalking = 8,
  kLowBattery = 9,
  kFalling = 10,
  kFallen = 11,
  kRighting = 12,
  kRolling = 13,
  kRising = 14,
  kSteadying = 15,
  kSittingDown = 16,
  kStreaming = 17,
};

// The generator of a state's joint targets (motion_source.h); kNone: the targets stay, or follow the
// joints.
enum class Source : std::uint8_t { kNone, kSoftStart, kMotion, kWalk, kSittingDown, kStream };
inline constexpr std::size_t kSources = 6;

// Properties of states, combined by |.
using Traits = std::uint16_t;
// The robot is on its feet and plays, walks or stands: a second motion may play on joints that nothing else
// moves.
inline constexpr Traits kIsOnItsFeet = 1u << 0;
// Feedback may correct the joints.
inline constexpr Traits kBalances = 1u << 1;
// Falls are detected.
inline constexpr Traits kFalls = 1u << 2;
// The drives may make torque: the drive-enable line is high. In kFault it keeps its level until the drives
// have stopped.
inline constexpr Traits kHasTorque = 1u << 3;
// The drives make no torque, so that the robot rests unless somebody carries it: the gyro's bias is measured.
inline constexpr Traits kRests = 1u << 4;
// Storage may be written. A motion that is played is pinned in storage, so that it stays. The check of a new
// motion takes milliseconds, which are too long for the balance of a walk or of getting up.
inline constexpr Traits kStores = 1u << 5;
// Only a reset leads out of it.
inline constexpr Traits kIsLatched = 1u << 6;
// Class Recovery runs it.
inline constexpr Traits kRecovers = 1u << 7;
// A part of standing up.
inline constexpr Traits kGetsUp = 1u << 8;

// The properties of a state, beside the transitions to and from it (kRules). Everything that depends on
// states derives from this table: sets of states, names on the bus and in recordings.
struct StateRow {
  State state;
  std::string_view name;
  Traits traits;
  Source source = Source::kNone;
};

inline constexpr Traits kOnFeet = kIsOnItsFeet | kBalances | kFalls | kHasTorque;
inline constexpr Traits kUpAgain = kRecovers | kGetsUp | kHasTorque;

// By the value of the state.
inline constexpr StateRow kStates[] = {
    {State::kBoot, "boot", kRests},  // limp; drives and sensors start
    {State::kLimp, "limp", kRests | kStores},
    {State::kEnabling, "enabling",
     kHasTorque},  // the drives go to operation enabled, each holding its position
    {State::kSoftStart, "soft start", kFalls | kHasTorque, Source::kSoftStart},  // to the standing pose
    {State::kStanding, "standing", kOnFeet | kStores},
    {State::kMotion, "motion", kOnFeet | kStores, Source::kMotion},
    {State::kFault, "fault", kIsLatched},                   // the drives stop quickly, then limp
    {State::kEmergencyStop, "emergency stop", kIsLatched},  // limp at once, by the drive-enable line
    {State::kWalking, "walking", kOnFeet, Source::kWalk},   // at the commanded velocity
    {State::kLowBattery, "low battery", kOnFeet},           // stands; refuses to move until it has been limp
    {State::kFalling, "falling", kRecovers | kHasTorque},   // moves into the protective pose
    {State::kFallen, "fallen", kRecovers | kRests},         // limp until the robot is at rest
    {State::kRighting, "righting", kUpAgain},               // the drives go to operation enabled again
    {State::kRolling, "rolling", kUpAgain},                 // from its side onto chest or back
    {State::kRising, "rising", kUpAgain},
    {State::kSteadying, "steadying", kUpAgain | kBalances | kFalls},  // has risen; waits until it is at rest
    // Ends its motion or walk and sits down, for its supply is low.
    {State::kSittingDown, "sitting down", kOnFeet, Source::kSittingDown},
    // Follows joint targets from outside; whoever sends them balances the robot.
    {State::kStreaming, "streaming", kIsOnItsFeet | kFalls | kHasTorque, Source::kStream},
};

enum class Event : std::uint8_t {
  kReady,   // all drives are configured and all sensors have sent samples
  kEnable,  // commands
  kLimp,
  kPlay,
  kWalk,
  kStream,
  kReset,
  kEmergencyStop,
  kEnabled,  // all drives are in operation enabled
  kGetUp,
  kEnded,   // of the state's source of targets
  kPushed,  // beyond what a robot that stands can take
  kLowBattery,
  kSitDown,             // the supply is low, and the robot has a motion for it
  kFall,                // detected, before the impact
  kDown,                // on the ground, or about to be
  kStill,               // at rest on the ground
  kProneOrSupine,       // on chest or back
  kOnSide,              // on a side
  kUpright,             // the robot is not lying down
  kSteady,              // at rest on its feet, having risen
  kRecoveryStepFailed,  // the body is not where it should be by now
  kFailure,             // a drive, a sensor or the bus failed
};

// The reason of the last change of state, or of the refusal of the last command. The values are those of
// telemetry.
enum class Reason : std::uint8_t {
  kNone = 0,
  kCommand = 1,
  kProgress = 2,   // the last state was complete
  kSupplyLow = 3,  // for two seconds; also a refusal
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
  kPushed = 13,        // steps catch what the soles alone do not
  kMotionFailed = 14,  // an attitude that it expects, or a wait, was not met, or it says so itself
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
  kNoLegs = 44,           // the legs lack joints for a walk, see robot::can_walk
  kJointsInUse = 43,      // another motion or the walk moves a joint of the motion
  kGyroBiasUnknown = 42,  // no second of rest since power-on, and no bias in the parameters
};

// A set of states.
class States {
 public:
  template <std::same_as<State>... S>
  explicit constexpr States(S... states) : bits_((0u | ... | bit(states))) {}
  // The states with this trait.
  static constexpr States with(Traits trait) {
    std::uint32_t bits = 0;
    for (const StateRow& row : kStates) bits |= (row.traits & trait) != 0 ? bit(row.state) : 0;
    return States(bits);
  }

  constexpr bool contains(State state) const { return (bits_ & bit(state)) != 0; }
  // Returns all other states.
  constexpr States operator~() const { return States(kAll & ~bits_); }
  constexpr States operator|(States other) const { return States(bits_ | other.bits_); }

 private:
  static constexpr std::uint32_t kAll = (1u << std::size(kStates)) - 1;

  explicit constexpr States(std::uint32_t bits) : bits_(bits) {}
  static constexpr std::uint32_t bit(State state) { return 1u << static_cast<unsigned>(state); }

  std::uint32_t bits_;
};

inline constexpr States kOnItsFeet = States::with(kIsOnItsFeet);
inline constexpr States kBalancing = States::with(kBalances);
inline constexpr States kMayFall = States::with(kFalls);
inline constexpr States kTorque = States::with(kHasTorque);
inline constexpr States kResting = States::with(kRests);
inline constexpr States kMayStore = States::with(kStores);
inline constexpr States kLatched = States::with(kIsLatched);
inline constexpr States kRecovering = States::with(kRecovers);
inline constexpr States kGettingUp = States::with(kGetsUp);

// By state, without the names, which an image does not need.
inline constexpr auto kSourceOf = [] {
  std::array<Source, std::size(kStates)> sources{};
  for (std::size_t i = 0; i < sources.size(); ++i) sources[i] = kStates[i].source;
  return sources;
}();
static_assert(
    [] {
      for (std::size_t i = 0; i < std::size(kStates); ++i)
        if (static_cast<std::size_t>(kStates[i].state) != i) return false;
      return true;
    }(),
    "row i is that of state i");

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
    {States{State::kSoftStart}, Event::kEnded, State::kStanding},
    {States{State::kStanding}, Event::kPlay, State::kMotion},
    {States{State::kStanding}, Event::kWalk, State::kWalking},
    {States{State::kStanding}, Event::kStream, State::kStreaming},
    {States{State::kStanding}, Event::kPushed, State::kWalking},
    {States{State::kMotion, State::kWalking, State::kStreaming}, Event::kEnded, State::kStanding},
    {States{State::kStanding, State::kMotion, State::kWalking, State::kStreaming}, Event::kSitDown,
     State::kSittingDown},
    {States{State::kSittingDown}, Event::kEnded, State::kLimp},
    {States{State::kStanding, State::kSittingDown}, Event::kLowBattery, State::kLowBattery},
    {States{State::kFallen}, Event::kLowBattery, State::kLimp},
    {kMayFall, Event::kFall, State::kFalling},
    {States{State::kFalling}, Event::kDown, State::kFallen},
    {States{State::kLimp}, Event::kGetUp, State::kFallen},
    {States{State::kFallen}, Event::kStill, State::kRighting},
    {States{State::kRighting}, Event::kOnSide, State::kRolling},
    {States{State::kRolling}, Event::kEnded, State::kRighting},
    {States{State::kRighting}, Event::kProneOrSupine, State::kRising},
    {States{State::kRising}, Event::kEnded, State::kSteadying},
    {States{State::kSteadying}, Event::kSteady, State::kStanding},
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
