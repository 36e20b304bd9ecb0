#include "firmware/balance/inertial.h"

#include "firmware/fixed/literals.h"
#include "firmware/fixed/rounding.h"

namespace koboshi::balance {

using namespace fixed::literals;

namespace {

constexpr fixed::Ratio kRadPerTurnAndSample = 0.00628318530718_ratio;  // 2 pi / 1000

// A raw sample in units of Q: `full_scale` is what 2^15 counts mean.
template <fixed::AnyQuantity Q>
robot::Vector<Q> scaled(const std::array<std::int16_t, 3>& raw, Q full_scale) {
  const auto value = [&](std::int16_t counts) {  // fits, because a full scale is positive
    const std::int64_t value_raw = fixed::shift_rounded(std::int64_t{full_scale.raw()} * counts, 15);
    return Q::from_raw(static_cast<std::int32_t>(value_raw));
  };
  return {value(raw[0]), value(raw[1]), value(raw[2])};
}

template <typename Filters, typename Q>
robot::Vector<Q> filtered(Filters& filters, const robot::Vector<Q>& sample, bool first) {
  if (first) {
    filters[0].reset(sample.x);
    filters[1].reset(sample.y);
    filters[2].reset(sample.z);
  }
  return {filters[0].filter(sample.x), filters[1].filter(sample.y), filters[2].filter(sample.z)};
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
  rates_I_ = filtered(rate_filters_, scaled(sample.gyro_raw, model_.scales.gyro), !seen_);
  accelerations_I_ =
      filtered(acceleration_filters_, scaled(sample.accelerometer_raw, model_.scales.accelerometer), !seen_);
  for (std::size_t axis = 0; axis < 3; ++axis) gyro_sum_[axis] += sample.gyro_raw[axis];
  ++summed_;
  last_us_ = now_us;
  seen_ = true;
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

}  // namespace koboshi::balance
