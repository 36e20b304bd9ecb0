#include "firmware/walk/walker.h"

#include <algorithm>

#include "firmware/fixed/contract.h"
#include "firmware/fixed/dead_band.h"
#include "firmware/fixed/interpolation.h"
#include "firmware/fixed/trigonometry.h"
#include "firmware/robot/leg.h"

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
// In which the carriage goes over to changed parameters: 0.25 s, by hand, 2026-11-29. 10 mm of height then
// make no joint of the default robot faster by more than 0.7 rad/s; at once they would by 25.
constexpr std::int32_t kCarriageTicks = 25;
// The ramp from bent knees to standing: 0.5 s, by hand, 2026-11-22.
constexpr std::int32_t kRampTicks = 50;
// In which the standing pose fades into the plan at the beginning: 0.25 s, by hand, 2026-11-28.
constexpr std::int32_t kBlendTicks = 25;
// The time by which servos are behind their targets: 0.2 s, by hand, 2026-11-22. The walk ends when the
// servos have arrived, not when their targets have.
constexpr std::int32_t kArrivalTicks = 20;
// Time-out of the shift of weight onto a foot or back to the middle: 0.6 s, three times what it takes with
// the default robot, and still enough for a pendulum of 1 m.
constexpr std::int32_t kMaxShiftTicks = 60;
// How long the ZMP stays midway between the feet at the end, in time constants of the pendulum: the CoM's
// remaining offset is then e^-3 of the first one, a twentieth.
constexpr std::int64_t kRestTimeConstants = 3;
// Clamp of the DCM error: beyond it no step restores balance. By hand, 2026-11-28: half of the longest step.
constexpr Length kMaxDcmError = 0.08_m;
// Share of a step's error in the mean of its cycle, and what of an error counts: by hand, 2026-11-28, an
// average over ten steps, in which a push leaves no more than 2 mm.
constexpr Ratio kMeanShare = 0.1_ratio;
constexpr Length kMaxInMean = 0.02_m;
// Share of a cycle's lean in its mean: 1 s.
constexpr Ratio kLeanMeanShare = 0.01_ratio;
// The part of the swing in which the sole comes to be held level, and the cycles in which it ceases to be
// after the landing: by hand, 2026-11-28, after a prototype that levelled from the middle of the swing on.
constexpr Ratio kLevelFrom = 0.4_ratio;
constexpr std::int32_t kLevelSteepness = 5;  // within a fifth of the swing
// The share of the swing before which a load on the swing foot is a stumble, not a touchdown. By hand,
// 2026-11-22: the foot is then on its way down, past the greatest height at 0.5.
constexpr Ratio kMinTouchdownPhase = 0.6_ratio;
// Clamp of the heading error, by hand, 2026-11-22: times heading_hold it bounds the extra turn of a step.
constexpr Angle kMaxHeadingError = 20.0_deg;
// Feet that are apart by less in the forward direction are side by side. By hand, 2026-11-22.
constexpr Length kSideBySide = 0.005_m;
// After so many steps on the spot each further one allows another kSideBySide, up to so many of them. By
// hand, 2026-11-28: an undisturbed robot stops within two steps.
constexpr std::int32_t kPatientSteps = 4;
constexpr std::int32_t kMostApart = 6;

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
    : model_(model),
      body_(model),
      arms_(model),
      pendulum_(gait_.carriage.com_height),
      footsteps_({}, {}, {}),
      landing_on_{footsteps_, {}, {}} {}

void Walker::start(const WalkParameters& parameters, std::span<const Angle> targets,
                   std::optional<Side> pushed_to) {
  KOBOSHI_ASSERT(is_possible() && targets.size() == model_.joint_count);
  parameters_ = &parameters;
  pushed_ = stopping_ = pushed_to.has_value();
  use(wanted());
  changes_.reset();
  carriage_ = gait_.carriage;
  carriage_ticks_left_ = 0;
  std::ranges::copy(targets, standing_targets_.begin());
  targets_ = standing_targets_;
  swing_phase_ = Ratio();
  last_steps_ = 0;
  speed_ = Speed();
  stride_ = Stride();
  dcm_error_ = Point();
  dcm_means_ = {};
  lean_ = lean_mean_ = {};
  arms_.reset();
  levels_ = {};
  heading_error_ = Angle();
  support_ = pushed_to.value_or(Side::kLeft);
  stance_ = Stance();
  stance_.soles[swing_side()].p.y = support_ == Side::kLeft ? -gait_.step_width : gait_.step_width;
  com_ = PendulumState::at_rest(middle());
  history_.fill({.dcm = com_.dcm, .support = support_, .tick = 0});
  body_.begin_in_parts();
  body_.set_upper_body(gait_.follows_upper_body ? targets : std::span<const Angle>());
  blend_ticks_left_ = 0;
  enter(Phase::kPreparing);
  if (!body_.is_complete()) return;
  stand_on_both(middle());
  begin_weight_shift();
}

WalkParameters Walker::wanted() const {
  WalkParameters wanted = *parameters_;
  const std::int16_t time_ms = wanted.reaction.pushed_step_time_ms;
  if (pushed_ && time_ms > 0) wanted.step.time_ms = time_ms;
  return wanted;
}

void Walker::use(const WalkParameters& parameters) {
  in_force_ = parameters;
  gait_ = Gait(parameters);
  // Legs without hip yaw cannot turn the robot back to its heading.
  if (!robot::can_turn(model_)) gait_.heading_hold = Ratio();
  pendulum_ = Pendulum(gait_.carriage.com_height);
  landing_on_ = landing_for(gait_, pendulum_);
  footsteps_ = landing_on_.footsteps;
}

Walker::Landing Walker::landing_for(const Gait& gait, const Pendulum& pendulum) {
  return {.footsteps = Footsteps(gait.step_width - gait.zmp_inward * 2,
                                 pendulum.growth(static_cast<std::size_t>(gait.step_ticks)),
                                 pendulum.lag(gait.double_ticks)),
          .zmp_forward = gait.zmp_forward,
          .zmp_inward = gait.zmp_inward};
}

// The foot that is about to swing already lands where the next step needs it by the new parameters. Landing
// by the old ones, and then staying twice as long in double support, widened the next step by 60 mm, and the
// robot fell.
void Walker::look_for_changes() {
  const WalkParameters wanted = this->wanted();
  if (wanted == in_force_ || !is_gait(wanted)) return;
  changes_ = wanted;
  const Gait gait(*changes_);
  landing_on_ = landing_for(gait, Pendulum(gait.carriage.com_height));
}

// The means of the DCM error stay: they follow in ten steps.
void Walker::use_changes() {
  if (!changes_) return;
  use(*changes_);
  changes_.reset();
  carriage_ticks_left_ = kCarriageTicks;
  if (!gait_.follows_upper_body) body_.set_upper_body({});
}

// Goes the same way in each cycle, and arrives exactly.
void Walker::carry() {
  if (carriage_ticks_left_ == 0) return;
  const Ratio step = fixed::elapsed_fraction(1, carriage_ticks_left_);
  --carriage_ticks_left_;
  const Carriage& wanted = gait_.carriage;
  const auto approach = [step](auto& value, auto to) { value = fixed::interpolate(value, to, step); };
  approach(carriage_.com_height, wanted.com_height);
  approach(carriage_.pitch, wanted.pitch);
  approach(carriage_.pitch_at_1_m_per_s, wanted.pitch_at_1_m_per_s);
  approach(carriage_.compliance.pitch, wanted.compliance.pitch);
  approach(carriage_.compliance.roll, wanted.compliance.roll);
  approach(carriage_.arm_swing, wanted.arm_swing);
  if (carriage_ticks_left_ == 0) carriage_ = wanted;
}

// The plan begins at once: what the standing pose differs from it fades away meanwhile.
void Walker::begin_weight_shift() {
  for (std::size_t joint = 0; joint < model_.joint_count; ++joint)
    standing_offsets_[joint] = standing_targets_[joint] - targets_[joint];
  targets_ = standing_targets_;
  blend_ticks_left_ = kBlendTicks;
  enter(Phase::kWeightShift);
}

void Walker::enter(Phase phase) {
  phase_ = phase;
  tick_ = 0;
}

void Walker::advance(const Velocity& command, const Observation& seen) {
  ++tick_;
  carry();
  error_percent_.reset();
  observe(seen);
  if (gait_.follows_upper_body && running())
    body_.set_upper_body(seen.angles.empty() ? std::span<const Angle>(targets_) : seen.angles);
  switch (phase_) {
    case Phase::kIdle:
      return;
    case Phase::kPreparing:
      return run_preparing();
    case Phase::kWeightShift:
      run_weight_shift();
      return judge_error();
    case Phase::kStepping:
      run_stepping(stopping_ ? Velocity() : command, seen);
      return judge_error();
    case Phase::kClosingStep:
      return run_closing_step();
    case Phase::kSettling:
      return run_settling();
  }
}

void Walker::run_preparing() {
  stand_on_both(middle());
  if (body_.is_complete()) return begin_weight_shift();
  targets_ = standing_targets_;
}

// Double support with the ZMP under the foot that swings first. The DCM moves away from that ZMP, towards the
// other foot, until it is at the offset from that foot with which a step begins (Footsteps::offset). The ZMP
// of the last cycle is placed so that the DCM arrives exactly there, because the first step multiplies any
// overshoot by its growth. After the time-out the first step begins from wherever the DCM is.
void Walker::run_weight_shift() {
  const Point foot = zmp_under(swing_side());
  const Length step_begins_y = zmp_under(support_).y + footsteps_.offset(support_, stride_).y;
  const PendulumState before = com_;
  Point zmp = foot;
  pendulum_.advance(com_, zmp);
  const bool left = support_ == Side::kLeft;
  const bool arrived = left ? com_.dcm.y >= step_begins_y : com_.dcm.y <= step_begins_y;
  if (arrived) {
    const Ratio share = std::clamp(
        fixed::quotient<Ratio>(step_begins_y - before.dcm.y, com_.dcm.y - before.dcm.y), Ratio(), kOne);
    zmp = interpolated(before.dcm, foot, share);
    com_ = before;
    pendulum_.advance(com_, zmp);
  }
  stand_on_both(zmp);
  remember();
  if (!arrived && tick_ < kMaxShiftTicks) return;
  last_zmp_ = foot;
  liftoff_ = landing_ = stance_.soles[swing_side()];
  look_for_changes();
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
    swing_phase_ = fixed::elapsed_fraction(tick_ - gait_.double_ticks, gait_.step_ticks - gait_.double_ticks);
    plan_landing();
    move_swing_foot();
  }
  stance_.pitch = speed_.lean(carriage_);
  stance_.yaw = stance_.soles[swing_side()].yaw / 2;
  pose();
  remember();
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
  remember();
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

// The measurement is older than the plan of this cycle by what sensors, estimation and servos take, and is
// compared with the plan of its own moment, relative to the foot that bore the robot then. So the estimate
// goes over to a new support foot when the plan of its moment does, by measured kinematics: relative to the
// planned foothold, a landing 7 mm off was an apparent error of 20 to 26 mm for 70 ms.
//
//   mean(side, tick) += (measured - planned - mean) / 10
//   error = (1 - smoothing) (measured - planned - mean) + smoothing * last error
//
// A sloping floor, sagging servos and errors of the model cause a lasting error, the mean. It is subtracted,
// because a robot that stepped towards it would never stop walking that way.
void Walker::observe(const Observation& seen) {
  lean_ = {.roll = seen.roll, .pitch = seen.pitch - stance_.pitch};
  lean_mean_ = {.roll = fixed::interpolate(lean_mean_.roll, lean_.roll, kLeanMeanShare),
                .pitch = fixed::interpolate(lean_mean_.pitch, lean_.pitch, kLeanMeanShare)};
  if (seen.dcm && reference() == seen.dcm->sole) compare(*seen.dcm);
  heading_error_ += seen.turn;
}

std::optional<MeasuredDcm> Walker::expected_dcm() const {
  if (!running() || gait_.plan_age_ticks == 0) return std::nullopt;
  const Planned& then = compared_plan();
  return MeasuredDcm{.p = then.dcm, .sole = then.support};
}

const Walker::Planned& Walker::compared_plan() const {
  const auto age = static_cast<std::size_t>(gait_.plan_age_ticks - 1);
  return history_[(newest_ + history_.size() - age) % history_.size()];
}

void Walker::compare(const MeasuredDcm& measured) {
  const Planned& then = compared_plan();
  const auto bounded = [](Point p, Length most) {
    return Point{std::clamp(p.x, -most, most), std::clamp(p.y, -most, most)};
  };
  Point& mean = dcm_means_[then.tick][then.support];
  const Point error = measured.p - then.dcm - mean;
  if (then.tick != 0) {
    const Point counted = bounded(error, kMaxInMean);
    mean = interpolated(mean, mean + counted, kMeanShare);
  }
  dcm_error_ = interpolated(bounded(error, kMaxDcmError), dcm_error_, gait_.smoothing);
}

void Walker::remember() {
  newest_ = (newest_ + 1) % history_.size();
  history_[newest_] = {.dcm = com_.dcm,
                       .support = support_,
                       .tick = static_cast<std::uint8_t>(phase_ == Phase::kStepping ? tick_ : 0)};
}

Point Walker::captured() const {
  return {product<Length>(fixed::dead_band(dcm_error_.x, gait_.dead_band), gait_.capture_forward),
          product<Length>(fixed::dead_band(dcm_error_.y, gait_.dead_band), gait_.capture_lateral)};
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
  if (stride_.distance.x < Length())
    stride_.distance.x += product<Length>(stride_.distance.x, gait_.lengthening);
  stride_.distance.y += product<Length>(stride_.distance.y, gait_.lengthening);
  // The last steps, after which the feet stand side by side, neither turn nor go ahead.
  if (!stopping_ || !speed_.is_zero()) {
    const Angle error = std::clamp(heading_error_, -kMaxHeadingError, kMaxHeadingError);
    stride_.turn -= product<Angle>(error, gait_.heading_hold);
    stride_.distance.x += gait_.forward_offset;
  }
  if (const auto max_turn = body_.max_turn()) stride_.turn = std::clamp(stride_.turn, -*max_turn, *max_turn);
  const Foothold nominal = footsteps_.step(swing, stride_);
  const Gain growth = pendulum_.growth(static_cast<std::size_t>(gait_.step_ticks - tick_));
  const Point end = scaled(com_.dcm + captured() - stance_.zmp, growth);
  const Point zmp = stance_.zmp + scaled(end, landing_on_.footsteps.widening()) -
                    turned(landing_on_.footsteps.offset_at_once(swing, stride_), nominal.yaw / 2);
  const bool left = swing == Side::kLeft;
  const Point under{landing_on_.zmp_forward, left ? -landing_on_.zmp_inward : landing_on_.zmp_inward};
  const Point sole = zmp - turned(under, nominal.yaw);
  const Length lateral = std::clamp(left ? sole.y : -sole.y, gait_.min_lateral, gait_.max_lateral);
  landing_ = {.p = {std::clamp(sole.x, -gait_.max_forward, gait_.max_forward), left ? lateral : -lateral},
              .yaw = nominal.yaw};
}

// An error e grows to G(t) e until the swing foot lands in the time t. Moving that foothold by d takes d
// away, what is left grows by the G of a whole step until the next one, and so on. With reaches d and d'
// beyond the planned steps, in turn, the steps catch every error up to
//
//   (d + d' / G) / (1 - 1 / G^2) / G(t)
//
// Forward both reaches are the longest step less the stride. To one side, the foot that swings towards the
// error reaches the widest step, and the other one the narrowest. The ZMP within the sole catches more: a
// quarter of the CoM's height, which is half of the length of the default robot's sole.
void Walker::judge_error() {
  if (!reference()) return;
  // A push that the sole holds needs no step, and no divisions.
  if (fixed::abs(dcm_error_.x) <= gait_.dead_band && fixed::abs(dcm_error_.y) <= gait_.dead_band) {
    error_percent_ = 0;
    return;
  }
  const bool left = swing_side() == Side::kLeft;
  // A shift of weight is followed by a whole step.
  const std::int32_t done_ticks = phase_ == Phase::kStepping ? tick_ : 0;
  const auto left_ticks = static_cast<std::size_t>(std::max<std::int32_t>(gait_.step_ticks - done_ticks, 0));
  const Gain growth = pendulum_.growth(left_ticks);
  const Gain step_growth = pendulum_.growth(static_cast<std::size_t>(gait_.step_ticks));
  const auto share = [&](Length error, Length reach, Length next_reach) {
    const Length both = reach + fixed::quotient<Length>(next_reach, step_growth);
    const Gain series = fixed::product<Gain>(step_growth, step_growth);
    const Length sole = gait_.carriage.com_height / 4;
    const Length caught = fixed::quotient<Length>(product<Length>(both, series), series - 1.0_gain) + sole;
    const Length at_landing = product<Length>(fixed::abs(error), growth);
    return fixed::quotient<Gain>(at_landing, std::max(caught, sole));
  };
  const Length forward =
      gait_.max_forward - (dcm_error_.x > Length() ? stride_.distance.x : -stride_.distance.x);
  const Length wider = gait_.max_lateral - gait_.step_width - fixed::abs(stride_.distance.y);
  const Length narrower = gait_.step_width - gait_.min_lateral;
  const bool towards_swing = left == (dcm_error_.y > Length());
  const Gain x = share(dcm_error_.x, forward, forward);
  const Gain y = towards_swing ? share(dcm_error_.y, wider, narrower) : share(dcm_error_.y, narrower, wider);
  const std::int64_t percent_raw = std::int64_t{fixed::hypotenuse(x, y).raw()} * 100;
  error_percent_ = fixed::saturate<std::uint16_t>(fixed::shift_rounded(percent_raw, Gain::kFractionBits));
}

// Moves the sole of the swing foot from liftoff to landing. With the phase s from 0 to 1 and the swing
// profile c
//
//   progress = s - c sin(2 pi s) / (2 pi),  height = h (1 - cos(2 pi s)) / 2
//
// c = 1 is a cycloid, which leaves and meets the ground without speed; c = 0 is constant speed.
void Walker::move_swing_foot() {
  const Ratio phase = swing_phase_;
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
  return swing_phase_ > kMinTouchdownPhase && seen.loads[swing_side()] > gait_.touchdown_load;
}

// Makes the swing foot, where it is now, the support foot: all positions are moved into the frame of its
// sole. The next step begins there, or, when the robot is to stop and the feet are side by side, the closing
// step. A foot that touched down early is on the ground although its planned height was not zero yet.
//
// The foot landed where the plan and the part of the error that it takes up together want it. So the plan
// takes that part over, and the plans of the past with it: without this the next step would go back.
void Walker::end_step() {
  const Point taken_up = captured();
  com_.dcm = com_.dcm + taken_up;
  dcm_error_ = dcm_error_ - taken_up;
  for (Planned& planned : history_) planned.dcm = planned.dcm + taken_up;
  const Foothold landed = stance_.soles[swing_side()];
  const Foothold left_behind{.p = seen_from(landed, Point()), .yaw = -landed.yaw};
  stance_.soles[support_] = left_behind;
  stance_.soles[swing_side()] = Foothold();
  stance_.heights = {};
  swing_phase_ = Ratio();
  stance_.yaw -= landed.yaw;
  stance_.zmp = last_zmp_ = seen_from(landed, stance_.zmp);
  com_ = {seen_from(landed, com_.dcm), seen_from(landed, com_.ccm)};
  support_ = swing_side();
  liftoff_ = landing_ = left_behind;
  // A robot that is disturbed whenever it is about to stand makes do with feet that are less so.
  const bool stops = stopping_ && speed_.is_zero();
  last_steps_ = stops ? last_steps_ + 1 : 0;
  const std::int32_t patience = std::clamp<std::int32_t>(last_steps_ - kPatientSteps + 1, 1, kMostApart);
  const bool side_by_side = fixed::abs(left_behind.p.x) < kSideBySide * patience;
  use_changes();
  look_for_changes();
  enter(stops && side_by_side ? Phase::kClosingStep : Phase::kStepping);
}

std::optional<fixed::Angle> Walker::phase() const {
  if (phase_ != Phase::kStepping) return std::nullopt;
  const Ratio done = fixed::elapsed_fraction(tick_, gait_.step_ticks);
  static_assert(fixed::Angle::kFractionBits == Ratio::kFractionBits + 2);  // half a turn is one, twice
  const auto of_step = fixed::Angle::from_wide_raw(std::int64_t{done.raw()} * 2);
  return support_ == Side::kLeft ? of_step : of_step + fixed::kQuarterTurn + fixed::kQuarterTurn;
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
  stance_.pitch = speed_.lean(carriage_);
  stance_.yaw = stance_.soles[swing_side()].yaw / 2;
  pose();
}

void Walker::pose() {
  const Point com = com_.position();
  stance_.centre_of_mass = {com.x, com.y, carriage_.com_height};
  level_soles();
  // The ZMP under the robot moves towards the error, which pushes the centre of mass back; that of the plan
  // stays.
  const Point planned = stance_.zmp;
  stance_.zmp = planned + zmp_shift();
  body_.solve(stance_, carriage_.compliance, targets_);
  stance_.zmp = planned;
  arms_.react(fixed::dead_band(dcm_error_.x, gait_.dead_band), gait_.arm_reaction);
  arms_.pose(stance_.soles[0].p.x - stance_.soles[1].p.x, carriage_.arm_swing, standing_targets_, targets_);
  blend();
}

void Walker::blend() {
  if (blend_ticks_left_ == 0) return;
  --blend_ticks_left_;
  const Ratio share = fixed::elapsed_fraction(blend_ticks_left_, kBlendTicks);
  for (std::size_t joint = 0; joint < model_.joint_count; ++joint)
    targets_[joint] += product<Angle>(standing_offsets_[joint], share);
}

Point Walker::zmp_shift() const {
  const auto along = [](Length error, Ratio share, Length most) {
    return std::clamp(product<Length>(error, share), -most, most);
  };
  return {along(dcm_error_.x, gait_.zmp_tracking_forward, gait_.max_zmp_shift_forward),
          along(dcm_error_.y, gait_.zmp_tracking_lateral, gait_.max_zmp_shift_lateral)};
}

// A sole that is parallel to a leaning trunk would land on its edge.
void Walker::level_soles() {
  for (Ratio& level : levels_) level = std::max(level - gait_.level_fade, Ratio());
  if (swing_foot()) {
    const Ratio share = std::clamp((swing_phase_ - kLevelFrom) * kLevelSteepness, Ratio(), kOne);
    levels_[swing_side()] = product<Ratio>(gait_.level_swing, share);
  }
  const Tilt beyond{.roll = lean_.roll - lean_mean_.roll, .pitch = lean_.pitch - lean_mean_.pitch};
  for (std::size_t side = 0; side < levels_.size(); ++side)
    stance_.tilts[side] = {.roll = -product<Angle>(beyond.roll, levels_[side]),
                           .pitch = -product<Angle>(beyond.pitch, levels_[side])};
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
