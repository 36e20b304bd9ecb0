#pragma once

#include <array>
#include <cstdint>

#include "firmware/fixed/literals.h"
#include "firmware/robot/geometry.h"

namespace koboshi::estimation {

// Measures the bias of the gyro, the rate that it reads at rest: up to 20 deg/s for an MPU-6050 (zero-rate
// output of its data sheet). The bias is the mean over one second in which the reading of no axis spans more
// than kMaxSpread. A second with more motion is discarded, so that a robot that is carried keeps its last
// bias.
class GyroBias {
 public:
  using Rates = robot::Vector<fixed::AngularRate>;

  static constexpr std::int32_t kSamples = 100;  // one second at 100 Hz
  // Ten times the span of an MPU-6050's noise, 0.005 deg/s/sqrt(Hz) (data sheet), in one second after the 20
  // Hz low-pass. A robot that somebody holds moves more.
  static constexpr auto kMaxSpread = fixed::literals::operator""_deg_per_s(1.2L);

  // Takes the gyro's next filtered rates, at 100 Hz, while the drives make no torque. Returns true when a
  // second of rest is complete and `bias` is new.
  bool observe(const Rates& rates);
  // Discards the samples so far: the drives make torque.
  void interrupt() { count_ = 0; }
  // Returns whether the last samples were discarded or used: the next second has no samples yet.
  bool interrupted() const { return count_ == 0; }
  // Sets a stored bias, valid until the next second of rest.
  void assume(const Rates& bias) { bias_ = bias; }

  // Returns the bias in force; zero before the first second of rest unless a stored one was set.
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
