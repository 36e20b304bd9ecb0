#include "firmware/estimation/inertial.h"

#include "firmware/fixed/literals.h"
#include "firmware/fixed/rounding.h"

namespace koboshi::estimation {

using namespace fixed::literals;

namespace {

// A rate in turn/s over a sample of 1 ms, as an angle in rad.
constexpr fixed::Ratio kRadPerTurnAndSample = literal<fixed::Ratio>(kRadPerTurn / 1000.0L);

// Returns half of `sum` in units of Q. `full_scale` is the value of 2^15 counts; it is positive, so that the
// result fits.
template <fixed::AnyQuantity Q>
Q half(std::int32_t sum, Q full_scale) {
  return Q::from_raw(
      static_cast<std::int32_t>(fixed::shift_rounded(std::int64_t{full_scale.raw()} * sum, 16)));
}

// Returns the mean of two raw samples.
template <fixed::AnyQuantity Q>
robot::Vector<Q> mean(const std::array<std::int16_t, 3>& a, const std::array<std::int16_t, 3>& b,
                      Q full_scale) {
  return {half(a[0] + b[0], full_scale), half(a[1] + b[1], full_scale), half(a[2] + b[2], full_scale)};
}

template <typename Filters, typename Q>
robot::Vector<Q> settled(Filters& filters, const robot::Vector<Q>& value) {
  filters[0].reset(value.x);
  filters[1].reset(value.y);
  filters[2].reset(value.z);
  return value;
}

template <typename Filters, typename Q>
robot::Vector<Q> filtered(Filters& filters, const robot::Vector<Q>& value) {
  return {filters[0].filter(value.x), filters[1].filter(value.y), filters[2].filter(value.z)};
}

}  // namespace

InertialSensor::InertialSensor(const robot::RobotModel& model)
    : model_(model),
      rate_filters_{fixed::LowPass<fixed::AngularRate>(kInertialLowPass),
                    fixed::LowPass<fixed::AngularRate>(kInertialLowPass),
                    fixed::LowPass<fixed::AngularRate>(kInertialLowPass)},
      acceleration_filters_{fixed::LowPass<fixed::Acceleration>(kInertialLowPass),
                            fixed::LowPass<fixed::Acceleration>(kInertialLowPass),
                            fixed::LowPass<fixed::Acceleration>(kInertialLowPass)} {}

void InertialSensor::add(const hal::ImuSample& sample, std::uint64_t now_us) {
  for (std::size_t axis = 0; axis < 3; ++axis) gyro_sum_[axis] += sample.gyro_raw[axis];
  ++summed_;
  if (!last_us_) {
    settle(sample);
  } else if (waits_) {
    filter(waiting_, sample);
    waits_ = false;
  } else {
    waiting_ = sample;
    waits_ = true;
  }
  last_us_ = now_us;
}

void InertialSensor::settle(const hal::ImuSample& sample) {
  const auto& gyro = sample.gyro_raw;
  const auto& accelerometer = sample.accelerometer_raw;
  rates_I_ = settled(rate_filters_, mean(gyro, gyro, model_.scales.gyro));
  accelerations_I_ =
      settled(acceleration_filters_, mean(accelerometer, accelerometer, model_.scales.accelerometer));
}

void InertialSensor::filter(const hal::ImuSample& a, const hal::ImuSample& b) {
  rates_I_ = filtered(rate_filters_, mean(a.gyro_raw, b.gyro_raw, model_.scales.gyro));
  accelerations_I_ = filtered(acceleration_filters_,
                              mean(a.accelerometer_raw, b.accelerometer_raw, model_.scales.accelerometer));
}

robot::Vector<fixed::Ratio> InertialSensor::take_turn(const Rates& bias) {
  const auto sum = [&](std::int32_t counts) {
    return fixed::AngularRate::from_wide_raw(
        fixed::shift_rounded(std::int64_t{model_.scales.gyro.raw()} * counts, 15));
  };
  const Rates sums = model_.R_BI * Rates{sum(gyro_sum_[0]), sum(gyro_sum_[1]), sum(gyro_sum_[2])};
  const auto turn = [&](fixed::AngularRate shown, fixed::AngularRate offset) {
    return fixed::product<fixed::Ratio>(shown - offset * summed_, kRadPerTurnAndSample);
  };
  const robot::Vector<fixed::Ratio> turn_B_rad{turn(sums.x, bias.x), turn(sums.y, bias.y),
                                               turn(sums.z, bias.z)};
  gyro_sum_ = {};
  summed_ = 0;
  return turn_B_rad;
}

}  // namespace koboshi::estimation
