#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string_view>

#include "sim_board/random/random_stream.h"

namespace koboshi::sim {

// White noise of a converter, of the one-sided density that data sheets give, up to half the sampling rate:
//
//   sigma of a sample = density * sqrt(rate / 2).
//
// This is the angle random walk of a gyro, the velocity random walk of an accelerometer: IEEE Std 952 counts
// the density on both sides, N = density / sqrt(2), and the Allan deviation is N / sqrt(tau).
//
// It is added behind the anti-alias filter, so its density is right at every frequency that a sample can
// carry.
class WhiteNoise {
 public:
  // `density` in unit / sqrt(Hz).
  WhiteNoise(double density, double sample_period_s, std::uint64_t seed, std::string_view name);

  // The noise of the next sample of three independent axes.
  Eigen::Vector3d sample();
  double sigma() const { return sigma_; }

 private:
  double sigma_;
  RandomStream random_;
};

// The constant offset of a sensor, drawn once by the seed: uniform within +-largest on each axis.
class Bias {
 public:
  Bias(double largest, std::uint64_t seed, std::string_view name);

  const Eigen::Vector3d& value() const { return value_; }

 private:
  Eigen::Vector3d value_;
};

}  // namespace koboshi::sim
