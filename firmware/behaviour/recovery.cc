#include "firmware/behaviour/recovery.h"

#include <algorithm>

#include "firmware/behaviour/lying_pose.h"
#include "hal/port/period.h"

namespace koboshi::behaviour {

using motion::Role;

namespace {

// Time-outs of the states, set by hand (2026-11-22) and not tuned: too long a time-out only costs time.
//
// Fall: the robot then counts as down and goes limp, although it did not fall or somebody holds it.
constexpr std::uint64_t kMaxFallDuration_us = 1'500'000;
// Rest on the ground: a robot that slides down a slope or is carried never comes to rest.
constexpr std::uint64_t kMaxSettlingDuration_us = 4'000'000;
// Rest after rising: a robot that sways for longer has failed to get up.
constexpr std::uint64_t kMaxSteadyingDuration_us = 3'000'000;
// Lower limit of the pace, in percent of the motion's own; set by hand (2026-11-22). Without it, `slower`
// could bring the pace to zero.
constexpr std::uint32_t kMinPace_percent = 30;

constexpr Role role_of(FallDirection direction) {
  switch (direction) {
    case FallDirection::kBack:
      return Role::kFallBack;
    case FallDirection::kLeft:
      return Role::kFallLeft;
    case FallDirection::kRight:
      return Role::kFallRight;
    default:
      return Role::kFallFront;
  }
}

}  // namespace

void Recovery::Step::follow_actual() const {
  std::copy_n(cycle.drives.angles.begin(), targets.size(), targets.begin());
}

// A robot without a motion for this direction keeps its pose.
void Recovery::fall(FallDirection direction, std::span<const fixed::Angle> targets,
                    const motion::Inputs& inputs) {
  static_cast<void>(player_.start(role_of(direction), targets, inputs));
}

std::optional<Recovery::Outcome> Recovery::run(State state, std::uint64_t elapsed_us, const Cycle& cycle,
                                               const motion::Inputs& inputs,
                                               std::span<fixed::Angle> targets) {
  const Step step{elapsed_us, cycle, inputs, targets};
  switch (state) {
    case State::kFalling:
      return run_falling(step);
    case State::kFallen:
      return run_fallen(step);
    case State::kRighting:
      return run_righting(step);
    case State::kRolling:
    case State::kRising:
      return run_motion(step);
    case State::kSteadying:
      return run_steadying(step);
    default:
      return std::nullopt;
  }
}

// The drives stay enabled until the trunk leans by 60 degrees, so that they reach the protective pose; then
// they go limp, so that the impact does not load the gears. A robot that bends low enough may not fall at
// all: it comes to rest on its feet.
Recovery::Result Recovery::run_falling(const Step& step) {
  const estimation::RobotState& robot = step.cycle.robot;
  if (player_.running()) player_.advance(hal::kControlPeriod_us, step.inputs, step.targets);
  const bool rests = !player_.running() && rest_detector_.update(robot.rates_B);
  if (rests && can_rest_on_feet(robot.up_B)) return Outcome{Event::kUpright, Reason::kCaughtItself};
  if (rests || is_down(robot.up_B) || step.elapsed_us >= kMaxFallDuration_us)
    return Outcome{Event::kDown, Reason::kProgress};
  return std::nullopt;
}

Recovery::Result Recovery::run_fallen(const Step& step) {
  step.follow_actual();
  const bool rests = rest_detector_.update(step.cycle.robot.rates_B);
  if (step.elapsed_us <= hal::kControlPeriod_us) return std::nullopt;  // until telemetry has shown the state
  if (!rests && step.elapsed_us < kMaxSettlingDuration_us) return std::nullopt;
  if (attempts_ >= parameters_.getting_up.attempts) return Outcome{Event::kFailure, Reason::kCannotGetUp};
  ++attempts_;
  has_rolled_ = false;
  return Outcome{Event::kStill, Reason::kProgress};
}

Recovery::Result Recovery::run_righting(const Step& step) {
  if (!step.cycle.drives.enabled) {
    step.follow_actual();
    return std::nullopt;
  }
  switch (classify(step.cycle.robot.up_B, thigh_pitch(step.cycle))) {
    case LyingPose::kUpright:
      // After a failed attempt an upright trunk means that the robot sits.
      if (attempts_ > 1) return rise_from_seat(step);
      return Outcome{Event::kUpright, Reason::kHeldUpright};
    case LyingPose::kSitting:
      return rise_from_seat(step);
    case LyingPose::kProne:
      return rise(Role::kRiseProne, Reason::kProne, step);
    case LyingPose::kSupine:
      return rise(Role::kRiseSupine, Reason::kSupine, step);
    case LyingPose::kLeftSide:
      return turn_from_side(Role::kRollLeft, Reason::kOnLeftSide, step);
    case LyingPose::kRightSide:
      return turn_from_side(Role::kRollRight, Reason::kOnRightSide, step);
  }
  return std::nullopt;
}

Recovery::Result Recovery::rise(Role role, Reason lying, const Step& step) {
  if (!player_.start(role, step.targets, step.inputs)) return Outcome{Event::kFailure, Reason::kCannotGetUp};
  return Outcome{Event::kProneOrSupine, lying};
}

// Falls back to the supine motion, which lies down first, on robots without a motion for rising from the
// seat.
Recovery::Result Recovery::rise_from_seat(const Step& step) {
  const bool known = library_.number_of(Role::kRiseSeat).has_value();
  return rise(known ? Role::kRiseSeat : Role::kRiseSupine, Reason::kOnSeat, step);
}

// Returns the mean pitch of the thighs from hanging straight down, in the world; negative with the knees in
// front of the hips.
fixed::Angle Recovery::thigh_pitch(const Cycle& cycle) const {
  std::int64_t hips_raw = 0;
  for (const hal::Side side : {hal::Side::kLeft, hal::Side::kRight}) {
    const robot::JointIndex hip = model_.leg(side)[robot::kHipPitch];
    const std::int64_t angle_raw = cycle.drives.angles[hip].raw();
    hips_raw += model_.joints[hip].axis.y.raw() < 0 ? -angle_raw : angle_raw;
  }
  return cycle.robot.pitch + fixed::Angle::from_raw(static_cast<std::int32_t>(hips_raw / 2));
}

Recovery::Result Recovery::turn_from_side(Role roll, Reason side, const Step& step) {
  if (has_rolled_) return Outcome{Event::kRecoveryStepFailed, Reason::kRecoveryStepFailed};
  has_rolled_ = true;
  if (!player_.start(roll, step.targets, step.inputs)) return Outcome{Event::kFailure, Reason::kCannotGetUp};
  return Outcome{Event::kOnSide, side};
}

Recovery::Result Recovery::run_motion(const Step& step) {
  player_.advance(hal::kControlPeriod_us * pace_percent() / 100, step.inputs, step.targets);
  if (player_.running()) return std::nullopt;
  if (player_.interpreter().failed()) return Outcome{Event::kRecoveryStepFailed, Reason::kRecoveryStepFailed};
  return Outcome{Event::kEnded, Reason::kProgress};
}

// Returns the pace of the present attempt. Each is slower than the one before: an identical attempt would
// fail in the same way.
std::uint32_t Recovery::pace_percent() const {
  const std::uint32_t less = parameters_.getting_up.slower * (attempts_ - 1u);
  return less >= 100 - kMinPace_percent ? kMinPace_percent : 100 - less;
}

// Fall detection is active again in this state, from the first upright cycle on.
Recovery::Result Recovery::run_steadying(const Step& step) {
  const bool still = rest_detector_.update(step.cycle.robot.rates_B);
  if (still && is_upright(step.cycle.robot.up_B)) {
    attempts_ = 0;
    return Outcome{Event::kSteady, Reason::kProgress};
  }
  if (is_down(step.cycle.robot.up_B) || step.elapsed_us >= kMaxSteadyingDuration_us)
    return Outcome{Event::kRecoveryStepFailed, Reason::kRecoveryStepFailed};
  return std::nullopt;
}

}  // namespace koboshi::behaviour
