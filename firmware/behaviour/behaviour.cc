#include "firmware/behaviour/behaviour.h"

#include <algorithm>

#include "firmware/fixed/saturating.h"
#include "hal/port/period.h"

namespace koboshi::behaviour {

using namespace fixed::literals;

namespace {

// Time for the drives' quick stop before the drive-enable line goes low: twice what they take, 50 ms of ramp
// and 100 ms of holding (docs/design/timing.md).
constexpr std::uint64_t kQuickStop_us = 300'000;

// How far the targets of the legs may be off the standing pose of a robot that steps when it is pushed. By
// hand, 2026-11-28: the walk itself bends the knees by more.
constexpr fixed::Angle kStandingPose = 5.0_deg;

// Returns which sensor's samples are too old, kNone if none are.
Reason silent_sensor(const estimation::RobotState& robot) {
  const auto silent = [](std::uint32_t age_us) { return age_us > Behaviour::kSensorTimeout_us; };
  if (silent(robot.inertial_age_us)) return Reason::kImuSilent;
  return std::ranges::any_of(robot.ankle_age_us, silent) ? Reason::kAnkleSilent : Reason::kNone;
}

}  // namespace

Behaviour::Behaviour(const robot::RobotModel& model, bool model_valid, motion::MotionLibrary& motions,
                     const Parameters& parameters)
    : model_(model),
      model_valid_(model_valid),
      motions_(motions),
      parameters_(parameters),
      player_(model, motions, parameters.recovery),
      walk_(model),
      sitting_down_(player_),
      stream_(model),
      sources_{nullptr, &soft_start_, &player_, &walk_, &sitting_down_, &stream_},
      overlay_(model),
      recovery_(model, motions, player_, parameters.recovery) {}

const Decision& Behaviour::step(const Cycle& cycle) {
  watch_supply(cycle);
  measured_ = cycle.drives.angles;
  lowest_supply_mV_ = cycle.drives.lowest_supply_mV;
  watch_for_faults(cycle);
  if (supply_guard_.low()) sit_down(cycle);
  watch_for_falls(cycle);
  overlay_.uncover(targets());
  run_state(cycle);
  cover_targets(cycle);
  if (!player_.running()) motions_.close(storage::Holder::kPlayer);
  status_.motion = player_.number();
  status_.attempts = recovery_.attempts();
  choose_feedback();
  choose_stiffness();
  choose_gains();
  return decision_;
}

void Behaviour::restart(bool forget, std::uint64_t now_us) {
  if (forget) {
    status_ = {};
    walk_.set_velocity({});
    player_.forget_number();
    recovery_.forget_attempts();
    supply_guard_.reset();
  }
  enter(State::kBoot, Reason::kNone, now_us);
}

// --- Transitions that any state may make

void Behaviour::watch_for_faults(const Cycle& cycle) {
  const NetworkStatus& network = cycle.network;
  const auto report = [&](Reason reason) { fail(reason, cycle.drives.fault, cycle.now_us); };
  if (network.left) report(Reason::kNotOperational);
  if (cycle.drives.fault) report(Reason::kDriveFault);
  if (network.bus != Reason::kNone) report(network.bus);
  if (status_.state == State::kBoot && network.sensors_starting) return;
  const Reason silent = silent_sensor(cycle.robot);
  if (silent != Reason::kNone) report(silent);
}

// To be called before the measured angles of the last cycle are replaced. A drive that browns out reports it
// by itself, and is a fault.
void Behaviour::watch_supply(const Cycle& cycle) {
  if (!cycle.drives.new_supply_mV) return;
  const std::size_t joints = model_.joint_count;
  const auto torques = cycle.values.torques_permille;
  supply_guard_.update(parameters_.power, *cycle.drives.new_supply_mV,
                       {.joints = {model_.joints.data(), joints},
                        .torques_permille = torques.first(std::min(joints, torques.size())),
                        .angles = {cycle.drives.angles.data(), joints},
                        .last_angles = {measured_.data(), joints}});
  if (!supply_guard_.low() && kResting.contains(status_.state)) decision_.low_battery = false;
}

// Nobody drives a robot that sits down: it forgets the commanded velocity.
void Behaviour::sit_down(const Cycle& cycle) {
  const auto next = next_state(status_.state, Event::kSitDown);
  if (!next || !motions_.number_of(motion::Role::kSit)) return;
  overlay_.stop();
  sitting_down_.begin(source());
  walk_.set_velocity({});
  enter(*next, Reason::kSupplyLow, cycle.now_us);
}

// Without a known gyro bias there is no fall detection: 20 deg/s of bias over the filter's time constant of 2
// s tilt the estimated attitude by 40 degrees.
void Behaviour::watch_for_falls(const Cycle& cycle) {
  if (!cycle.robot.gyro_known || !kMayFall.contains(status_.state)) return;
  const Plan plan = this->plan();
  const FallDirection direction =
      fall_detector_.update(parameters_.recovery.fall, deviation(cycle.robot, plan.lean), plan.error_percent);
  if (direction != FallDirection::kNone) begin_falling(direction, cycle);
}

void Behaviour::begin_falling(FallDirection direction, const Cycle& cycle) {
  abort_sources();
  status_.falls = fixed::add_saturated(status_.falls, std::uint16_t{1});
  recovery_.fall(direction, targets(), inputs(cycle.robot, cycle.values));
  handle(Event::kFall, Reason::kFallPredicted, cycle);
}

Plan Behaviour::plan() const {
  const MotionSource* const source = this->source();
  return source != nullptr ? source->plan() : Plan();
}

// Returns the deviation from the lean that the source plans. The rates are never planned.
estimation::TrunkMotion Behaviour::deviation(const estimation::RobotState& robot, const motion::Lean& lean) {
  estimation::TrunkMotion trunk = estimation::trunk_motion(robot, lean.pitch);
  trunk.roll -= lean.roll;
  return trunk;
}

void Behaviour::fail(Reason reason, const drive::JointFault& drive_fault, std::uint64_t now_us) {
  const auto next = next_state(status_.state, Event::kFailure);
  if (!next) return;
  status_.drive_fault = drive_fault;
  status_.faults = fixed::add_saturated(status_.faults, std::uint16_t{1});
  decision_.fault = FaultReport{status_.state, reason, drive_fault};
  enter(*next, reason, now_us);
}

// --- Changes of state

void Behaviour::handle(Event event, Reason reason, const Cycle& cycle) {
  if (const auto next = next_state(status_.state, event)) enter(*next, reason, cycle.now_us);
}

void Behaviour::enter(State state, Reason reason, std::uint64_t now_us) {
  const bool lies_limp = status_.state == State::kLimp && state == State::kFallen;
  if (!lies_limp) recovery_.begin_state();
  status_.state = state;
  status_.reason = reason;
  entered_us_ = now_us;
  if (state != State::kFault) decision_.drive_enable = kTorque.contains(state);
  if (!kOnItsFeet.contains(state)) abort_overlay();
  if (!kTorque.contains(state)) abort_sources();
  switch (state) {
    case State::kBoot:
      status_.drive_fault.kind = drive::DriveFault::kNone;
      decision_.fault.reset();
      disarm(false);
      ++decision_.boots;
      break;
    case State::kLimp:
    case State::kEmergencyStop:
    case State::kFallen:
      disarm(reason != Reason::kCommand && supply_guard_.low());
      set_goal(drive::Goal::kTorqueOff);
      break;
    case State::kEnabling:
    case State::kRighting:
      set_goal(drive::Goal::kEnabled);
      break;
    case State::kSoftStart:
      player_.abort();
      begin_soft_start();
      break;
    case State::kLowBattery:
    case State::kSittingDown:
      decision_.low_battery = true;
      break;
    case State::kFault:
      set_goal(drive::Goal::kQuickStop);
      break;
    default:
      break;
  }
}

void Behaviour::set_goal(drive::Goal goal) {
  decision_.goal = goal;
  ++decision_.goals;
}

void Behaviour::abort_sources() {
  for (MotionSource* const source : sources_) {
    if (source != nullptr) source->abort();
  }
}

// The robot is limp, or about to boot.
void Behaviour::disarm(bool supply_stays_reported) {
  decision_.low_battery = supply_stays_reported;
  fall_detector_.disarm();
}

void Behaviour::begin_soft_start() {
  const auto to = standing_pose();
  soft_start_.begin(targets(), {to.data(), model_.joint_count}, parameters_.power.ramp_rate);
}

// Returns the first pose of motion 0. Joints that it leaves out stay at their targets.
std::array<fixed::Angle, robot::kMaxJoints> Behaviour::standing_pose() {
  auto to = decision_.targets;
  motion::Motion standing;
  const bool known = motions_.open(0, standing) && standing.pose_count() > 0;
  auto pose = known ? standing.pose_reader(0) : motion::PoseReader();
  while (pose.joints() != 0) {
    std::size_t joint = 0;
    const fixed::Angle angle = pose.read(joint);
    to[joint] = robot::clamp_to_limits(model_.joints[joint], angle);
  }
  return to;
}

// A motion may have ended on the seat or in a squat, from which no walk begins.
bool Behaviour::is_in_standing_pose() {
  const auto pose = standing_pose();
  const std::uint32_t legs = model_.leg_joints();
  for (std::size_t joint = 0; joint < model_.joint_count; ++joint) {
    const fixed::Angle off = decision_.targets[joint] - pose[joint];
    if ((legs >> joint & 1u) != 0 && fixed::abs(off) > kStandingPose) return false;
  }
  return true;
}

void Behaviour::choose_feedback() {
  decision_.planned_pitch = {};
  decision_.planned_zmp.reset();
  decision_.swing.reset();
  decision_.support.reset();
  decision_.reference.reset();
  decision_.dcm_error.reset();
  decision_.feedback = balance::FeedbackMode::kNone;
  if (!kBalancing.contains(status_.state)) return;
  const Plan plan = this->plan();
  decision_.planned_pitch = plan.pitch;
  decision_.planned_zmp = plan.zmp;
  decision_.swing = plan.swing;
  decision_.support = plan.support;
  decision_.reference = plan.reference;
  decision_.dcm_error = plan.dcm_error;
  decision_.feedback = plan.feedback;
}

// The joints of two motions are different ones. A motion that fades may soften joints of a stream.
void Behaviour::choose_stiffness() {
  const motion::Interpreter& motion = player_.interpreter();
  const motion::Interpreter& overlay = overlay_.interpreter();
  const std::uint32_t softened = motion.softened() | overlay.softened() | stream_.softened();
  decision_.softened = softened;
  if (softened == 0) return;
  for (std::size_t joint = 0; joint < model_.joint_count; ++joint)
    decision_.stiffness_percent[joint] = std::min(
        {motion.stiffness_percent(joint), overlay.stiffness_percent(joint), stream_.torque_percent(joint)});
}

// The joints of two motions are different ones.
void Behaviour::choose_gains() {
  const motion::Interpreter& motion = player_.interpreter();
  const motion::Interpreter& overlay = overlay_.interpreter();
  decision_.regained = motion.regained() | overlay.regained();
  if (decision_.regained == 0) return;
  for (std::size_t joint = 0; joint < model_.joint_count; ++joint) {
    const bool of_overlay = (overlay.regained() >> joint & 1u) != 0;
    decision_.gain_percent[joint] = of_overlay ? overlay.gain_percent(joint) : motion.gain_percent(joint);
  }
}

// --- One cycle of each state

// The corrections of a motion that has ended fade in the states that follow it.
void Behaviour::run_state(const Cycle& cycle) {
  if (player_.interpreter().fading())
    player_.advance(hal::kControlPeriod_us, inputs(cycle.robot, cycle.values), targets());
  if (kRecovering.contains(status_.state)) return run_recovery(cycle);
  if (status_.state == State::kSittingDown) return run_sitting_down(cycle);
  if (MotionSource* const source = this->source()) return run_source(*source, cycle);
  switch (status_.state) {
    case State::kBoot:
      return run_boot(cycle);
    case State::kLimp:
      recovery_.watch_limp(cycle.robot);
      return follow_actual(cycle.drives);
    case State::kEmergencyStop:
      return follow_actual(cycle.drives);
    case State::kEnabling:
      return run_enabling(cycle);
    case State::kStanding:
      return run_standing(cycle);
    case State::kFault:
      return run_fault(cycle);
    default:
      return;
  }
}

void Behaviour::run_boot(const Cycle& cycle) {
  if (!model_valid_) return fail(Reason::kModelInvalid, cycle.drives.fault, cycle.now_us);
  if (!cycle.drives.booted || silent_sensor(cycle.robot) != Reason::kNone) return;
  follow_actual(cycle.drives);
  handle(Event::kReady, Reason::kProgress, cycle);
}

void Behaviour::run_enabling(const Cycle& cycle) {
  follow_actual(cycle.drives);
  if (cycle.drives.enabled) handle(Event::kEnabled, Reason::kProgress, cycle);
}

// A robot that is pushed beyond what its soles hold walks until it stands again. One without a motion to sit
// down stands on a low supply.
void Behaviour::run_standing(const Cycle& cycle) {
  const auto pushed_to = CommandedWalk::needed(parameters_.walk, cycle.robot);
  if (pushed_to && is_in_standing_pose() && refusal_to_walk(cycle.robot) == Reason::kNone) {
    begin_walk(pushed_to);
    handle(Event::kPushed, Reason::kPushed, cycle);
    return run_source(walk_, cycle);
  }
  if (!supply_guard_.low()) return;
  overlay_.stop();
  handle(Event::kLowBattery, Reason::kSupplyLow, cycle);
}

void Behaviour::run_source(MotionSource& source, const Cycle& cycle) {
  if (supply_guard_.low() && kOnItsFeet.contains(status_.state)) {
    source.stop();
    overlay_.stop();
  }
  source.advance(hal::kControlPeriod_us, inputs(cycle.robot, cycle.values), targets());
  if (source.running()) return;
  // A command to walk that came after the closing step had begun is obeyed once the robot stands.
  const bool walks_on = &source == &walk_ && !walk_.stopping();
  if (walks_on && refusal_to_walk(cycle.robot) == Reason::kNone) return begin_walk();
  const bool failed = &source == &player_ && player_.interpreter().failed();
  handle(Event::kEnded, failed ? Reason::kMotionFailed : Reason::kProgress, cycle);
}

// A robot that does not sit as its motion expects keeps its torque: limp it would fall.
void Behaviour::run_sitting_down(const Cycle& cycle) {
  sitting_down_.advance(hal::kControlPeriod_us, inputs(cycle.robot, cycle.values), targets());
  if (sitting_down_.running()) return;
  handle(sitting_down_.done() ? Event::kEnded : Event::kLowBattery, Reason::kSupplyLow, cycle);
}

// A robot that fell with a low supply stays down: it would stand up only to sit down again.
void Behaviour::run_recovery(const Cycle& cycle) {
  const auto outcome = recovery_.run(status_.state, cycle.now_us - entered_us_, cycle,
                                     inputs(cycle.robot, cycle.values), targets());
  if (!outcome) return;
  if (status_.state == State::kFallen && supply_guard_.low()) {
    recovery_.forget_attempts();
    return handle(Event::kLowBattery, Reason::kSupplyLow, cycle);
  }
  if (outcome->event == Event::kFailure) return fail(outcome->reason, cycle.drives.fault, cycle.now_us);
  // A robot on its feet that leans falls.
  if (outcome->event == Event::kUpright) fall_detector_.arm();
  if (outcome->event == Event::kSteady) status_.risen = fixed::add_saturated(status_.risen, std::uint16_t{1});
  handle(outcome->event, outcome->reason, cycle);
}

motion::Inputs Behaviour::inputs(const estimation::RobotState& robot, const BusValues& values) const {
  return {.robot = robot,
          .angles = {measured_.data(), model_.joint_count},
          .torques_permille = values.torques_permille,
          .supply_mV = lowest_supply_mV_,
          .values = values.inputs,
          .walking = walk_.running()};
}

// Puts the second motion's targets in place of those of the first layer.
void Behaviour::cover_targets(const Cycle& cycle) {
  overlay_.cover(hal::kControlPeriod_us, inputs(cycle.robot, cycle.values), targets());
  if (overlay_.playing()) return;
  status_.overlay = Status::kNoOverlay;
  motions_.close(storage::Holder::kSecondPlayer);
}

void Behaviour::abort_overlay() {
  overlay_.abort();
  status_.overlay = Status::kNoOverlay;
}

void Behaviour::run_fault(const Cycle& cycle) {
  if (cycle.drives.limp || cycle.now_us - entered_us_ >= kQuickStop_us) decision_.drive_enable = false;
}

}  // namespace koboshi::behaviour
