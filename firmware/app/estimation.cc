// What the controller makes of its sensors in each cycle.

#include "firmware/app/controller.h"
#include "firmware/app/telemetry_units.h"
#include "firmware/fixed/saturating.h"

namespace koboshi::app {

void Controller::estimate() {
  estimate_attitude();
  estimate_balance();
}

void Controller::estimate_attitude() {
  const bool resting = rests(values_.behaviour.state);
  const auto raw = inertial_.rates();
  if (resting) {
    calibrate_gyro(raw);
  } else {
    gyro_bias_.interrupt();
    give_up_calibration();
  }
  rates_ = raw - gyro_bias_.bias();
  accelerations_ = inertial_.accelerations();
  using enum balance::AttitudeEstimator::Condition;
  attitude_.update(inertial_.take_turn(gyro_bias_.bias()), accelerations_, resting ? kResting : kMoving);
}

void Controller::calibrate_gyro(const balance::InertialSensor::Rates& raw) {
  if (!gyro_bias_.observe(raw)) {
    if (gyro_bias_.interrupted()) give_up_calibration();
    return;
  }
  auto& diagnosis = values_.diagnosis;
  diagnosis.gyro_calibrations = fixed::add_saturated(diagnosis.gyro_calibrations, std::uint16_t{1});
  const auto& bias = gyro_bias_.bias();
  diagnosis.gyro_bias[0] = narrow(bias.x);
  diagnosis.gyro_bias[1] = narrow(bias.y);
  diagnosis.gyro_bias[2] = narrow(bias.z);
  if (calibrating_) {
    values_.calibration.gyro_bias[0] = bias.x.raw();
    values_.calibration.gyro_bias[1] = bias.y.raw();
    values_.calibration.gyro_bias[2] = bias.z.raw();
  }
  calibrating_ = false;
}

void Controller::give_up_calibration() {
  if (calibrating_) values_.behaviour.refusal = Reason::kNotAtRest;
  calibrating_ = false;
}

void Controller::estimate_balance() {
  Angles angles{};
  for (std::size_t joint = 0; joint < model_.joint_count; ++joint) angles[joint] = drives_.angle(joint);
  const balance::Posture posture = balance::posture_at(model_, angles);

  auto& shown = values_.balance;
  std::array<balance::FootPressure, 2> feet;
  for (std::size_t side = 0; side < feet.size(); ++side) {
    feet[side] = foot_sensors_[side].pressure(values_.ankles[side]);
    foot_loads_[side] = feet[side].load;
    shown.foot_zmp[side][0] = narrow(feet[side].x);
    shown.foot_zmp[side][1] = narrow(feet[side].y);
  }
  const balance::Pressure both = balance::combine(feet, posture);
  shown.zmp[0] = narrow(both.x);
  shown.zmp[1] = narrow(both.y);
  const robot::Position com = posture.centre_of_mass(both.frame);
  shown.com[0] = narrow(com.x);
  shown.com[1] = narrow(com.y);
  shown.com[2] = narrow(com.z);
  shown.flags = static_cast<std::uint8_t>(
      (feet[0].valid ? kLeftZmpValid : 0) | (feet[1].valid ? kRightZmpValid : 0) |
      (both.valid ? kZmpValid : 0) | (both.frame == hal::Side::kRight ? kFrameIsRight : 0));
}

}  // namespace koboshi::app
