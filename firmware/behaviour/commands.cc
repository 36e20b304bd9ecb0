// The operator's commands: whether they are obeyed, and what they start.

#include "firmware/behaviour/behaviour.h"
#include "firmware/fixed/literals.h"
#include "firmware/fixed/trigonometry.h"

namespace koboshi::behaviour {

using namespace fixed::literals;

namespace {

// Half and one and a half g. A robot at rest measures one g in any attitude; the margin is ten times the
// zero-g error of an accelerometer of the MPU-6050 class, 0.05 g, so that a robot held in hands passes too.
constexpr fixed::Acceleration kMinAcceleration = 4.9_m_per_s2;
constexpr fixed::Acceleration kMaxAcceleration = 14.7_m_per_s2;

}  // namespace

Reason Behaviour::request(Command command, std::int16_t argument, const estimation::RobotState& robot,
                          const drive::EnableConditions& drives, std::uint64_t now_us) {
  status_.refusal = judge(command, argument, {robot, drives, now_us});
  return status_.refusal;
}

// A velocity that is obeyed clears only the refusal of an earlier velocity: velocities come often, and would
// hide the refusal of a command.
bool Behaviour::request_velocity(const walk::Velocity& velocity) {
  const bool obeyed = clamped(velocity, parameters_.velocity_limits) == velocity;
  if (obeyed) velocity_ = velocity;
  if (!obeyed) status_.refusal = Reason::kVelocityOutOfRange;
  if (obeyed && status_.refusal == Reason::kVelocityOutOfRange) status_.refusal = Reason::kNone;
  return obeyed;
}

Reason Behaviour::judge(Command command, std::int16_t argument, const Judgement& judgement) {
  switch (command) {
    case Command::kNone:
      return Reason::kNone;
    case Command::kEnable:
      return enable(judgement);
    case Command::kLimp:
      return obey_event(Event::kLimp, judgement.now_us);
    case Command::kPlay:
      return play(argument, judgement);
    case Command::kStop:
      return stop();
    case Command::kWalk:
      return walk(judgement);
    case Command::kEmergencyStop:
      return obey_event(Event::kEmergencyStop, judgement.now_us);
    case Command::kReset:
      return obey_event(Event::kReset, judgement.now_us);
    case Command::kCalibrate:
      // The measurement takes a second. If the robot moves meanwhile, the refusal comes later.
      return kResting.contains(status_.state) ? Reason::kNone : Reason::kNotInThisState;
    case Command::kGetUp:
      return get_up(judgement);
  }
  return Reason::kUnknownCommand;
}

Reason Behaviour::obey_event(Event event, std::uint64_t now_us) {
  const auto next = next_state(status_.state, event);
  if (!next) return Reason::kNotInThisState;
  enter(*next, Reason::kCommand, now_us);
  return Reason::kNone;
}

Reason Behaviour::enable(const Judgement& judgement) {
  if (status_.state != State::kLimp) return Reason::kNotInThisState;
  const Reason refusal = refusal_to_enable(judgement);
  return refusal == Reason::kNone ? obey_event(Event::kEnable, judgement.now_us) : refusal;
}

Reason Behaviour::refusal_to_enable(const Judgement& judgement) const {
  const drive::EnableConditions& drives = judgement.drives;
  if (!drives.disabled) return Reason::kDriveNotReady;
  for (std::size_t joint = 0; joint < model_.joint_count; ++joint) {
    if ((drives.beyond_limits >> joint & 1u) != 0) return Reason::kEncoderBeyondLimits;
    const std::uint32_t supply_mV = drives.supply_mV[joint];
    if (supply_mV < parameters_.power.supply_min_mV || supply_mV > parameters_.power.supply_max_mV)
      return Reason::kSupplyOutOfRange;
  }
  const auto& a = judgement.robot.accelerations_B;
  const fixed::Acceleration magnitude = fixed::hypotenuse(a.x, a.y, a.z);
  const bool plausible = magnitude > kMinAcceleration && magnitude < kMaxAcceleration;
  return plausible ? Reason::kNone : Reason::kImuImplausible;
}

// In standing it starts the first layer, in a motion or a walk the overlay.
Reason Behaviour::play(std::int16_t number, const Judgement& judgement) {
  const bool overlays = status_.state == State::kMotion || status_.state == State::kWalking;
  if (status_.state != State::kStanding && !overlays) return Reason::kNotInThisState;
  motion::Motion motion;
  // There is one overlay at a time, until its joints have returned.
  if (overlays && overlay_.joints() != 0) return Reason::kNotInThisState;
  const storage::Holder player = overlays ? storage::Holder::kSecondPlayer : storage::Holder::kPlayer;
  if (number < 0 || !motions_.open_to_play(player, static_cast<std::uint16_t>(number), motion))
    return Reason::kNoSuchMotion;
  if (overlays) return play_overlay(motion, static_cast<std::uint8_t>(number), judgement);
  if ((motion.claimed_joints() & overlay_.joints()) != 0) return Reason::kJointsInUse;
  status_.motion = static_cast<std::uint8_t>(number);
  overlay_.uncover(targets());
  interpreter_.start(motion, targets(), inputs(judgement.robot));
  return obey_event(Event::kPlay, judgement.now_us);
}

Reason Behaviour::play_overlay(const motion::Motion& motion, std::uint8_t number,
                               const Judgement& judgement) {
  const bool walks = status_.state == State::kWalking;
  const std::uint32_t in_use = walks ? walking_joints() : interpreter_.claimed_joints();
  if ((motion.claimed_joints() & in_use) != 0) return Reason::kJointsInUse;
  overlay_.start(motion, targets(), inputs(judgement.robot));
  status_.overlay = number;
  return Reason::kNone;
}

std::uint32_t Behaviour::walking_joints() const {
  std::uint32_t joints = 0;
  for (const hal::Side side : {hal::Side::kLeft, hal::Side::kRight}) {
    for (const robot::JointIndex joint : model_.leg(side)) joints |= 1u << joint;
  }
  return joints;
}

// While the robot walks, the command only cancels a stop. Without a known gyro bias, the estimated attitude
// drifts: the walk would balance on a wrong attitude, and nothing would detect the fall (watch_for_falls).
Reason Behaviour::walk(const Judgement& judgement) {
  if (status_.state == State::kWalking) {
    walker_.resume();
    return Reason::kNone;
  }
  if (status_.state != State::kStanding) return Reason::kNotInThisState;
  if (!walk::is_gait(parameters_.walk)) return Reason::kNoGait;
  if (!judgement.robot.gyro_known) return Reason::kGyroBiasUnknown;
  if ((overlay_.joints() & walking_joints()) != 0) return Reason::kJointsInUse;
  overlay_.uncover(targets());
  interpreter_.abort();
  walker_.start(parameters_.walk, targets());
  return obey_event(Event::kWalk, judgement.now_us);
}

Reason Behaviour::get_up(const Judgement& judgement) {
  if (status_.state != State::kLimp) return Reason::kNotInThisState;
  status_.attempts = 0;
  const Reason refusal = refusal_to_enable(judgement);
  return refusal == Reason::kNone ? obey_event(Event::kGetUp, judgement.now_us) : refusal;
}

bool Behaviour::stop_walk() {
  if (status_.state != State::kWalking) return false;
  const bool walked = !walker_.stopping();
  walker_.stop();
  overlay_.stop();
  return walked;
}

Reason Behaviour::stop() {
  switch (status_.state) {
    case State::kMotion:
      stop_motions();
      return Reason::kNone;
    case State::kWalking:
      stop_walk();
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
