#include "firmware/balance/inertial.h"

#include "firmware/fixed/rounding.h"
#include "firmware/fixed/trigonometry.h"

namespace koboshi::balance {
namespace {

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
  last_us_ = now_us;
  seen_ = true;
}

fixed::Angle InertialSensor::roll() const {
  const Accelerations a = accelerations();
  return fixed::atan2(a.y, a.z);
}

fixed::Angle InertialSensor::pitch() const {
  const Accelerations a = accelerations();
  return fixed::atan2(-a.x, fixed::hypotenuse(a.y, a.z));
}

}  // namespace koboshi::balance
