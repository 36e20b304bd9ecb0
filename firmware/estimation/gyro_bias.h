#pragma once

#include <array>
#include <cstdint>

#include "firmware/fixed/literals.h"
#include "firmware/robot/geometry.h"

namespace koboshi::estimation {

// The rate that a gyro shows at rest, up to 20 deg/s before calibration. Measured while the robot is known to
// make no torque: the mean over a second in which no axis moves by more than kMaxSpread. A second with more
// is thrown away, so that a robot that is being carried keeps what it knew before.
class GyroBias {
 public:
  using Rates = robot::Vector<fixed::AngularRate>;

  static constexpr std::int32_t kSamples = 100;  // at 100 Hz
  // Ten times what the noise of an MPU-6050, 0.005 deg/s/sqrt(Hz), spans in a second behind the 20 Hz
  // low-pass; a robot that somebody holds in his hands moves more.
  static constexpr auto kMaxSpread = fixed::literals::operator""_deg_per_s(1.2L);

  // The next of the gyro's filtered rates, at 100 Hz, of a robot that makes no torque. True when a second of
  // rest is complete, and `bias` is new.
  bool observe(const Rates& rates);
  // Torque has come: what was begun is thrown away.
  void interrupt() { count_ = 0; }
  // What was begun has been thrown away: nothing yet counts for the next second.
  bool interrupted() const { return count_ == 0; }
  // A bias that is known from elsewhere, until the next second of rest.
  void assume(const Rates& bias) { bias_ = bias; }

  // Zero before the first second of rest, unless another was assumed.
  const Rates& bias() const { return bias_; }

 private:
  struct Axis {
    std::int64_t sum_raw = 0;
    fixed::AngularRate lowest;
    fixed::AngularRate highest;
  };

  void restart(const std::array<fixed::AngularRate, 3>& rates);
  fixed::AngularRate mean(std::size_t axis) const;

  Rates bias_;
  std::array<Axis, 3> axes_{};
  std::int32_t count_ = 0;
};

}  // namespace koboshi::estimation
