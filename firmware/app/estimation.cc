// What the controller makes of its sensors in each cycle.

#include "firmware/app/controller.h"
#include "firmware/app/telemetry_units.h"
#include "firmware/fixed/saturating.h"

namespace koboshi::app {

void Controller::estimate() {
  const auto raw = inertial_.rates();
  if (rests(values_.behaviour.state)) {
    calibrate_gyro(raw);
  } else {
    gyro_bias_.interrupt();
  }
  rates_ = raw - gyro_bias_.bias();
}

void Controller::calibrate_gyro(const balance::InertialSensor::Rates& raw) {
  if (!gyro_bias_.observe(raw)) return;
  auto& diagnosis = values_.diagnosis;
  diagnosis.gyro_calibrations = fixed::add_saturated(diagnosis.gyro_calibrations, std::uint16_t{1});
  const auto& bias = gyro_bias_.bias();
  diagnosis.gyro_bias[0] = narrow(bias.x);
  diagnosis.gyro_bias[1] = narrow(bias.y);
  diagnosis.gyro_bias[2] = narrow(bias.z);
}

}  // namespace koboshi::app
