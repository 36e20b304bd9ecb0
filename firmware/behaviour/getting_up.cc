// The states of a fall and of standing up again: kFalling to kSteadying.

#include <algorithm>
#include <utility>

#include "firmware/behaviour/behaviour.h"
#include "firmware/behaviour/lying_pose.h"
#include "firmware/fixed/saturating.h"

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

void Behaviour::begin_falling(FallDirection direction, const Cycle& cycle) {
  walker_.abort();
  interpreter_.abort();
  status_.falls = fixed::add_saturated(status_.falls, std::uint16_t{1});
  // A robot without a motion for this direction keeps its pose.
  static_cast<void>(begin_role(role_of(direction), cycle));
  handle(Event::kFall, Reason::kFallPredicted, cycle);
}

bool Behaviour::begin_role(Role role, const Cycle& cycle) {
  const auto number = motions_.number_of(role);
  motion::Motion motion;
  if (!number || !motions_.open_to_play(storage::Holder::kPlayer, *number, motion)) return false;
  status_.motion = static_cast<std::uint8_t>(*number);
  interpreter_.start(motion, std::as_const(*this).targets(), inputs(cycle.robot));
  return true;
}

// The drives stay enabled until the trunk leans by 60 degrees, so that they reach the protective pose; then
// they go limp, so that the impact does not load the gears. A robot that bends low enough may not fall at
// all: it comes to rest on its feet.
void Behaviour::run_falling(const Cycle& cycle) {
  if (interpreter_.running()) play_on(hal::kControlPeriod_us, cycle);
  const bool rests = !interpreter_.running() && rest_detector_.update(cycle.robot.rates_B);
  if (rests && can_rest_on_feet(cycle.robot.up_B)) return stand_up_straight(Reason::kCaughtItself, cycle);
  if (rests || is_down(cycle.robot.up_B) || cycle.now_us - entered_us_ >= kMaxFallDuration_us) {
    handle(Event::kDown, Reason::kProgress, cycle);
  }
}

void Behaviour::stand_up_straight(Reason reason, const Cycle& cycle) {
  fall_detector_.arm();
  handle(Event::kUpright, reason, cycle);
}

void Behaviour::run_fallen(const Cycle& cycle) {
  follow_actual(cycle.drives);
  if (!rest_detector_.update(cycle.robot.rates_B) && cycle.now_us - entered_us_ < kMaxSettlingDuration_us)
    return;
  std::uint8_t& attempts = status_.attempts;
  if (attempts >= parameters_.recovery.getting_up.attempts)
    return fail(Reason::kCannotGetUp, cycle.drives.fault, cycle.now_us);
  ++attempts;
  has_rolled_ = false;
  handle(Event::kStill, Reason::kProgress, cycle);
}

void Behaviour::run_righting(const Cycle& cycle) {
  if (!cycle.drives.enabled) return follow_actual(cycle.drives);
  switch (classify(cycle.robot.up_B, thigh_pitch(cycle))) {
    case LyingPose::kUpright:
      // After a failed attempt an upright trunk means that the robot sits.
      if (status_.attempts > 1) return rise_from_seat(cycle);
      return stand_up_straight(Reason::kHeldUpright, cycle);
    case LyingPose::kSitting:
      return rise_from_seat(cycle);
    case LyingPose::kProne:
      return rise(Role::kRiseProne, Reason::kProne, cycle);
    case LyingPose::kSupine:
      return rise(Role::kRiseSupine, Reason::kSupine, cycle);
    case LyingPose::kLeftSide:
      return turn_from_side(Role::kRollLeft, Reason::kOnLeftSide, cycle);
    case LyingPose::kRightSide:
      return turn_from_side(Role::kRollRight, Reason::kOnRightSide, cycle);
  }
}

void Behaviour::rise(Role role, Reason lying, const Cycle& cycle) {
  if (!begin_role(role, cycle)) return fail(Reason::kCannotGetUp, cycle.drives.fault, cycle.now_us);
  handle(Event::kProneOrSupine, lying, cycle);
}

// Falls back to the supine motion, which lies down first, on robots without a motion for rising from the
// seat.
void Behaviour::rise_from_seat(const Cycle& cycle) {
  const bool known = motions_.number_of(Role::kRiseSeat).has_value();
  rise(known ? Role::kRiseSeat : Role::kRiseSupine, Reason::kOnSeat, cycle);
}

// Returns the mean pitch of the thighs from hanging straight down, in the world; negative with the knees in
// front of the hips.
fixed::Angle Behaviour::thigh_pitch(const Cycle& cycle) const {
  std::int64_t hips_raw = 0;
  for (const hal::Side side : {hal::Side::kLeft, hal::Side::kRight}) {
    const robot::JointIndex hip = model_.leg(side)[robot::kHipPitch];
    const std::int64_t angle_raw = cycle.drives.angles[hip].raw();
    hips_raw += model_.joints[hip].axis.y.raw() < 0 ? -angle_raw : angle_raw;
  }
  return cycle.robot.pitch + fixed::Angle::from_raw(static_cast<std::int32_t>(hips_raw / 2));
}

void Behaviour::turn_from_side(Role roll, Reason side, const Cycle& cycle) {
  if (has_rolled_) return handle(Event::kRecoveryStepFailed, Reason::kRecoveryStepFailed, cycle);
  has_rolled_ = true;
  if (!begin_role(roll, cycle)) return fail(Reason::kCannotGetUp, cycle.drives.fault, cycle.now_us);
  handle(Event::kOnSide, side, cycle);
}

void Behaviour::run_getting_up(const Cycle& cycle) {
  play_on(hal::kControlPeriod_us * pace_percent() / 100, cycle);
  if (interpreter_.running()) return;
  if (interpreter_.failed()) return handle(Event::kRecoveryStepFailed, Reason::kRecoveryStepFailed, cycle);
  handle(Event::kEnded, Reason::kProgress, cycle);
}

// Returns the pace of the present attempt. Each is slower than the one before: an identical attempt would
// fail in the same way.
std::uint32_t Behaviour::pace_percent() const {
  const std::uint32_t less = parameters_.recovery.getting_up.slower * (status_.attempts - 1u);
  return less >= 100 - kMinPace_percent ? kMinPace_percent : 100 - less;
}

// Fall detection is active again in this state, from the first upright cycle on.
void Behaviour::run_steadying(const Cycle& cycle) {
  const bool still = rest_detector_.update(cycle.robot.rates_B);
  if (still && is_upright(cycle.robot.up_B)) {
    status_.attempts = 0;
    status_.risen = fixed::add_saturated(status_.risen, std::uint16_t{1});
    return handle(Event::kArrived, Reason::kProgress, cycle);
  }
  const bool down = is_down(cycle.robot.up_B);
  if (down || cycle.now_us - entered_us_ >= kMaxSteadyingDuration_us) {
    handle(Event::kRecoveryStepFailed, Reason::kRecoveryStepFailed, cycle);
  }
}

}  // namespace koboshi::behaviour
