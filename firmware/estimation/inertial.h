#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "firmware/fixed/biquad.h"
#include "firmware/robot/model.h"
#include "hal/port/imu.h"

namespace koboshi::estimation {

// The second-order low-pass of the paper's section 2.6 for both gyro and inclination sensor: 20 Hz at the 500
// Hz of the means of two samples, which cost half of what all samples would. design_low_pass(20, 500), which
// a test holds it to.
inline constexpr fixed::BiquadCoefficients kInertialLowPass{
    .b0 = fixed::Ratio::from_raw(14344332),
    .b1 = fixed::Ratio::from_raw(28688664),
    .b2 = fixed::Ratio::from_raw(14344332),
    .a1 = fixed::Ratio::from_raw(-1768946684),
    .a2 = fixed::Ratio::from_raw(752582188),
};

// Gyro and inclination sensor: from raw samples to filtered quantities in the axes of the trunk B.
class InertialSensor {
 public:
  using Rates = robot::Vector<fixed::AngularRate>;
  using Accelerations = robot::Vector<fixed::Acceleration>;

  // The model must outlive the sensor.
  explicit InertialSensor(const robot::RobotModel& model);

  // Takes the next of the samples, which come at 1 kHz. The first settles the filters; later ones are seen
  // two at a time.
  void add(const hal::ImuSample& sample, std::uint64_t now_us);

  // When the last sample came.
  std::optional<std::uint64_t> last_us() const { return last_us_; }
  Rates rates() const { return model_.R_BI * rates_I_; }
  // Specific force: one g upwards at rest.
  Accelerations accelerations() const { return model_.R_BI * accelerations_I_; }
  // The rotation vector of the trunk since the last call, in rad and axes of B: the sum of the samples, each
  // of which stands for a millisecond, without the filter and its delay, less the gyro's bias.
  robot::Vector<fixed::Ratio> take_turn(const Rates& bias);

 private:
  template <typename Q>
  using Filters = std::array<fixed::LowPass<Q>, 3>;

  void settle(const hal::ImuSample& sample);
  void filter(const hal::ImuSample& a, const hal::ImuSample& b);

  const robot::RobotModel& model_;
  Filters<fixed::AngularRate> rate_filters_;
  Filters<fixed::Acceleration> acceleration_filters_;
  Rates rates_I_{};  // in the inertial unit's axes: turned into those of B only when somebody asks
  Accelerations accelerations_I_{};
  hal::ImuSample waiting_;  // for the other of its pair
  bool waits_ = false;
  std::array<std::int32_t, 3> gyro_sum_{};  // counts
  std::int32_t summed_ = 0;                 // samples
  std::optional<std::uint64_t> last_us_;
};

}  // namespace koboshi::estimation
