#include "firmware/behaviour/behaviour.h"

#include <algorithm>

#include "firmware/fixed/saturating.h"

namespace koboshi::behaviour {
namespace {

// Time for the drives' quick stop before the drive-enable line goes low: twice what they take, 50 ms of ramp
// and 100 ms of holding (docs/design/timing.md).
constexpr std::uint64_t kQuickStop_us = 300'000;

// Returns which sensor's samples are too old, kNone if none are.
Reason silent_sensor(const estimation::RobotState& robot) {
  const auto silent = [](std::uint32_t age_us) { return age_us > Behaviour::kSensorTimeout_us; };
  if (silent(robot.inertial_age_us)) return Reason::kImuSilent;
  return std::ranges::any_of(robot.ankle_age_us, silent) ? Reason::kAnkleSilent : Reason::kNone;
}

}  // namespace

Behaviour::Behaviour(const robot::RobotModel& model, bool model_valid, motion::MotionLibrary& motions,
                     const Parameters& parameters, const BusValues& bus_values)
    : model_(model),
      model_valid_(model_valid),
      motions_(motions),
      parameters_(parameters),
      bus_values_(bus_values),
      interpreter_(model),
      overlay_(model),
      walker_(model) {}

const Decision& Behaviour::step(const estimation::RobotState& robot, const drive::DriveStatus& drives,
                                const NetworkStatus& network, std::uint64_t now_us) {
  const Cycle cycle{robot, drives, now_us};
  measured_ = drives.angles;
  lowest_supply_mV_ = drives.lowest_supply_mV;
  watch_for_faults(cycle, network);
  watch_battery(drives);
  watch_for_falls(cycle);
  overlay_.uncover(targets());
  run_state(cycle);
  cover_targets(cycle);
  if (!interpreter_.running()) motions_.close(storage::Holder::kPlayer);
  choose_feedback();
  choose_stiffness();
  return decision_;
}

void Behaviour::restart(bool forget, std::uint64_t now_us) {
  if (forget) {
    status_ = {};
    velocity_ = {};
    low_supply_.reset();
  }
  enter(State::kBoot, Reason::kNone, now_us);
}

// --- Transitions that any state may make

void Behaviour::watch_for_faults(const Cycle& cycle, const NetworkStatus& network) {
  const auto report = [&](Reason reason) { fail(reason, cycle.drives.fault, cycle.now_us); };
  if (network.left) report(Reason::kNotOperational);
  if (cycle.drives.fault) report(Reason::kDriveFault);
  if (network.bus != Reason::kNone) report(network.bus);
  if (status_.state == State::kBoot && network.sensors_starting) return;
  const Reason silent = silent_sensor(cycle.robot);
  if (silent != Reason::kNone) report(silent);
}

// The supply counts as low after two seconds of low readings: a single step under load draws any battery
// down.
void Behaviour::watch_battery(const drive::DriveStatus& drives) {
  if (!drives.new_supply_mV) return;
  low_supply_.count(*drives.new_supply_mV < parameters_.power.supply_low_mV);
}

// Without a known gyro bias there is no fall detection: 20 deg/s of bias over the filter's time constant of 2
// s tilt the estimated attitude by 40 degrees.
void Behaviour::watch_for_falls(const Cycle& cycle) {
  if (!cycle.robot.gyro_known || !kMayFall.contains(status_.state)) return;
  const FallDirection direction = fall_detector_.update(parameters_.recovery.fall, deviation(cycle.robot));
  if (direction != FallDirection::kNone) begin_falling(direction, cycle);
}

// Returns the deviation from the lean that the walk plans, or the motion declares, within the bound of the
// parameters. The rates are never declared.
estimation::TrunkMotion Behaviour::deviation(const estimation::RobotState& robot) const {
  if (status_.state == State::kWalking) return estimation::trunk_motion(robot, walker_.pitch());
  if (status_.state != State::kMotion) return estimation::trunk_motion(robot, {});
  const auto bounded = [this](fixed::Angle lean) {
    constexpr int kScale = 1 << (fixed::Angle::kFractionBits - 16);
    const std::int32_t bound_raw = parameters_.recovery.max_declared_lean * kScale;
    return fixed::Angle::from_raw(std::clamp(lean.raw(), -bound_raw, bound_raw));
  };
  const motion::Lean lean = interpreter_.lean();
  estimation::TrunkMotion trunk = estimation::trunk_motion(robot, bounded(lean.pitch));
  trunk.roll -= bounded(lean.roll);
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
  status_.state = state;
  status_.reason = reason;
  entered_us_ = now_us;
  if (state != State::kFault) decision_.drive_enable = kTorque.contains(state);
  if (!kMayOverlay.contains(state)) abort_overlay();
  switch (state) {
    case State::kBoot:
      status_.drive_fault.kind = drive::DriveFault::kNone;
      decision_.fault.reset();
      stop_moving();
      ++decision_.boots;
      break;
    case State::kLimp:
    case State::kEmergencyStop:
    case State::kFallen:
      stop_moving();
      set_goal(drive::Goal::kTorqueOff);
      break;
    case State::kEnabling:
    case State::kRighting:
      set_goal(drive::Goal::kEnabled);
      break;
    case State::kSoftStart:
      interpreter_.abort();
      begin_soft_start();
      break;
    case State::kStanding:
    case State::kMotion:
    case State::kWalking:
    case State::kRolling:
    case State::kRising:
      break;
    case State::kFalling:
    case State::kSteadying:
      rest_detector_.restart();
      break;
    case State::kLowBattery:
      decision_.low_battery = true;
      break;
    case State::kFault:
      interpreter_.abort();
      walker_.abort();
      set_goal(drive::Goal::kQuickStop);
      break;
  }
}

void Behaviour::set_goal(drive::Goal goal) {
  decision_.goal = goal;
  ++decision_.goals;
}

void Behaviour::stop_moving() {
  decision_.low_battery = false;
  interpreter_.abort();
  walker_.abort();
  fall_detector_.disarm();
  rest_detector_.restart();
}

// Starts the ramp to the first pose of motion 0. Joints that the pose leaves out stay.
void Behaviour::begin_soft_start() {
  auto to = decision_.targets;
  motion::Motion standing;
  const bool known = motions_.open(0, standing) && standing.pose_count() > 0;
  auto pose = known ? standing.pose_reader(0) : motion::PoseReader();
  while (pose.joints() != 0) {
    std::size_t joint = 0;
    const fixed::Angle angle = pose.read(joint);
    to[joint] = robot::clamp_to_limits(model_.joints[joint], angle);
  }
  soft_start_.begin(targets(), {to.data(), model_.joint_count}, parameters_.power.ramp_rate);
}

void Behaviour::choose_feedback() {
  using balance::FeedbackMode;
  decision_.planned_pitch = {};
  decision_.planned_zmp.reset();
  decision_.feedback = FeedbackMode::kNone;
  if (!kBalancing.contains(status_.state)) return;
  decision_.feedback = FeedbackMode::kStanding;
  if (status_.state == State::kMotion) decision_.feedback = FeedbackMode::kMotion;
  if (status_.state != State::kWalking) return;
  decision_.feedback = FeedbackMode::kWalking;
  decision_.planned_pitch = walker_.pitch();
  decision_.planned_zmp = walker_.planned_zmp();
}

// The joints of two motions are different ones.
void Behaviour::choose_stiffness() {
  const motion::Interpreter& overlay = overlay_.interpreter();
  const std::uint32_t softened = interpreter_.softened() | overlay.softened();
  decision_.softened = softened;
  if (softened == 0) return;
  for (std::size_t joint = 0; joint < model_.joint_count; ++joint)
    decision_.stiffness_percent[joint] =
        std::min(interpreter_.stiffness_percent(joint), overlay.stiffness_percent(joint));
}

// --- One cycle of each state

// The corrections of a motion that has ended fade in the states that follow it.
void Behaviour::run_state(const Cycle& cycle) {
  if (interpreter_.fading()) play_on(hal::kControlPeriod_us, cycle);
  switch (status_.state) {
    case State::kBoot:
      return run_boot(cycle);
    case State::kEnabling:
      return run_enabling(cycle);
    case State::kSoftStart:
      return run_soft_start(cycle);
    case State::kMotion:
      return run_motion(cycle);
    case State::kWalking:
      return run_walking(cycle);
    case State::kFault:
      return run_fault(cycle);
    case State::kLimp:
    case State::kEmergencyStop:
      return follow_actual(cycle.drives);
    case State::kStanding:
      return run_standing(cycle);
    case State::kLowBattery:
      return;
    case State::kFalling:
      return run_falling(cycle);
    case State::kFallen:
      return run_fallen(cycle);
    case State::kRighting:
      return run_righting(cycle);
    case State::kRolling:
    case State::kRising:
      return run_getting_up(cycle);
    case State::kSteadying:
      return run_steadying(cycle);
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

void Behaviour::run_soft_start(const Cycle& cycle) {
  soft_start_.advance(std::int32_t{hal::kControlPeriod_us}, decision_.targets);
  if (soft_start_.arrived()) handle(Event::kArrived, Reason::kProgress, cycle);
}

void Behaviour::run_standing(const Cycle& cycle) {
  if (battery_low()) overlay_.stop();
  if (battery_low()) handle(Event::kLowBattery, Reason::kSupplyLow, cycle);
}

void Behaviour::run_motion(const Cycle& cycle) {
  if (battery_low()) stop_motions();
  play_on(hal::kControlPeriod_us, cycle);
  if (!interpreter_.running()) handle(Event::kEnded, Reason::kProgress, cycle);
}

void Behaviour::play_on(std::uint32_t elapsed_us, const Cycle& cycle) {
  interpreter_.advance(elapsed_us, inputs(cycle.robot));
  std::ranges::copy(interpreter_.targets(), decision_.targets.begin());
  interpreter_.add_corrections(targets(), cycle.robot);
}

motion::Inputs Behaviour::inputs(const estimation::RobotState& robot) const {
  return {.robot = robot,
          .angles = {measured_.data(), model_.joint_count},
          .torques_permille = bus_values_.torques_permille,
          .supply_mV = lowest_supply_mV_,
          .values = bus_values_.inputs,
          .walking = status_.state == State::kWalking};
}

// Puts the second motion's targets in place of those of the first layer.
void Behaviour::cover_targets(const Cycle& cycle) {
  overlay_.cover(hal::kControlPeriod_us, inputs(cycle.robot), targets());
  if (overlay_.playing()) return;
  status_.overlay = Status::kNoOverlay;
  motions_.close(storage::Holder::kSecondPlayer);
}

void Behaviour::abort_overlay() {
  overlay_.abort();
  status_.overlay = Status::kNoOverlay;
}

void Behaviour::stop_motions() {
  interpreter_.stop();
  overlay_.stop();
}

void Behaviour::run_walking(const Cycle& cycle) {
  if (battery_low()) stop_walk();
  const estimation::RobotState& robot = cycle.robot;
  walker_.advance(velocity_, {.roll = robot.roll,
                              .pitch = robot.pitch,
                              .rates = robot.rates_B,
                              .loads = {robot.feet[0].load, robot.feet[1].load}});
  std::ranges::copy(walker_.targets(), decision_.targets.begin());
  if (!walker_.running()) handle(Event::kEnded, Reason::kProgress, cycle);
}

void Behaviour::run_fault(const Cycle& cycle) {
  if (cycle.drives.limp || cycle.now_us - entered_us_ >= kQuickStop_us) decision_.drive_enable = false;
}

}  // namespace koboshi::behaviour
