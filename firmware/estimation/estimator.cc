#include "firmware/estimation/estimator.h"

#include <algorithm>

#include "firmware/estimation/level_axes.h"
#include "firmware/estimation/posture.h"
#include "firmware/fixed/gravity.h"
#include "firmware/fixed/interpolation.h"
#include "firmware/fixed/literals.h"
#include "firmware/fixed/radians.h"
#include "firmware/fixed/saturating.h"
#include "firmware/robot/kinematics.h"
#include "hal/port/period.h"

namespace koboshi::estimation {

using namespace fixed::literals;

namespace {

std::uint32_t age_us(std::uint64_t now_us, std::uint64_t then_us) {
  return static_cast<std::uint32_t>(std::min<std::uint64_t>(now_us - then_us, RobotState::kNever));
}

constexpr fixed::Ratio kRadPerTurnAndCycle =
    literal<fixed::Ratio>(kRadPerTurn * hal::kControlPeriod_us / 1'000'000.0L);

// Returns the rotation vector in a cycle at these rates, in rad.
robot::Vector<fixed::Ratio> turn_in_cycle(const robot::Vector<fixed::AngularRate>& rates) {
  const auto turn = [](fixed::AngularRate rate) {
    return fixed::product<fixed::Ratio>(rate, kRadPerTurnAndCycle);
  };
  return {turn(rates.x), turn(rates.y), turn(rates.z)};
}

robot::Direction middle(const robot::Direction& a, const robot::Direction& b) {
  return {fixed::interpolate(a.x, b.x, 0.5_ratio), fixed::interpolate(a.y, b.y, 0.5_ratio),
          fixed::interpolate(a.z, b.z, 0.5_ratio)};
}

}  // namespace

Estimator::Estimator(const robot::RobotModel& model)
    : model_(model),
      inertial_(model),
      inertial_link_(model),
      foot_sensors_{FootSensor(model, hal::Side::kLeft), FootSensor(model, hal::Side::kRight)},
      torque_contact_(model),
      weight_(fixed::product<fixed::Force>(robot::total_mass(model), fixed::kGravity)),
      contacts_{ContactWatch(weight_ / FootSensor::kWeightPerMinLoad),
                ContactWatch(weight_ / FootSensor::kWeightPerMinLoad)} {
  state_.measures_loads = model.measures_loads();
  for (std::size_t foot = 0; foot < wrenches_.size() && !state_.measures_loads; ++foot)
    wrenches_[foot].fill(FootSensor::kNoCount);
}

void Estimator::add(hal::Side side, const hal::AnkleSample& sample, std::uint64_t now_us) {
  wrenches_[side] = foot_sensors_[side].wrench(sample);
  switches_[side] = sample.force_raw[2] != 0;
  ankle_us_[side] = now_us;
}

const RobotState& Estimator::update(std::span<const fixed::Angle> angles, bool rests, std::uint64_t now_us,
                                    const LegEvidence& legs) {
  calibration_ = Calibration::kNone;
  update_gyro_bias(inertial_.rates(), rests);
  const robot::Direction last_up_B = state_.up_B;
  robot::Vector<fixed::Ratio> turn_B = update_attitude(rests);
  if (!inertial_link_.is_trunk()) turn_B = convert_to_trunk(angles);
  state_.turn = heading_change(turn_B, middle(last_up_B, state_.up_B));
  update_balance(angles, rests, legs);
  update_ages(now_us);
  update_contacts();
  return state_;
}

void Estimator::assume_gyro_bias(const Rates& bias_B) {
  gyro_bias_.assume(bias_B);
  bias_assumed_ = bias_B != Rates{};
}

void Estimator::begin_calibration() {
  gyro_bias_.interrupt();
  calibrating_ = true;
}

void Estimator::update_gyro_bias(const Rates& raw_B, bool rests) {
  bool moved = false;
  if (!rests) {
    gyro_bias_.interrupt();
    moved = true;
  } else if (gyro_bias_.observe(raw_B)) {
    gyro_calibrations_ = fixed::add_saturated(gyro_calibrations_, std::uint16_t{1});
    if (calibrating_) calibration_ = Calibration::kDone;
    calibrating_ = false;
  } else {
    moved = gyro_bias_.interrupted();
  }
  if (moved && calibrating_) {
    calibration_ = Calibration::kMoved;
    calibrating_ = false;
  }
  state_.rates_B = raw_B - gyro_bias_.bias();
  state_.gyro_known = gyro_calibrations_ != 0 || bias_assumed_;
}

robot::Vector<fixed::Ratio> Estimator::update_attitude(bool rests) {
  using enum AttitudeEstimator::Condition;
  state_.accelerations_B = inertial_.accelerations();
  const robot::Vector<fixed::Ratio> turn_B = inertial_.take_turn(gyro_bias_.bias());
  attitude_.update(turn_B, state_.accelerations_B, rests ? kResting : kMoving);
  state_.up_B = attitude_.up_B();
  state_.roll = attitude_.roll();
  state_.pitch = attitude_.pitch();
  return turn_B;
}

robot::Vector<fixed::Ratio> Estimator::convert_to_trunk(std::span<const fixed::Angle> angles) {
  inertial_link_.update(angles);
  const robot::Rotation& R_BL = inertial_link_.R_BL();
  state_.rates_B = R_BL * state_.rates_B - inertial_link_.w_BL_B();
  state_.accelerations_B = R_BL * state_.accelerations_B;
  state_.up_B = R_BL * state_.up_B;
  state_.roll = roll_of(state_.up_B);
  state_.pitch = pitch_of(state_.up_B);
  return turn_in_cycle(state_.rates_B);
}

void Estimator::update_balance(std::span<const fixed::Angle> angles, bool rests, const LegEvidence& legs) {
  const Posture posture = posture_at(model_, angles);
  update_feet(legs);
  state_.zmp = combine(state_.feet, posture);
  state_.centre_of_mass = posture.centre_of_mass(state_.zmp.frame);
  if (model_.joint_count == 0) return;
  const hal::Side foot = standing_foot(legs);
  const auto axes = level_axes(posture.X_BSole[foot].R, state_.up_B);
  state_.com = com_.update(posture, axes, state_.up_B, state_.accelerations_B, foot);
  const bool moves = !rests && !legs.stands_still && state_.gyro_known;
  state_.odometer = odometry_.update(posture, axes, state_.up_B, state_.turn, foot, !moves);
  if (legs.stands_still) state_.ground = ground_.update(posture, state_.up_B, state_.zmp);
}

void Estimator::update_contacts() {
  for (std::size_t foot = 0; foot < contacts_.size(); ++foot)
    state_.contacts[foot] = contacts_[foot].update(state_.feet[foot], state_.ankle_age_us[foot]);
}

// Outside of a walk it stays the same as long as it bears anything.
hal::Side Estimator::standing_foot(const LegEvidence& legs) const {
  if (legs.reference) return *legs.reference;
  const hal::Side last = state_.com.sole;
  return !state_.feet[last].contact && state_.feet[other(last)].contact ? other(last) : last;
}

void Estimator::update_feet(const LegEvidence& legs) {
  switch (model_.ankle_kind) {
    case hal::AnkleKind::kSixAxis:
    case hal::AnkleKind::kPressureCells:
      for (std::size_t foot = 0; foot < foot_sensors_.size(); ++foot)
        state_.feet[foot] = foot_sensors_[foot].pressure(wrenches_[foot]);
      return;
    case hal::AnkleKind::kContactSwitch:
      state_.feet = pressures_of(switches_, weight_);
      return;
    case hal::AnkleKind::kNone:
      state_.feet = pressures_of(torque_contact_.update(legs), weight_);
      return;
  }
}

void Estimator::update_ages(std::uint64_t now_us) {
  const auto inertial_us = inertial_.last_us();
  state_.inertial_age_us = inertial_us ? age_us(now_us, *inertial_us) : RobotState::kNever;
  const bool has_sensors = model_.ankle_kind != hal::AnkleKind::kNone;
  for (std::size_t foot = 0; foot < ankle_us_.size(); ++foot)
    state_.ankle_age_us[foot] = !has_sensors      ? 0
                                : ankle_us_[foot] ? age_us(now_us, *ankle_us_[foot])
                                                  : RobotState::kNever;
}

}  // namespace koboshi::estimation
