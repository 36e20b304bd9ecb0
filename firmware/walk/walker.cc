#include "firmware/walk/walker.h"

#include <algorithm>

#include "firmware/fixed/contract.h"
#include "firmware/fixed/dead_band.h"
#include "firmware/fixed/interpolation.h"
#include "firmware/fixed/radians.h"
#include "firmware/fixed/trigonometry.h"
#include "firmware/robot/leg.h"
#include "hal/port/period.h"

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

constexpr Ratio kTurnsPerRad = literal<Ratio>(1.0L / kRadPerTurn);
// The ramps between standing and bent knees: 0.5 s, by hand, 2026-11-22.
constexpr std::int32_t kRampTicks = 50;
// The time by which servos are behind their targets: 0.2 s, by hand, 2026-11-22. The walk ends when the
// servos have arrived, not when their targets have.
constexpr std::int32_t kArrivalTicks = 20;
// Time-out of the shift of weight onto a foot or back to the middle: 0.6 s, three times what it takes with
// the default robot, and still enough for a pendulum of 1 m.
constexpr std::int32_t kMaxShiftTicks = 60;
// How long the ZMP stays midway between the feet at the end, in time constants of the pendulum: the CoM's
// remaining offset is then e^-3 of the first one, a twentieth.
constexpr std::int64_t kRestTimeConstants = 3;
// Clamp of the predicted lean: beyond it no step restores balance. By hand, 2026-11-22, above the lean at
// which a fall is detected.
constexpr Angle kMaxLean = 30.0_deg;
// The share of the swing before which a load on the swing foot is a stumble, not a touchdown. By hand,
// 2026-11-22: the foot is then on its way down, past the greatest height at 0.5.
constexpr Ratio kMinTouchdownPhase = 0.6_ratio;
// Clamp of the heading error, by hand, 2026-11-22: times heading_hold it bounds the extra turn of a step.
constexpr Angle kMaxHeadingError = 20.0_deg;
// Share of a cycle's measurement in the DCM bias: 10 ms / 1.5 s, an average over seven steps of the default
// robot. By hand, 2026-11-22: without the bias the robot followed the slope of the floor at 5 to 10 cm/s.
constexpr Ratio kDcmBiasShare = 0.0066667_ratio;
// Feet that are apart by less in the forward direction are side by side. By hand, 2026-11-22.
constexpr Length kSideBySide = 0.005_m;

Point scaled(Point p, Gain factor) { return {product<Length>(p.x, factor), product<Length>(p.y, factor)}; }

Point interpolated(Point from, Point to, Ratio fraction) {
  return {fixed::interpolate(from.x, to.x, fraction), fixed::interpolate(from.y, to.y, fraction)};
}

// Returns how long the ZMP stays midway between the feet, in cycles of 10 ms, rounded up.
std::int32_t rest_ticks(Ratio time_constant_s) {
  const std::int64_t ticks_raw = kRestTimeConstants * 100 * time_constant_s.raw();
  return static_cast<std::int32_t>((ticks_raw + kOne.raw() - 1) / kOne.raw());
}

// The same point in the frame of `sole`.
Point seen_from(const Foothold& sole, Point p) { return turned(p - sole.p, -sole.yaw); }

}  // namespace

Walker::Walker(const robot::RobotModel& model)
    : model_(model), body_(model), pendulum_(gait_.com_height), footsteps_({}, {}, {}) {
  using enum robot::JointRole;
  const std::array roles{kLeftShoulderPitch, kRightShoulderPitch};
  for (std::size_t side = 0; side < roles.size(); ++side) {
    if (const auto joint = model.find(roles[side])) {
      const bool axis_points_left = model.joints[*joint].axis.y > Ratio();
      shoulders_[side] = {*joint, static_cast<std::int8_t>(axis_points_left ? 1 : -1)};
    }
  }
}

void Walker::start(const WalkParameters& parameters, std::span<const Angle> targets) {
  KOBOSHI_ASSERT(is_possible() && targets.size() == model_.joint_count);
  gait_ = Gait(parameters);
  // Legs without hip yaw cannot turn the robot back to its heading.
  if (!robot::can_turn(model_)) gait_.heading_hold = Ratio();
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
  heading_error_ = Angle();
  support_ = Side::kLeft;
  stance_ = Stance();
  stance_.soles[Side::kRight].p.y = -gait_.step_width;
  com_ = PendulumState::at_rest(middle());
  body_.begin_in_parts();
  body_.set_upper_body(gait_.follows_upper_body ? targets : std::span<const Angle>());
  if (body_.is_complete()) bend_knees();
  enter(Phase::kPreparing);
}

void Walker::enter(Phase phase) {
  phase_ = phase;
  tick_ = 0;
}

void Walker::advance(const Velocity& command, const Observation& seen) {
  ++tick_;
  observe(seen);
  if (gait_.follows_upper_body && running())
    body_.set_upper_body(seen.angles.empty() ? std::span<const Angle>(targets_) : seen.angles);
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

void Walker::bend_knees() {
  stand_on_both(middle());
  ramp_ = targets_;
  targets_ = standing_targets_;
}

void Walker::run_preparing() {
  if (!body_.is_complete()) {
    bend_knees();
    tick_ = 0;
    return;
  }
  const Ratio fraction = fixed::elapsed_fraction(tick_, kRampTicks);
  for (std::size_t joint = 0; joint < model_.joint_count; ++joint) {
    targets_[joint] = fixed::interpolate(standing_targets_[joint], ramp_[joint], fraction);
  }
  if (tick_ >= kRampTicks) enter(Phase::kWeightShift);
}

// Double support with the ZMP under the right foot, which swings first. The DCM moves away from that ZMP, to
// the left, until it is at the offset from the left foot with which a step begins (Footsteps::offset). The
// ZMP of the last cycle is placed so that the DCM arrives exactly there, because the first step multiplies
// any overshoot by its growth. After the time-out the first step begins from wherever the DCM is.
void Walker::run_weight_shift() {
  const Point foot = zmp_under(swing_side());
  const Length step_begins_y = zmp_under(support_).y + footsteps_.offset(support_, stride_).y;
  const PendulumState before = com_;
  Point zmp = foot;
  pendulum_.advance(com_, zmp);
  const bool arrived = com_.dcm.y >= step_begins_y;  // the left foot supports
  if (arrived) {
    const Ratio share = std::clamp(
        fixed::quotient<Ratio>(step_begins_y - before.dcm.y, com_.dcm.y - before.dcm.y), Ratio(), kOne);
    zmp = interpolated(before.dcm, foot, share);
    com_ = before;
    pendulum_.advance(com_, zmp);
  }
  stand_on_both(zmp);
  if (!arrived && tick_ < kMaxShiftTicks) return;
  last_zmp_ = foot;
  liftoff_ = landing_ = stance_.soles[swing_side()];
  enter(Phase::kStepping);
}

void Walker::run_stepping(const Velocity& command, const Observation& seen) {
  speed_.approach(command, gait_);
  heading_error_ -= speed_.turn();
  // In double support the ZMP moves from the foot that will swing to the support foot.
  const bool double_support = tick_ <= gait_.double_ticks;
  const Ratio shifted = double_support ? fixed::elapsed_fraction(tick_, gait_.double_ticks + 1) : kOne;
  stance_.zmp = interpolated(last_zmp_, zmp_under(support_), shifted);
  pendulum_.advance(com_, stance_.zmp);
  stance_.load_shares[support_] = shifted;
  stance_.load_shares[swing_side()] = kOne - shifted;
  if (!double_support) {
    plan_landing();
    move_swing_foot();
  }
  stance_.pitch = speed_.lean(gait_);
  stance_.yaw = stance_.soles[swing_side()].yaw / 2;
  pose();
  if (tick_ >= gait_.step_ticks || has_touched_down(seen)) end_step();
}

// Double support with the ZMP under the support foot, until the DCM is midway between the feet. Then both are
// put exactly there and stay, while the convergent component of motion decays. The jump of the planned DCM is
// one cycle's motion in y, and in x what is left of the last stride; after the time-out it may be larger, and
// the feedback takes it up.
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

// The DCM is x + x' / omega. A body that leans by `a` more than planned and turns at the rate w has a CoM
// that is off by z a and moves by z w, so the DCM error is
//
//   z (a + w T_c),  T_c = 1 / omega = sqrt(z / g)
//
// The lean a + w T_c is clamped. A sloping floor and sagging servos cause a lasting error, the bias. It is
// subtracted, because a robot that stepped towards it would never stop walking that way. The remainder is
// smoothed:
//
//   bias  += (measured - bias) / 150
//   error  = (1 - smoothing) (measured - bias) + smoothing * last error
void Walker::observe(const Observation& seen) {
  const auto dcm_offset = [&](Angle angle, AngularRate rate) {
    // The rate's LSB is 2^-24 turn/s, the time's 2^-30 s and the angle's 2^-32 turn: the shift is 24 + 30
    // - 32.
    const Angle lean_within_time_constant = Angle::from_raw(fixed::saturate<std::int32_t>(
        fixed::shift_rounded(std::int64_t{rate.raw()} * pendulum_.time_constant_s().raw(), 22)));
    const std::int64_t lean_raw = std::int64_t{angle.raw()} + lean_within_time_constant.raw();
    const std::int64_t max_raw = kMaxLean.raw();
    const Angle lean = Angle::from_raw(static_cast<std::int32_t>(std::clamp(lean_raw, -max_raw, max_raw)));
    return product<Length>(gait_.com_height, fixed::in_rad(lean));
  };
  // A roll to the right moves the CoM towards negative y; no roll is planned.
  const Point measured{dcm_offset(seen.pitch - stance_.pitch, seen.rates.y),
                       -dcm_offset(seen.roll, seen.rates.x)};
  dcm_bias_ = interpolated(dcm_bias_, measured, kDcmBiasShare);
  dcm_error_ = interpolated(measured - dcm_bias_, dcm_error_, gait_.smoothing);
  heading_error_ += fixed::rotation(seen.rates.z, std::int32_t{hal::kControlPeriod_us});
}

// Chooses the landing position of the swing foot's sole, from which the next step begins with the DCM of a
// periodic gait. With the DCM xi, its error e beyond the dead band, the ZMP p, the time t left of the step,
// the growth G(t) = e^(omega t), the lag lambda of double support (Pendulum::lag) and the offset c of the
// next step's DCM from its ZMP (Footsteps::offset_at_once, turned by half the step's yaw), all in the frame
// of the support foot:
//
//   end     = G(t) (xi + capture e - p)     DCM at the end of the step, from the ZMP
//   landing = p + end / (1 - lambda) - c    ZMP of the next step; 1 / (1 - lambda) is Footsteps::widening
//
// The first line is the motion of the DCM about a resting ZMP (pendulum.h). The second is the foot placement
// of Englsberger et al. with the double support that follows (docs/design/walking.md). The sole lies
// zmp_forward behind and zmp_inward outside that ZMP. The limits keep it within reach of the leg and the
// soles apart.
void Walker::plan_landing() {
  const Side swing = swing_side();
  stride_ = speed_.stride(gait_);
  const Angle error = std::clamp(heading_error_, -kMaxHeadingError, kMaxHeadingError);
  stride_.turn -= product<Angle>(error, gait_.heading_hold);
  const Foothold nominal = footsteps_.step(swing, stride_);
  const Gain growth = pendulum_.growth(static_cast<std::size_t>(gait_.step_ticks - tick_));
  const Point captured{
      product<Length>(fixed::dead_band(dcm_error_.x, gait_.dead_band), gait_.capture_forward),
      product<Length>(fixed::dead_band(dcm_error_.y, gait_.dead_band), gait_.capture_lateral)};
  const Point end = scaled(com_.dcm + captured - stance_.zmp, growth);
  const Point zmp = stance_.zmp + scaled(end, footsteps_.widening()) -
                    turned(footsteps_.offset_at_once(swing, stride_), nominal.yaw / 2);
  const bool left = swing == Side::kLeft;
  const Point under{gait_.zmp_forward, left ? -gait_.zmp_inward : gait_.zmp_inward};
  const Point sole = zmp - turned(under, nominal.yaw);
  const Length lateral = std::clamp(left ? sole.y : -sole.y, gait_.min_lateral, gait_.max_lateral);
  landing_ = {.p = {std::clamp(sole.x, -gait_.max_forward, gait_.max_forward), left ? lateral : -lateral},
              .yaw = nominal.yaw};
}

// Moves the sole of the swing foot from liftoff to landing. With the phase s from 0 to 1 and the swing
// profile c
//
//   progress = s - c sin(2 pi s) / (2 pi),  height = h (1 - cos(2 pi s)) / 2
//
// c = 1 is a cycloid, which leaves and meets the ground without speed; c = 0 is constant speed.
void Walker::move_swing_foot() {
  const Ratio phase =
      fixed::elapsed_fraction(tick_ - gait_.double_ticks, gait_.step_ticks - gait_.double_ticks);
  const auto [sine, cosine] = fixed::sin_cos(Angle::from_wide_raw(std::int64_t{phase.raw()} << 2));
  const Ratio progress = phase - product<Ratio>(gait_.swing_profile, product<Ratio>(sine, kTurnsPerRad));
  const Side swing = swing_side();
  stance_.soles[swing] = {.p = interpolated(liftoff_.p, landing_.p, progress),
                          .yaw = fixed::interpolate_heading(liftoff_.yaw, landing_.yaw, progress)};
  stance_.heights[swing] = product<Length>(gait_.step_height, kOne - cosine) / 2;
}

// Whether the swing foot bears its touchdown load late enough in its swing; never with a touchdown load of 0.
bool Walker::has_touched_down(const Observation& seen) const {
  if (gait_.touchdown_load == fixed::Force()) return false;
  const Ratio phase =
      fixed::elapsed_fraction(tick_ - gait_.double_ticks, gait_.step_ticks - gait_.double_ticks);
  return phase > kMinTouchdownPhase && seen.loads[swing_side()] > gait_.touchdown_load;
}

// Makes the swing foot, where it is now, the support foot: all positions are moved into the frame of its
// sole. The next step begins there, or, when the robot is to stop and the feet are side by side, the closing
// step. A foot that touched down early is on the ground although its planned height was not zero yet.
void Walker::end_step() {
  const Foothold landed = stance_.soles[swing_side()];
  const Foothold left_behind{.p = seen_from(landed, Point()), .yaw = -landed.yaw};
  stance_.soles[support_] = left_behind;
  stance_.soles[swing_side()] = Foothold();
  stance_.heights = {};
  stance_.yaw -= landed.yaw;
  stance_.zmp = last_zmp_ = seen_from(landed, stance_.zmp);
  com_ = {seen_from(landed, com_.dcm), seen_from(landed, com_.ccm)};
  support_ = swing_side();
  liftoff_ = landing_ = left_behind;
  const bool side_by_side = fixed::abs(left_behind.p.x) < kSideBySide;
  enter(stopping_ && speed_.is_zero() && side_by_side ? Phase::kClosingStep : Phase::kStepping);
}

std::optional<PlannedZmp> Walker::planned_zmp() const {
  const bool plans =
      phase_ == Phase::kWeightShift || phase_ == Phase::kStepping || phase_ == Phase::kClosingStep;
  return plans ? std::optional(PlannedZmp{stance_.zmp, support_}) : std::nullopt;
}

// Each foot bears the share of the weight that puts the ZMP where it is planned, by the law of the lever.
void Walker::stand_on_both(Point zmp) {
  const Length left = zmp_under(Side::kLeft).y;
  const Length right = zmp_under(Side::kRight).y;
  const Ratio share = std::clamp(fixed::quotient<Ratio>(zmp.y - right, left - right), Ratio(), kOne);
  stance_.load_shares = {share, kOne - share};
  stance_.zmp = zmp;
  stance_.pitch = speed_.lean(gait_);
  stance_.yaw = stance_.soles[swing_side()].yaw / 2;
  pose();
}

void Walker::pose() {
  const Point com = com_.position();
  stance_.centre_of_mass = {com.x, com.y, gait_.com_height};
  body_.solve(stance_, gait_.compliance, targets_);
  swing_arms();
}

void Walker::swing_arms() {
  const Length left_forward = stance_.soles[0].p.x - stance_.soles[1].p.x;
  // An arm that swings forward turns negatively about y; the left arm swings with the right foot.
  const Angle swing = fixed::from_rad(product<Ratio>(left_forward, gait_.arm_swing));
  for (std::size_t side = 0; side < shoulders_.size(); ++side) {
    const Shoulder& shoulder = shoulders_[side];
    const std::int32_t turn_raw = (side == 0 ? 1 : -1) * shoulder.sign * swing.raw();
    if (shoulder.sign == 0) continue;
    targets_[shoulder.joint] = standing_targets_[shoulder.joint] + Angle::from_raw(turn_raw);
  }
}

Point Walker::zmp_under(Side side) const {
  const Foothold& sole = stance_.soles[side];
  const Length inward = side == Side::kLeft ? -gait_.zmp_inward : gait_.zmp_inward;
  return sole.p + turned({gait_.zmp_forward, inward}, sole.yaw);
}

Point Walker::middle() const {
  return interpolated(zmp_under(Side::kLeft), zmp_under(Side::kRight), 0.5_ratio);
}

}  // namespace koboshi::walk
