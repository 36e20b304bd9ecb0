#include "firmware/estimation/estimator.h"

#include <algorithm>

#include "firmware/estimation/posture.h"
#include "firmware/fixed/saturating.h"

namespace koboshi::estimation {
namespace {

std::uint32_t age_us(std::uint64_t now_us, std::uint64_t then_us) {
  return static_cast<std::uint32_t>(std::min<std::uint64_t>(now_us - then_us, RobotState::kNever));
}

}  // namespace

Estimator::Estimator(const robot::RobotModel& model)
    : model_(model),
      inertial_(model),
      foot_sensors_{FootSensor(model, hal::Side::kLeft), FootSensor(model, hal::Side::kRight)} {}

void Estimator::add(hal::Side side, const hal::AnkleSample& sample, std::uint64_t now_us) {
  std::ranges::copy(sample.force_raw, wrenches_[side].begin());
  std::ranges::copy(sample.torque_raw, wrenches_[side].begin() + 3);
  ankle_us_[side] = now_us;
}

const RobotState& Estimator::update(std::span<const fixed::Angle> angles, bool rests, std::uint64_t now_us) {
  calibration_ = Calibration::kNone;
  update_gyro_bias(inertial_.rates(), rests);
  update_attitude(rests);
  update_balance(angles);
  update_ages(now_us);
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

void Estimator::update_attitude(bool rests) {
  using enum AttitudeEstimator::Condition;
  state_.accelerations_B = inertial_.accelerations();
  attitude_.update(inertial_.take_turn(gyro_bias_.bias()), state_.accelerations_B,
                   rests ? kResting : kMoving);
  state_.up_B = attitude_.up_B();
  state_.roll = attitude_.roll();
  state_.pitch = attitude_.pitch();
}

void Estimator::update_balance(std::span<const fixed::Angle> angles) {
  const Posture posture = posture_at(model_, angles);
  for (std::size_t foot = 0; foot < foot_sensors_.size(); ++foot)
    state_.feet[foot] = foot_sensors_[foot].pressure(wrenches_[foot]);
  state_.zmp = combine(state_.feet, posture);
  state_.centre_of_mass = posture.centre_of_mass(state_.zmp.frame);
}

void Estimator::update_ages(std::uint64_t now_us) {
  const auto inertial_us = inertial_.last_us();
  state_.inertial_age_us = inertial_us ? age_us(now_us, *inertial_us) : RobotState::kNever;
  for (std::size_t foot = 0; foot < ankle_us_.size(); ++foot)
    state_.ankle_age_us[foot] = ankle_us_[foot] ? age_us(now_us, *ankle_us_[foot]) : RobotState::kNever;
}

}  // namespace koboshi::estimation
