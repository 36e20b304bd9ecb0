// Of a fall and what comes after it: the states from kFalling to kSteadying.

#include <algorithm>

#include "firmware/app/controller.h"
#include "firmware/fixed/saturating.h"

namespace koboshi::app {

using recovery::FallDirection;
using recovery::Lying;
using recovery::Role;

namespace {

// Who has not come down by then caught himself, or hangs on somebody's hand.
constexpr std::uint64_t kLongestFall_us = 1'500'000;
// A robot on a slope or in somebody's hands may never lie still.
constexpr std::uint64_t kLongestSettling_us = 4'000'000;
constexpr std::uint64_t kLongestSteadying_us = 3'000'000;
constexpr std::uint32_t kSlowestPace_percent = 30;

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

// A gyro whose bias nobody knows leans the attitude by up to forty degrees.
void Controller::watch_for_falls() {
  const auto& stored = values_.calibration.gyro_bias;
  const bool knows_gyro =
      values_.diagnosis.gyro_calibrations != 0 || (stored[0] | stored[1] | stored[2]) != 0;
  if (!knows_gyro || !may_fall(values_.behaviour.state)) return;
  const FallDirection direction = fall_watch_.update(values_.recovery.fall, trunk_motion());
  if (direction != FallDirection::kNone) begin_falling(direction);
}

void Controller::begin_falling(FallDirection direction) {
  walker_.abort();
  interpreter_.abort();
  values_.diagnosis.falls = fixed::add_saturated(values_.diagnosis.falls, std::uint16_t{1});
  // Without a motion for it the robot meets the ground as it is.
  static_cast<void>(begin_recovery_motion(role_of(direction)));
  handle(Event::kFall, Reason::kFallForeseen);
}

bool Controller::begin_recovery_motion(Role role) {
  const auto number = motion_index_.number_of(role);
  motion::Motion motion;
  if (!number || !open_motion(*number, motion)) return false;
  values_.behaviour.motion = static_cast<std::uint8_t>(*number);
  interpreter_.start(motion, {targets_.data(), model_.joint_count});
  return true;
}

// Stiff until the body is about to land, so that the pose is reached; then limp, so that the ground drives no
// gear. Who bends low enough may not fall at all.
void Controller::run_falling(std::uint64_t now_us) {
  if (interpreter_.running()) {
    interpreter_.advance(kTick_us);
    std::ranges::copy(interpreter_.targets(), targets_.begin());
  }
  const bool rests = !interpreter_.running() && stillness_.update(rates_);
  if (rests && recovery::is_up(attitude_.up_B())) return stand_up_straight(Reason::kCaughtItself);
  if (rests || recovery::is_down(attitude_.up_B()) || now_us - entered_us_ >= kLongestFall_us) {
    handle(Event::kDown, Reason::kProgress);
  }
}

void Controller::stand_up_straight(Reason reason) {
  fall_watch_.arm();
  handle(Event::kUpright, reason);
}

void Controller::run_fallen(std::uint64_t now_us) {
  follow_actual();
  if (!stillness_.update(rates_) && now_us - entered_us_ < kLongestSettling_us) return;
  std::uint8_t& attempts = values_.behaviour.attempts;
  if (attempts >= values_.recovery.getting_up.attempts) return fail(Reason::kCannotGetUp);
  ++attempts;
  has_rolled_ = false;
  handle(Event::kStill, Reason::kProgress);
}

void Controller::run_righting() {
  if (!drives_.enabled()) return follow_actual();
  right_lying();
}

void Controller::right_lying() {
  switch (recovery::classify(attitude_.up_B(), thigh_pitch())) {
    case Lying::kUpright:
      // Who was upright and fell again did not stand on its feet.
      if (values_.behaviour.attempts > 1) return rise_from_seat();
      return stand_up_straight(Reason::kHeldUpright);
    case Lying::kSitting:
      return rise_from_seat();
    case Lying::kProne:
      return rise(Role::kRiseProne, Reason::kProne);
    case Lying::kSupine:
      return rise(Role::kRiseSupine, Reason::kSupine);
    case Lying::kLeftSide:
      return turn_from_side(Role::kRollLeft, Reason::kOnLeftSide);
    case Lying::kRightSide:
      return turn_from_side(Role::kRollRight, Reason::kOnRightSide);
  }
}

void Controller::rise(Role role, Reason lying) {
  if (!begin_recovery_motion(role)) return fail(Reason::kCannotGetUp);
  handle(Event::kLiesFlat, lying);
}

// Whose robot has no motion for it lies down first, by the one from its back.
void Controller::rise_from_seat() {
  const bool known = motion_index_.number_of(Role::kRiseSeat).has_value();
  rise(known ? Role::kRiseSeat : Role::kRiseSupine, Reason::kOnSeat);
}

// From hanging down, the mean of both: a knee that is in front makes it negative.
fixed::Angle Controller::thigh_pitch() const {
  std::int64_t hips_raw = 0;
  for (const hal::Side side : {hal::Side::kLeft, hal::Side::kRight}) {
    const std::uint8_t hip = model_.leg(side)[robot::kHipPitch];
    const std::int64_t angle_raw = drives_.angle(hip).raw();
    hips_raw += model_.joints[hip].axis.y.raw() < 0 ? -angle_raw : angle_raw;
  }
  return attitude_.pitch() + fixed::Angle::from_raw(static_cast<std::int32_t>(hips_raw / 2));
}

void Controller::turn_from_side(Role roll, Reason side) {
  if (has_rolled_) return handle(Event::kElsewhere, Reason::kBodyElsewhere);
  has_rolled_ = true;
  if (!begin_recovery_motion(roll)) return fail(Reason::kCannotGetUp);
  handle(Event::kLiesAside, side);
}

void Controller::run_getting_up() {
  interpreter_.advance(kTick_us * pace_percent() / 100);
  std::ranges::copy(interpreter_.targets(), targets_.begin());
  if (interpreter_.running()) return;
  if (interpreter_.failed()) return handle(Event::kElsewhere, Reason::kBodyElsewhere);
  handle(Event::kEnded, Reason::kProgress);
}

// The same motion again would fail again: each attempt is slower than the last.
std::uint32_t Controller::pace_percent() const {
  const std::uint32_t less = values_.recovery.getting_up.slower * (values_.behaviour.attempts - 1u);
  return less >= 100 - kSlowestPace_percent ? kSlowestPace_percent : 100 - less;
}

// The watch for falls goes on meanwhile, once the trunk was upright.
void Controller::run_steadying(std::uint64_t now_us) {
  const bool still = stillness_.update(rates_);
  if (still && recovery::is_upright(attitude_.up_B())) {
    values_.behaviour.attempts = 0;
    values_.diagnosis.risen = fixed::add_saturated(values_.diagnosis.risen, std::uint16_t{1});
    return handle(Event::kArrived, Reason::kProgress);
  }
  const bool down = recovery::is_down(attitude_.up_B());
  if (down || now_us - entered_us_ >= kLongestSteadying_us) {
    handle(Event::kElsewhere, Reason::kBodyElsewhere);
  }
}

}  // namespace koboshi::app
