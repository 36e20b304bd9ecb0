#include "firmware/walk/walker.h"

#include <algorithm>

#include "firmware/fixed/contract.h"
#include "firmware/fixed/interpolation.h"
#include "firmware/fixed/trigonometry.h"
#include "firmware/walk/radians.h"

namespace koboshi::walk {

using fixed::Angle;
using fixed::AngularRate;
using fixed::Gain;
using fixed::kOne;
using fixed::Length;
using fixed::product;
using fixed::Ratio;
using hal::Side;
using namespace fixed::literals;

namespace {

constexpr std::int32_t kTick_us = 10'000;
constexpr std::int32_t kRampTicks = 50;
// By which servos come after their targets.
constexpr std::int32_t kArrivalTicks = 20;
// How long the mass may take to go over to a foot, or back to the middle: three times what it takes.
constexpr std::int32_t kMaxShiftTicks = 60;
// Of the pendulum, after which the mass rests in the middle: e^-3 is a twentieth.
constexpr std::int64_t kRestTimeConstants = 3;
// More than this the body does not lean while there is a step that could catch it.
constexpr Angle kMaxLean = 30.0_deg;
// Before this share of its way a swinging foot that feels a load has not landed but stumbled.
constexpr Ratio kMinTouchdownPhase = 0.6_ratio;
constexpr Angle kMaxHeadingError = 20.0_deg;
// Of a cycle, in what the error usually is: a time constant of 1.5 s, several steps.
constexpr Ratio kDcmBiasShare = 0.0066667_ratio;

std::size_t index(Side side) { return static_cast<std::size_t>(side); }

Length outside(Length value, Length band) {
  if (value > band) return value - band;
  return value < -band ? value + band : Length();
}

Point scaled(Point p, Gain factor) { return {product<Length>(p.x, factor), product<Length>(p.y, factor)}; }

Point interpolated(Point from, Point to, Ratio fraction) {
  return {fixed::interpolate(from.x, to.x, fraction), fixed::interpolate(from.y, to.y, fraction)};
}

// Cycles of 10 ms, rounded up.
std::int32_t rest_ticks(Ratio time_constant_s) {
  const std::int64_t ticks_raw = kRestTimeConstants * 100 * time_constant_s.raw();
  return static_cast<std::int32_t>((ticks_raw + kOne.raw() - 1) / kOne.raw());
}

// Seen from a sole that the robot changes to.
Point seen_from(const Foothold& sole, Point p) { return turned(p - sole.p, -sole.yaw); }

}  // namespace

Walker::Walker(const robot::RobotModel& model)
    : model_(model), body_(model), pendulum_(gait_.com_height), footsteps_({}, {}, {}) {
  using enum robot::JointRole;
  const std::array roles{kLeftShoulderPitch, kRightShoulderPitch};
  for (std::size_t side = 0; side < roles.size(); ++side) {
    if (const auto joint = model.find(roles[side])) {
      const bool turns_left = model.joints[*joint].axis.y > Ratio();
      shoulders_[side] = {*joint, static_cast<std::int8_t>(turns_left ? 1 : -1)};
    }
  }
}

void Walker::start(const WalkParameters& parameters, std::span<const Angle> targets) {
  KOBOSHI_ASSERT(model_.joint_count > 0 && targets.size() == model_.joint_count);
  gait_ = Gait(parameters);
  pendulum_ = Pendulum(gait_.com_height);
  footsteps_ = Footsteps(gait_.step_width - gait_.zmp_inward * 2,
                         pendulum_.growth(static_cast<std::size_t>(gait_.step_ticks)),
                         pendulum_.lag(gait_.double_ticks));
  std::ranges::copy(targets, standing_targets_.begin());
  targets_ = standing_targets_;
  stopping_ = false;
  speed_ = Speed();
  stride_ = Stride();
  dcm_bias_ = dcm_error_ = Point();
  heading_ = Angle();
  support_ = Side::kLeft;
  stance_ = Stance();
  stance_.soles[index(Side::kRight)].p.y = -gait_.step_width;
  com_ = PendulumState::at_rest(middle());
  stand_on_both(middle());
  ramp_ = targets_;
  targets_ = standing_targets_;
  enter(Phase::kPreparing);
}

void Walker::enter(Phase phase) {
  phase_ = phase;
  tick_ = 0;
}

void Walker::advance(const Velocity& command, const Observation& seen) {
  ++tick_;
  observe(seen);
  switch (phase_) {
    case Phase::kIdle:
      return;
    case Phase::kPreparing:
      return run_preparing();
    case Phase::kWeightShift:
      return run_weight_shift();
    case Phase::kStepping:
      return run_stepping(stopping_ ? Velocity() : command, seen);
    case Phase::kClosingStep:
      return run_closing_step();
    case Phase::kSettling:
      return run_settling();
  }
}

void Walker::run_preparing() {
  const Ratio fraction = fixed::elapsed_fraction(tick_, kRampTicks);
  for (std::size_t joint = 0; joint < model_.joint_count; ++joint) {
    targets_[joint] = fixed::interpolate(standing_targets_[joint], ramp_[joint], fraction);
  }
  if (tick_ >= kRampTicks) enter(Phase::kWeightShift);
}

// About a ZMP under the foot that is to swing first, until the mass is where a step onto the other begins. In
// the last cycle the ZMP is only as far away as takes the mass there: what it went too far, the first step
// would multiply.
void Walker::run_weight_shift() {
  const Point foot = zmp_under(swing_side());
  const Length begins = zmp_under(support_).y + footsteps_.offset(support_, stride_).y;
  const PendulumState before = com_;
  Point zmp = foot;
  pendulum_.advance(com_, zmp);
  const bool arrived = com_.dcm.y >= begins;
  if (arrived) {
    const Ratio share =
        std::clamp(fixed::quotient<Ratio>(begins - before.dcm.y, com_.dcm.y - before.dcm.y), Ratio(), kOne);
    zmp = interpolated(before.dcm, foot, share);
    com_ = before;
    pendulum_.advance(com_, zmp);
  }
  stand_on_both(zmp);
  if (!arrived && tick_ < kMaxShiftTicks) return;
  last_zmp_ = foot;
  liftoff_ = landing_ = stance_.soles[index(swing_side())];
  enter(Phase::kStepping);
}

void Walker::run_stepping(const Velocity& command, const Observation& seen) {
  speed_.approach(command, gait_);
  heading_ -= speed_.turn();
  const bool both = tick_ <= gait_.double_ticks;
  const Ratio shifted = both ? fixed::elapsed_fraction(tick_, gait_.double_ticks + 1) : kOne;
  stance_.zmp = interpolated(last_zmp_, zmp_under(support_), shifted);
  pendulum_.advance(com_, stance_.zmp);
  stance_.load_shares[index(support_)] = shifted;
  stance_.load_shares[index(swing_side())] = kOne - shifted;
  if (!both) {
    plan_landing();
    swing();
  }
  stance_.pitch = speed_.lean(gait_);
  stance_.yaw = stance_.soles[index(swing_side())].yaw / 2;
  pose();
  if (tick_ >= gait_.step_ticks || has_touched_down(seen)) end_step();
}

// The ZMP stays under the last foot until the mass is back in the middle, and then follows it there.
void Walker::run_closing_step() {
  const Point middle_zmp = middle();
  const bool left = support_ == Side::kLeft;
  const Length from_middle = com_.dcm.y - middle_zmp.y;
  const bool arrived = left ? from_middle <= Length() : from_middle >= Length();
  if (arrived || tick_ >= kMaxShiftTicks) {
    com_.dcm = middle_zmp;
    if (last_zmp_ != middle_zmp) {
      last_zmp_ = middle_zmp;
      tick_ = 0;
    }
  }
  const Point zmp = last_zmp_ == middle_zmp ? middle_zmp : zmp_under(support_);
  pendulum_.advance(com_, zmp);
  stand_on_both(zmp);
  if (last_zmp_ != middle_zmp || tick_ < rest_ticks(pendulum_.time_constant_s())) return;
  ramp_ = targets_;
  enter(Phase::kSettling);
}

void Walker::run_settling() {
  const Ratio fraction = fixed::elapsed_fraction(std::min(tick_, kRampTicks), kRampTicks);
  for (std::size_t joint = 0; joint < model_.joint_count; ++joint) {
    targets_[joint] = fixed::interpolate(ramp_[joint], standing_targets_[joint], fraction);
  }
  if (tick_ >= kRampTicks + kArrivalTicks) enter(Phase::kIdle);
}

// A body that leans by an angle more than planned, and turns at a rate, is ahead of its plan by height times
// both: the error of the divergent part. What stays is no push, but a floor that slopes or servos that sag:
// to step after it would make the robot wander off.
void Walker::observe(const Observation& seen) {
  const auto along = [&](Angle angle, AngularRate rate) {
    const Angle soon = Angle::from_raw(fixed::saturate<std::int32_t>(
        fixed::shift_rounded(std::int64_t{rate.raw()} * pendulum_.time_constant_s().raw(), 22)));
    const std::int64_t lean_raw = std::int64_t{angle.raw()} + soon.raw();
    const std::int64_t most_raw = kMaxLean.raw();
    const Angle lean = Angle::from_raw(static_cast<std::int32_t>(std::clamp(lean_raw, -most_raw, most_raw)));
    return product<Length>(gait_.com_height, in_rad(lean));
  };
  const Point measured{along(seen.pitch - stance_.pitch, seen.rates.y), -along(seen.roll, seen.rates.x)};
  dcm_bias_ = interpolated(dcm_bias_, measured, kDcmBiasShare);
  dcm_error_ = interpolated(measured - dcm_bias_, dcm_error_, gait_.smoothing);
  heading_ += fixed::rotation(seen.rates.z, kTick_us);
}

// Where the swinging sole has to come down, so that the next step begins with the mass where it should be.
void Walker::plan_landing() {
  const Side swing = swing_side();
  stride_ = speed_.stride(gait_);
  const Angle error = std::clamp(heading_, -kMaxHeadingError, kMaxHeadingError);
  stride_.turn -= product<Angle>(error, gait_.heading_hold);
  const Foothold nominal = footsteps_.step(swing, stride_);
  const Gain growth = pendulum_.growth(static_cast<std::size_t>(gait_.step_ticks - tick_));
  const Point captured{product<Length>(outside(dcm_error_.x, gait_.dead_band), gait_.capture_forward),
                       product<Length>(outside(dcm_error_.y, gait_.dead_band), gait_.capture_lateral)};
  const Point end = scaled(com_.dcm + captured - stance_.zmp, growth);
  const Point zmp = stance_.zmp + scaled(end, footsteps_.widening()) -
                    turned(footsteps_.offset_at_once(swing, stride_), nominal.yaw / 2);
  const bool left = swing == Side::kLeft;
  const Point under{gait_.zmp_forward, left ? -gait_.zmp_inward : gait_.zmp_inward};
  const Point sole = zmp - turned(under, nominal.yaw);
  const Length aside = std::clamp(left ? sole.y : -sole.y, gait_.min_lateral, gait_.max_lateral);
  landing_ = {.p = {std::clamp(sole.x, -gait_.max_forward, gait_.max_forward), left ? aside : -aside},
              .yaw = nominal.yaw};
}

void Walker::swing() {
  const Ratio phase =
      fixed::elapsed_fraction(tick_ - gait_.double_ticks, gait_.step_ticks - gait_.double_ticks);
  const auto [sine, cosine] = fixed::sin_cos(Angle::from_wide_raw(std::int64_t{phase.raw()} << 2));
  // A cycloid where the ease is 1. 1 / (2 pi).
  const Ratio progress =
      phase - product<Ratio>(gait_.swing_profile, product<Ratio>(sine, 0.15915494309189535_ratio));
  const std::size_t swing = index(swing_side());
  stance_.soles[swing] = {.p = interpolated(liftoff_.p, landing_.p, progress),
                          .yaw = fixed::interpolate_heading(liftoff_.yaw, landing_.yaw, progress)};
  stance_.heights[swing] = product<Length>(gait_.step_height, kOne - cosine) / 2;
}

bool Walker::has_touched_down(const Observation& seen) const {
  if (gait_.touchdown_load == fixed::Force()) return false;
  const Ratio phase =
      fixed::elapsed_fraction(tick_ - gait_.double_ticks, gait_.step_ticks - gait_.double_ticks);
  return phase > kMinTouchdownPhase && seen.loads[index(swing_side())] > gait_.touchdown_load;
}

// The foot that swung stands, and everything is seen from it.
void Walker::end_step() {
  const Foothold landed = stance_.soles[index(swing_side())];
  const Foothold left_behind{.p = seen_from(landed, Point()), .yaw = -landed.yaw};
  stance_.soles[index(support_)] = left_behind;
  stance_.soles[index(swing_side())] = Foothold();
  stance_.heights = {};
  stance_.yaw -= landed.yaw;
  last_zmp_ = seen_from(landed, stance_.zmp);
  com_ = {seen_from(landed, com_.dcm), seen_from(landed, com_.ccm)};
  support_ = swing_side();
  liftoff_ = landing_ = left_behind;
  const bool side_by_side = fixed::abs(left_behind.p.x) < 0.005_m;
  enter(stopping_ && speed_.is_zero() && side_by_side ? Phase::kClosingStep : Phase::kStepping);
}

// Both bear the share that puts the ZMP there.
void Walker::stand_on_both(Point zmp) {
  const Length left = zmp_under(Side::kLeft).y;
  const Length right = zmp_under(Side::kRight).y;
  const Ratio share = std::clamp(fixed::quotient<Ratio>(zmp.y - right, left - right), Ratio(), kOne);
  stance_.load_shares = {share, kOne - share};
  stance_.zmp = zmp;
  stance_.pitch = speed_.lean(gait_);
  stance_.yaw = stance_.soles[index(swing_side())].yaw / 2;
  pose();
}

void Walker::pose() {
  const Point com = com_.position();
  stance_.centre_of_mass = {com.x, com.y, gait_.com_height};
  body_.solve(stance_, gait_.compliance, targets_);
  swing_arms();
}

void Walker::swing_arms() {
  const Length left_ahead = stance_.soles[0].p.x - stance_.soles[1].p.x;
  // An arm that goes ahead turns about y to the negative; the left one goes with the right foot.
  const Angle swing = from_rad(product<Ratio>(left_ahead, gait_.arm_swing));
  for (std::size_t side = 0; side < shoulders_.size(); ++side) {
    const Shoulder& shoulder = shoulders_[side];
    const std::int32_t distance_raw = (side == 0 ? 1 : -1) * shoulder.sign * swing.raw();
    if (shoulder.sign == 0) continue;
    targets_[shoulder.joint] = standing_targets_[shoulder.joint] + Angle::from_raw(distance_raw);
  }
}

Point Walker::zmp_under(Side side) const {
  const Foothold& sole = stance_.soles[index(side)];
  const Length inward = side == Side::kLeft ? -gait_.zmp_inward : gait_.zmp_inward;
  return sole.p + turned({gait_.zmp_forward, inward}, sole.yaw);
}

Point Walker::middle() const {
  return interpolated(zmp_under(Side::kLeft), zmp_under(Side::kRight), 0.5_ratio);
}

}  // namespace koboshi::walk
