#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "firmware/fixed/biquad.h"
#include "firmware/robot/model.h"
#include "hal/port/imu.h"

namespace koboshi::estimation {

// The second-order low-pass of the paper's section 2.6, for gyro and accelerometer: 20 Hz at a sample rate of
// 500 Hz. It filters the means of two samples, at half the cost of filtering each. The coefficients are
// fixed::design_low_pass(20, 500); a test compares them.
inline constexpr fixed::BiquadCoefficients kInertialLowPass{
    .b0 = fixed::Ratio::from_raw(14344332),
    .b1 = fixed::Ratio::from_raw(28688664),
    .b2 = fixed::Ratio::from_raw(14344332),
    .a1 = fixed::Ratio::from_raw(-1768946684),
    .a2 = fixed::Ratio::from_raw(752582188),
};

// Converts the samples of the inertial unit I to filtered rates and specific forces in axes of the link that
// carries it, which at joint zero are those of the trunk B; InertialLink converts them further where that
// link is not the trunk.
class InertialSensor {
 public:
  using Rates = robot::Vector<fixed::AngularRate>;
  using Accelerations = robot::Vector<fixed::Acceleration>;

  // The model must outlive the sensor.
  explicit InertialSensor(const robot::RobotModel& model);

  // Takes the next sample, at 1 kHz. The first one settles the filters; later ones are filtered in pairs.
  void add(const hal::ImuSample& sample, std::uint64_t now_us);

  // Returns the time of the last sample, nothing before the first.
  std::optional<std::uint64_t> last_us() const { return last_us_; }
  // Returns the filtered rates in axes of B, bias included.
  Rates rates() const { return model_.R_BI * rates_I_; }
  // Returns the filtered specific force in axes of B: one g upwards at rest.
  Accelerations accelerations() const { return model_.R_BI * accelerations_I_; }
  // Returns the rotation vector of the trunk since the last call, in rad and axes of B: the sum of the
  // unfiltered samples, less the bias, times 1 ms. It has no filter and thus no delay.
  robot::Vector<fixed::Ratio> take_turn(const Rates& bias);

 private:
  template <typename Q>
  using Filters = std::array<fixed::LowPass<Q>, 3>;

  void settle(const hal::ImuSample& sample);
  void filter(const hal::ImuSample& a, const hal::ImuSample& b);

  const robot::RobotModel& model_;
  Filters<fixed::AngularRate> rate_filters_;
  Filters<fixed::Acceleration> acceleration_filters_;
  Rates rates_I_{};  // in axes of I; turned to B on request only, once a cycle instead of once a sample
  Accelerations accelerations_I_{};
  hal::ImuSample waiting_;  // for the other of its pair
  bool waits_ = false;
  std::array<std::int32_t, 3> gyro_sum_{};  // counts
  std::int32_t summed_ = 0;                 // samples
  std::optional<std::uint64_t> last_us_;
};

}  // namespace koboshi::estimation
