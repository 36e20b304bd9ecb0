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
constexpr std::int32_t kMaxSwayTicks = 60;
// Of the pendulum, after which the mass rests in the middle: e^-3 is a twentieth.
constexpr std::int64_t kRestTimeConstants = 3;
// More than this the body does not lean while there is a step that could catch it.
constexpr Angle kMostLean = 30.0_deg;
// Before this share of its way a swinging foot that feels a load has not landed but stumbled.
constexpr Ratio kEarliestTouchDown = 0.6_ratio;
constexpr Angle kMostHeadingError = 20.0_deg;
// Of a cycle, in what the error usually is: a time constant of 1.5 s, several steps.
constexpr Ratio kNews = 0.0066667_ratio;

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
  stops_ = false;
  speed_ = Speed();
  stride_ = Stride();
  usual_ = error_ = Point();
  heading_ = Angle();
  standing_ = Side::kLeft;
  stance_ = Stance();
  stance_.soles[index(Side::kRight)].p.y = -gait_.step_width;
  mass_ = PendulumState::at_rest(middle());
  stand_on_both(middle());
  ramp_ = targets_;
  targets_ = standing_targets_;
  enter(Phase::kReadying);
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
    case Phase::kReadying:
      return run_readying();
    case Phase::kSwaying:
      return run_swaying();
    case Phase::kStepping:
      return run_stepping(stops_ ? Velocity() : command, seen);
    case Phase::kGathering:
      return run_gathering();
    case Phase::kSettling:
      return run_settling();
  }
}

void Walker::run_readying() {
  const Ratio fraction = fixed::elapsed_fraction(tick_, kRampTicks);
  for (std::size_t joint = 0; joint < model_.joint_count; ++joint) {
    targets_[joint] = fixed::interpolate(standing_targets_[joint], ramp_[joint], fraction);
  }
  if (tick_ >= kRampTicks) enter(Phase::kSwaying);
}

// About a ZMP under the foot that is to swing first, until the mass is where a step onto the other begins. In
// the last cycle the ZMP is only as far away as takes the mass there: what it went too far, the first step
// would multiply.
void Walker::run_swaying() {
  const Point foot = zmp_under(swinging());
  const Length begins = zmp_under(standing_).y + footsteps_.offset(standing_, stride_).y;
  const PendulumState before = mass_;
  Point zmp = foot;
  pendulum_.advance(mass_, zmp);
  const bool arrived = mass_.divergent.y >= begins;
  if (arrived) {
    const Ratio share = std::clamp(
        fixed::quotient<Ratio>(begins - before.divergent.y, mass_.divergent.y - before.divergent.y), Ratio(),
        kOne);
    zmp = interpolated(before.divergent, foot, share);
    mass_ = before;
    pendulum_.advance(mass_, zmp);
  }
  stand_on_both(zmp);
  if (!arrived && tick_ < kMaxSwayTicks) return;
  zmp_from_ = foot;
  swung_from_ = swings_to_ = stance_.soles[index(swinging())];
  enter(Phase::kStepping);
}

void Walker::run_stepping(const Velocity& command, const Observation& seen) {
  speed_.approach(command, gait_);
  heading_ -= speed_.turn();
  const bool both = tick_ <= gait_.double_ticks;
  const Ratio shifted = both ? fixed::elapsed_fraction(tick_, gait_.double_ticks + 1) : kOne;
  stance_.zmp = interpolated(zmp_from_, zmp_under(standing_), shifted);
  pendulum_.advance(mass_, stance_.zmp);
  stance_.load_shares[index(standing_)] = shifted;
  stance_.load_shares[index(swinging())] = kOne - shifted;
  if (!both) {
    aim();
    swing();
  }
  stance_.pitch = speed_.lean(gait_);
  stance_.yaw = stance_.soles[index(swinging())].yaw / 2;
  pose();
  if (tick_ >= gait_.step_ticks || touched_down(seen)) end_step();
}

// The ZMP stays under the last foot until the mass is back in the middle, and then follows it there.
void Walker::run_gathering() {
  const Point middle_zmp = middle();
  const bool left = standing_ == Side::kLeft;
  const Length from_middle = mass_.divergent.y - middle_zmp.y;
  const bool arrived = left ? from_middle <= Length() : from_middle >= Length();
  if (arrived || tick_ >= kMaxSwayTicks) {
    mass_.divergent = middle_zmp;
    if (zmp_from_ != middle_zmp) {
      zmp_from_ = middle_zmp;
      tick_ = 0;
    }
  }
  const Point zmp = zmp_from_ == middle_zmp ? middle_zmp : zmp_under(standing_);
  pendulum_.advance(mass_, zmp);
  stand_on_both(zmp);
  if (zmp_from_ != middle_zmp || tick_ < rest_ticks(pendulum_.time_constant_s())) return;
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
    const std::int64_t most_raw = kMostLean.raw();
    const Angle lean = Angle::from_raw(static_cast<std::int32_t>(std::clamp(lean_raw, -most_raw, most_raw)));
    return product<Length>(gait_.com_height, in_rad(lean));
  };
  const Point measured{along(seen.pitch - stance_.pitch, seen.rates.y), -along(seen.roll, seen.rates.x)};
  usual_ = interpolated(usual_, measured, kNews);
  error_ = interpolated(measured - usual_, error_, gait_.smoothing);
  heading_ += fixed::rotation(seen.rates.z, kTick_us);
}

// Where the swinging sole has to come down, so that the next step begins with the mass where it should be.
void Walker::aim() {
  const Side swing = swinging();
  stride_ = speed_.stride(gait_);
  const Angle error = std::clamp(heading_, -kMostHeadingError, kMostHeadingError);
  stride_.turn -= product<Angle>(error, gait_.heading_hold);
  const Foothold nominal = footsteps_.step(swing, stride_);
  const Gain growth = pendulum_.growth(static_cast<std::size_t>(gait_.step_ticks - tick_));
  const Point captured{product<Length>(outside(error_.x, gait_.dead_band), gait_.capture_ahead),
                       product<Length>(outside(error_.y, gait_.dead_band), gait_.capture_aside)};
  const Point end = scaled(mass_.divergent + captured - stance_.zmp, growth);
  const Point zmp = stance_.zmp + scaled(end, footsteps_.widening()) -
                    turned(footsteps_.offset_at_once(swing, stride_), nominal.yaw / 2);
  const bool left = swing == Side::kLeft;
  const Point under{gait_.zmp_ahead, left ? -gait_.zmp_inward : gait_.zmp_inward};
  const Point sole = zmp - turned(under, nominal.yaw);
  const Length aside = std::clamp(left ? sole.y : -sole.y, gait_.min_lateral, gait_.max_lateral);
  swings_to_ = {.p = {std::clamp(sole.x, -gait_.max_forward, gait_.max_forward), left ? aside : -aside},
                .yaw = nominal.yaw};
}

void Walker::swing() {
  const Ratio phase =
      fixed::elapsed_fraction(tick_ - gait_.double_ticks, gait_.step_ticks - gait_.double_ticks);
  const auto [sine, cosine] = fixed::sin_cos(Angle::from_wide_raw(std::int64_t{phase.raw()} << 2));
  // A cycloid where the ease is 1. 1 / (2 pi).
  const Ratio progress = phase - product<Ratio>(gait_.ease, product<Ratio>(sine, 0.15915494309189535_ratio));
  const std::size_t swing = index(swinging());
  stance_.soles[swing] = {.p = interpolated(swung_from_.p, swings_to_.p, progress),
                          .yaw = fixed::interpolate_heading(swung_from_.yaw, swings_to_.yaw, progress)};
  stance_.heights[swing] = product<Length>(gait_.step_height, kOne - cosine) / 2;
}

bool Walker::touched_down(const Observation& seen) const {
  if (gait_.touch_down_load == fixed::Force()) return false;
  const Ratio phase =
      fixed::elapsed_fraction(tick_ - gait_.double_ticks, gait_.step_ticks - gait_.double_ticks);
  return phase > kEarliestTouchDown && seen.loads[index(swinging())] > gait_.touch_down_load;
}

// The foot that swung stands, and everything is seen from it.
void Walker::end_step() {
  const Foothold landed = stance_.soles[index(swinging())];
  const Foothold left_behind{.p = seen_from(landed, Point()), .yaw = -landed.yaw};
  stance_.soles[index(standing_)] = left_behind;
  stance_.soles[index(swinging())] = Foothold();
  stance_.heights = {};
  stance_.yaw -= landed.yaw;
  zmp_from_ = seen_from(landed, stance_.zmp);
  mass_ = {seen_from(landed, mass_.divergent), seen_from(landed, mass_.convergent)};
  standing_ = swinging();
  swung_from_ = swings_to_ = left_behind;
  const bool side_by_side = fixed::abs(left_behind.p.x) < 0.005_m;
  enter(stops_ && speed_.is_zero() && side_by_side ? Phase::kGathering : Phase::kStepping);
}

// Both bear the share that puts the ZMP there.
void Walker::stand_on_both(Point zmp) {
  const Length left = zmp_under(Side::kLeft).y;
  const Length right = zmp_under(Side::kRight).y;
  const Ratio share = std::clamp(fixed::quotient<Ratio>(zmp.y - right, left - right), Ratio(), kOne);
  stance_.load_shares = {share, kOne - share};
  stance_.zmp = zmp;
  stance_.pitch = speed_.lean(gait_);
  stance_.yaw = stance_.soles[index(swinging())].yaw / 2;
  pose();
}

void Walker::pose() {
  const Point com = mass_.position();
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
    const std::int32_t way_raw = (side == 0 ? 1 : -1) * shoulder.sign * swing.raw();
    if (shoulder.sign == 0) continue;
    targets_[shoulder.joint] = standing_targets_[shoulder.joint] + Angle::from_raw(way_raw);
  }
}

Point Walker::zmp_under(Side side) const {
  const Foothold& sole = stance_.soles[index(side)];
  const Length inward = side == Side::kLeft ? -gait_.zmp_inward : gait_.zmp_inward;
  return sole.p + turned({gait_.zmp_ahead, inward}, sole.yaw);
}

Point Walker::middle() const {
  return interpolated(zmp_under(Side::kLeft), zmp_under(Side::kRight), 0.5_ratio);
}

}  // namespace koboshi::walk
