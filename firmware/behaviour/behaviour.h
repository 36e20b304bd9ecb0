#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "firmware/balance/feedback.h"
#include "firmware/behaviour/command.h"
#include "firmware/behaviour/commanded_walk.h"
#include "firmware/behaviour/cycle.h"
#include "firmware/behaviour/fall_detector.h"
#include "firmware/behaviour/joint_stream.h"
#include "firmware/behaviour/motion_player.h"
#include "firmware/behaviour/motion_source.h"
#include "firmware/behaviour/overlay.h"
#include "firmware/behaviour/parameters.h"
#include "firmware/behaviour/recovery.h"
#include "firmware/behaviour/sitting_down.h"
#include "firmware/behaviour/soft_start.h"
#include "firmware/behaviour/state.h"
#include "firmware/behaviour/supply_guard.h"
#include "firmware/motion/motion_library.h"

namespace koboshi::behaviour {

// The state of the behaviour, as telemetry shows it.
struct Status {
  static constexpr std::uint8_t kNoOverlay = 255;

  State state = State::kBoot;
  Reason reason = Reason::kNone;      // of the last change of state
  Reason refusal = Reason::kNone;     // of the last command; kNone if it was obeyed
  std::uint8_t motion = 0;            // number of the motion being played or played last
  std::uint8_t overlay = kNoOverlay;  // number of the second motion being played
  std::uint8_t attempts = 0;          // to stand up, since the robot last stood
  drive::JointFault drive_fault;      // of the last fault, if a drive caused it
  // Counters since power-on; they saturate.
  std::uint16_t faults = 0;
  std::uint16_t falls = 0;
  std::uint16_t risen = 0;
};

// A fault: the state in which it occurred, and its cause.
struct FaultReport {
  State state = State::kBoot;
  Reason reason = Reason::kNone;
  drive::JointFault drive_fault;
};

// The output of the behaviour. The controller carries it out after each call that may change it.
struct Decision {
  std::array<fixed::Angle, robot::kMaxJoints> targets{};  // by joint, before feedback
  std::uint32_t softened = 0;                             // joints with less than full torque; bit i: joint i
  std::array<std::uint8_t, robot::kMaxJoints> stiffness_percent{};  // of these joints
  std::uint32_t regained = 0;  // joints whose position loops have another gain than their own; bit i: joint i
  std::array<std::uint8_t, robot::kMaxJoints> gain_percent{};  // of these joints
  balance::FeedbackMode feedback = balance::FeedbackMode::kNone;
  fixed::Angle planned_pitch;                   // of the trunk, forward positive
  std::optional<walk::PlannedZmp> planned_zmp;  // of a walk, for the end of the cycle
  // Set by the plan of a walk: the foot in the air, the foot that bears the robot, and the foot relative to
  // which the motion of the centre of mass is measured.
  std::optional<hal::Side> swing;
  std::optional<hal::Side> support;
  std::optional<hal::Side> reference;
  std::optional<walk::Point> dcm_error;  // of a walk that compares the DCM with its plan
  drive::Goal goal = drive::Goal::kTorqueOff;
  std::uint16_t goals = 0;           // number of goals set so far: setting the same goal again counts
  bool drive_enable = false;         // level of the drive-enable line
  std::uint16_t boots = 0;           // number of boots of drives and sensors ordered so far
  std::optional<FaultReport> fault;  // reported on the bus (EMCY) until the next boot
  // Reported likewise while the robot acts on a low supply: until it is commanded limp or, when it has sat
  // down or fallen, until the supply has recovered.
  bool low_battery = false;
};

// The second stage of a control cycle: the state machine of the robot. Inputs are those of a Cycle and the
// operator's commands; the output is a Decision. All transitions are those of the table in state.h.
class Behaviour {  // Large: one short function per state and per command
 public:
  static constexpr std::uint32_t kSensorTimeout_us = 50'000;

  // `model_valid`: whether the storage holds a model. Without one the robot boots into a fault. The
  // references must outlive the behaviour.
  Behaviour(const robot::RobotModel& model, bool model_valid, motion::MotionLibrary& motions,
            const Parameters& parameters);
  // Its parts know each other.
  Behaviour(const Behaviour&) = delete;
  Behaviour& operator=(const Behaviour&) = delete;

  // One control cycle of 10 ms. The reference stays valid until the next call.
  const Decision& step(const Cycle& cycle);
  // Obeys a command at once, or refuses it. May be called at any time. Returns the reason of the refusal,
  // kNone if it was obeyed; `status` keeps it. `kCalibrate` is only judged here: the caller carries it out.
  Reason request(Command command, std::int16_t argument, const Circumstances& circumstances);
  // Sets the commanded velocity, which a command or a change of the limits has brought, if it is within the
  // limits. Returns the reason of the refusal, kNone if it was obeyed; `status` keeps it.
  Reason request_velocity(const walk::Velocity& velocity);
  // Brings the commanded velocity within limits that have changed.
  void clamp_velocity(const walk::VelocityLimits& limits) {
    walk_.set_velocity(clamped(walk_.velocity(), limits));
  }
  // Ends a walk as kStop does. Returns whether the robot walked and was not to stop yet. Nothing happens in
  // other states.
  bool stop_walk();
  // Takes a set of the joint target stream, as JointStream::take. Returns whether the robot follows it.
  bool take_stream(std::span<const fixed::Angle> targets, std::span<const std::uint8_t> torques_percent) {
    return status_.state == State::kStreaming && stream_.take(targets, torques_percent);
  }
  // Ends the joint target stream as kStop does. Returns whether the robot followed it.
  bool stop_stream();
  // Records a refusal that was found only after the command had been obeyed.
  void refuse(Reason reason) { status_.refusal = reason; }
  // A fault that the controller has found between two cycles; `drive_fault`: the drives' first, if any.
  void fail(Reason reason, const drive::JointFault& drive_fault, std::uint64_t now_us);
  // Enters kBoot from any state. `forget`: as at power-on, with counters and velocity cleared.
  void restart(bool forget, std::uint64_t now_us);

  const Status& status() const { return status_; }
  State state() const { return status_.state; }
  const walk::Velocity& velocity() const { return walk_.velocity(); }
  // The phase of the walk, one turn for two steps; none while it does not step.
  std::optional<fixed::Angle> walk_phase() const { return walk_.phase(); }
  const Decision& decision() const { return decision_; }
  const SupplyGuard& supply() const { return supply_guard_; }

 private:
  // Commands (commands.cc).
  Reason judge(Command command, std::int16_t argument, const Circumstances& circumstances);
  Reason obey_event(Event event, std::uint64_t now_us);
  Reason enable(const Circumstances& circumstances);
  Reason refusal_to_enable(const Circumstances& circumstances) const;
  Reason play(std::int16_t number, const Circumstances& circumstances);
  Reason play_overlay(const motion::Motion& motion, std::uint8_t number, const Circumstances& circumstances);
  Reason walk(const Circumstances& circumstances);
  Reason refusal_to_walk(const estimation::RobotState& robot) const;
  void begin_walk(std::optional<hal::Side> pushed_to = std::nullopt);
  bool acts_on_low_supply() const;
  Reason stream(const Circumstances& circumstances);
  Reason get_up(const Circumstances& circumstances);
  Reason stop();

  // Transitions that any state may make (behaviour.cc).
  void watch_for_faults(const Cycle& cycle);
  void watch_supply(const Cycle& cycle);
  void sit_down(const Cycle& cycle);
  void watch_for_falls(const Cycle& cycle);
  void begin_falling(FallDirection direction, const Cycle& cycle);

  // Changes of state.
  void handle(Event event, Reason reason, const Cycle& cycle);
  void enter(State state, Reason reason, std::uint64_t now_us);
  void set_goal(drive::Goal goal);
  void abort_sources();
  void disarm(bool supply_stays_reported);
  void begin_soft_start();
  std::array<fixed::Angle, robot::kMaxJoints> standing_pose();
  bool is_in_standing_pose();
  void choose_feedback();
  void choose_stiffness();
  void choose_gains();

  // One cycle of each state.
  void run_state(const Cycle& cycle);
  void run_boot(const Cycle& cycle);
  void run_enabling(const Cycle& cycle);
  void run_standing(const Cycle& cycle);
  void run_fault(const Cycle& cycle);
  void run_source(MotionSource& source, const Cycle& cycle);
  void run_sitting_down(const Cycle& cycle);
  void run_recovery(const Cycle& cycle);
  void cover_targets(const Cycle& cycle);
  void abort_overlay();
  void follow_actual(const drive::DriveStatus& drives) { decision_.targets = drives.angles; }

  // The source of the present state, null without one.
  MotionSource* source() const {
    return sources_[static_cast<std::size_t>(kSourceOf[static_cast<std::size_t>(status_.state)])];
  }
  Plan plan() const;
  static estimation::TrunkMotion deviation(const estimation::RobotState& robot, const motion::Lean& lean);
  motion::Inputs inputs(const estimation::RobotState& robot, const BusValues& values) const;
  std::span<const fixed::Angle> targets() const { return {decision_.targets.data(), model_.joint_count}; }
  std::span<fixed::Angle> targets() { return {decision_.targets.data(), model_.joint_count}; }

  const robot::RobotModel& model_;
  const bool model_valid_;
  motion::MotionLibrary& motions_;
  const Parameters parameters_;
  Status status_;
  Decision decision_;
  std::uint64_t entered_us_ = 0;  // when the present state began
  SupplyGuard supply_guard_;
  std::array<fixed::Angle, robot::kMaxJoints> measured_{};  // joint angles of the last cycle
  std::uint32_t lowest_supply_mV_ = 0;                      // in the last cycle
  SoftStart soft_start_;
  MotionPlayer player_;
  CommandedWalk walk_;
  SittingDown sitting_down_;
  JointStream stream_;
  const std::array<MotionSource*, kSources> sources_;  // by Source
  Overlay overlay_;
  FallDetector fall_detector_;
  Recovery recovery_;
};

}  // namespace koboshi::behaviour
