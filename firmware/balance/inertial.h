#pragma once

#include <array>
#include <cstdint>

#include "firmware/fixed/biquad.h"
#include "firmware/robot/model.h"
#include "hal/port/imu.h"

namespace koboshi::balance {

// The second-order low-pass of the paper's section 2.6 for both gyro and inclination sensor: 20 Hz at the 1
// kHz of the inertial unit. design_low_pass(20, 1000), which a test holds it to.
inline constexpr fixed::BiquadCoefficients kInertialLowPass{
    .b0 = fixed::Ratio::from_raw(3888751),
    .b1 = fixed::Ratio::from_raw(7777502),
    .b2 = fixed::Ratio::from_raw(3888751),
    .a1 = fixed::Ratio::from_raw(-1957103773),
    .a2 = fixed::Ratio::from_raw(898916953),
};

// Gyro and inclination sensor: from raw samples to filtered quantities in the axes of the trunk B.
class InertialSensor {
 public:
  using Rates = robot::Vector<fixed::AngularRate>;
  using Accelerations = robot::Vector<fixed::Acceleration>;

  // The model must outlive the sensor.
  explicit InertialSensor(const robot::RobotModel& model);

  // Takes the next of the samples, which come at 1 kHz. The first settles the filters.
  void add(const hal::ImuSample& sample, std::uint64_t now_us);

  // A sample came within the last `timeout_us`.
  bool alive(std::uint64_t now_us, std::uint32_t timeout_us) const {
    return seen_ && now_us - last_us_ <= timeout_us;
  }
  Rates rates() const { return model_.R_BI * rates_I_; }
  // Specific force: one g upwards at rest.
  Accelerations accelerations() const { return model_.R_BI * accelerations_I_; }
  // The rotation vector of the trunk since the last call, in rad and axes of B: the sum of the samples, each
  // of which stands for a millisecond, without the filter and its delay, less the gyro's bias.
  robot::Vector<fixed::Ratio> take_turn(const Rates& bias);

 private:
  template <typename Q>
  using Filters = std::array<fixed::LowPass<Q>, 3>;

  const robot::RobotModel& model_;
  Filters<fixed::AngularRate> rate_filters_;
  Filters<fixed::Acceleration> acceleration_filters_;
  Rates rates_I_{};  // in the inertial unit's axes: turned into those of B only when somebody asks
  Accelerations accelerations_I_{};
  std::array<std::int32_t, 3> gyro_sum_{};  // counts
  std::int32_t summed_ = 0;                 // samples
  std::uint64_t last_us_ = 0;
  bool seen_ = false;
};

}  // namespace koboshi::balance
