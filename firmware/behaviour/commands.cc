// The operator's commands: whether they are obeyed, and what they start.

#include "firmware/behaviour/behaviour.h"
#include "firmware/fixed/literals.h"
#include "firmware/fixed/trigonometry.h"
#include "firmware/robot/leg.h"

namespace koboshi::behaviour {

using namespace fixed::literals;

namespace {

// Half and one and a half g. A robot at rest measures one g in any attitude; the margin is ten times the
// zero-g error of an accelerometer of the MPU-6050 class, 0.05 g, so that a robot held in hands passes too.
constexpr fixed::Acceleration kMinAcceleration = 4.9_m_per_s2;
constexpr fixed::Acceleration kMaxAcceleration = 14.7_m_per_s2;

}  // namespace

Reason Behaviour::request(Command command, std::int16_t argument, const Circumstances& circumstances) {
  status_.refusal = judge(command, argument, circumstances);
  return status_.refusal;
}

// Whether the robot does nothing but end what it does, sit down and wait, because its supply is or was low.
bool Behaviour::acts_on_low_supply() const {
  const State state = status_.state;
  return state == State::kLowBattery || state == State::kSittingDown ||
         (kOnItsFeet.contains(state) && supply_guard_.low());
}

// A velocity that is obeyed clears only the refusal of an earlier velocity: velocities come often, and would
// hide the refusal of a command.
Reason Behaviour::request_velocity(const walk::Velocity& velocity) {
  if (acts_on_low_supply()) return status_.refusal = Reason::kSupplyLow;
  const bool obeyed = clamped(velocity, parameters_.velocity_limits) == velocity &&
                      (velocity.turn_mrad_per_s == 0 || robot::can_turn(model_));
  if (obeyed) walk_.set_velocity(velocity);
  if (!obeyed) status_.refusal = Reason::kVelocityOutOfRange;
  if (obeyed && status_.refusal == Reason::kVelocityOutOfRange) status_.refusal = Reason::kNone;
  return obeyed ? Reason::kNone : Reason::kVelocityOutOfRange;
}

Reason Behaviour::judge(Command command, std::int16_t argument, const Circumstances& circumstances) {
  switch (command) {
    case Command::kNone:
      return Reason::kNone;
    case Command::kEnable:
      return enable(circumstances);
    case Command::kLimp:
      return obey_event(Event::kLimp, circumstances.now_us);
    case Command::kPlay:
      return play(argument, circumstances);
    case Command::kStop:
      return stop();
    case Command::kWalk:
      return walk(circumstances);
    case Command::kEmergencyStop:
      return obey_event(Event::kEmergencyStop, circumstances.now_us);
    case Command::kReset:
      return obey_event(Event::kReset, circumstances.now_us);
    case Command::kCalibrate:
      // The measurement takes a second. If the robot moves meanwhile, the refusal comes later.
      return kResting.contains(status_.state) ? Reason::kNone : Reason::kNotInThisState;
    case Command::kGetUp:
      return get_up(circumstances);
    case Command::kStream:
      return stream(circumstances);
  }
  return Reason::kUnknownCommand;
}

Reason Behaviour::obey_event(Event event, std::uint64_t now_us) {
  const auto next = next_state(status_.state, event);
  if (!next) return Reason::kNotInThisState;
  enter(*next, Reason::kCommand, now_us);
  return Reason::kNone;
}

Reason Behaviour::enable(const Circumstances& circumstances) {
  if (status_.state != State::kLimp) return Reason::kNotInThisState;
  const Reason refusal = refusal_to_enable(circumstances);
  return refusal == Reason::kNone ? obey_event(Event::kEnable, circumstances.now_us) : refusal;
}

Reason Behaviour::refusal_to_enable(const Circumstances& circumstances) const {
  const drive::EnableConditions& drives = circumstances.drives;
  if (!drives.disabled) return Reason::kDriveNotReady;
  for (std::size_t joint = 0; joint < model_.joint_count; ++joint) {
    if ((drives.beyond_limits >> joint & 1u) != 0) return Reason::kEncoderBeyondLimits;
    const std::uint32_t supply_mV = drives.supply_mV[joint];
    if (supply_mV < parameters_.power.supply_min_mV || supply_mV > parameters_.power.supply_max_mV)
      return Reason::kSupplyOutOfRange;
  }
  const auto& a = circumstances.robot.accelerations_B;
  const fixed::Acceleration magnitude = fixed::hypotenuse(a.x, a.y, a.z);
  if (supply_guard_.low()) return Reason::kSupplyLow;
  const bool plausible = magnitude > kMinAcceleration && magnitude < kMaxAcceleration;
  return plausible ? Reason::kNone : Reason::kImuImplausible;
}

// In standing it starts the first layer, in a motion or a walk the overlay.
Reason Behaviour::play(std::int16_t number, const Circumstances& circumstances) {
  if (acts_on_low_supply()) return Reason::kSupplyLow;
  const bool overlays = status_.state == State::kMotion || status_.state == State::kWalking;
  if (status_.state != State::kStanding && !overlays) return Reason::kNotInThisState;
  motion::Motion motion;
  // There is one overlay at a time, until its joints have returned.
  if (overlays && overlay_.joints() != 0) return Reason::kNotInThisState;
  const storage::Holder player = overlays ? storage::Holder::kSecondPlayer : storage::Holder::kPlayer;
  if (number < 0 || !motions_.open_to_play(player, static_cast<std::uint16_t>(number), motion))
    return Reason::kNoSuchMotion;
  if (overlays) return play_overlay(motion, static_cast<std::uint8_t>(number), circumstances);
  if ((motion.claimed_joints() & overlay_.joints()) != 0) return Reason::kJointsInUse;
  overlay_.uncover(targets());
  player_.start(motion, static_cast<std::uint8_t>(number), targets(),
                inputs(circumstances.robot, circumstances.values));
  status_.motion = player_.number();
  return obey_event(Event::kPlay, circumstances.now_us);
}

Reason Behaviour::play_overlay(const motion::Motion& motion, std::uint8_t number,
                               const Circumstances& circumstances) {
  const bool walks = status_.state == State::kWalking;
  const std::uint32_t in_use = walks ? walk_.joints() : player_.interpreter().claimed_joints();
  if ((motion.claimed_joints() & in_use) != 0) return Reason::kJointsInUse;
  overlay_.start(motion, targets(), inputs(circumstances.robot, circumstances.values));
  status_.overlay = number;
  return Reason::kNone;
}

// While the robot walks, the command cancels a stop: at once, or, when the closing step has begun, by another
// walk after it. Without a known gyro bias, the estimated attitude drifts: the walk would balance on a wrong
// attitude, and nothing would detect the fall (watch_for_falls).
Reason Behaviour::walk(const Circumstances& circumstances) {
  if (acts_on_low_supply()) return Reason::kSupplyLow;
  if (status_.state == State::kWalking) {
    walk_.resume();
    return Reason::kNone;
  }
  if (status_.state != State::kStanding) return Reason::kNotInThisState;
  const Reason refusal = refusal_to_walk(circumstances.robot);
  if (refusal != Reason::kNone) return refusal;
  begin_walk();
  return obey_event(Event::kWalk, circumstances.now_us);
}

Reason Behaviour::refusal_to_walk(const estimation::RobotState& robot) const {
  if (!walk_.is_possible()) return Reason::kNoLegs;
  if (!walk::is_gait(parameters_.walk)) return Reason::kNoGait;
  if (!robot.gyro_known) return Reason::kGyroBiasUnknown;
  return (overlay_.joints() & walk_.joints()) != 0 ? Reason::kJointsInUse : Reason::kNone;
}

void Behaviour::begin_walk(std::optional<hal::Side> pushed_to) {
  overlay_.uncover(targets());
  player_.abort();
  walk_.start(parameters_.walk, targets(), pushed_to);
}

// While the robot streams, the command only cancels a stop. Without a known gyro bias nothing would detect
// the fall (watch_for_falls).
Reason Behaviour::stream(const Circumstances& circumstances) {
  if (acts_on_low_supply()) return Reason::kSupplyLow;
  if (status_.state == State::kStreaming) {
    stream_.resume();
    return Reason::kNone;
  }
  if (status_.state != State::kStanding) return Reason::kNotInThisState;
  if (!circumstances.robot.gyro_known) return Reason::kGyroBiasUnknown;
  if (overlay_.joints() != 0) return Reason::kJointsInUse;
  player_.abort();
  const auto standing = standing_pose();
  stream_.start(targets(), {standing.data(), model_.joint_count}, parameters_.power.ramp_rate);
  return obey_event(Event::kStream, circumstances.now_us);
}

bool Behaviour::stop_stream() {
  if (status_.state != State::kStreaming) return false;
  const bool followed = stream_.following();
  stream_.stop();
  return followed;
}

Reason Behaviour::get_up(const Circumstances& circumstances) {
  if (status_.state != State::kLimp) return Reason::kNotInThisState;
  recovery_.forget_attempts();
  status_.attempts = 0;
  const Reason refusal = refusal_to_enable(circumstances);
  return refusal == Reason::kNone ? obey_event(Event::kGetUp, circumstances.now_us) : refusal;
}

bool Behaviour::stop_walk() {
  if (status_.state != State::kWalking) return false;
  const bool walked = !walk_.stopping();
  walk_.stop();
  overlay_.stop();
  return walked;
}

Reason Behaviour::stop() {
  switch (status_.state) {
    case State::kMotion:
      player_.stop();
      overlay_.stop();
      return Reason::kNone;
    case State::kWalking:
      stop_walk();
      return Reason::kNone;
    case State::kStreaming:
      stop_stream();
      return Reason::kNone;
    case State::kStanding:
      if (!overlay_.playing()) return Reason::kNotInThisState;
      overlay_.stop();
      return Reason::kNone;
    default:
      return Reason::kNotInThisState;
  }
}

}  // namespace koboshi::behaviour
