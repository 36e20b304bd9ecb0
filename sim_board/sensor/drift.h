#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string_view>

#include "sim_board/random/random_stream.h"

namespace koboshi::sim {

// How a bias moves after it has been drawn; three independent axes. Both take equal steps up or down by a
// fair coin, a hundred or more in the time over which they are correlated, so that the sum is normal without
// the cost of drawing normal numbers.

// Flicker noise of the one coefficient B that IEEE Std 952-1997 (annex C.1.3) gives it, of density
//
//   S(f) = B^2 / (2 pi f)   (two-sided),   Allan deviation sqrt(2 ln 2 / pi) B = 0.664 B,
//
// as the sum of one first-order Gauss-Markov process a decade, with correlation times of 0.1 s to 1000 s:
// each has the variance B^2 ln(10) / pi, and their sum is B^2 / (2 pi f) within 6 % of power over the band
// (M. S. Keshner, "1/f noise", Proc. IEEE 70(3), 1982). A single process, as often used, has no flat part.
// What is faster drowns in white noise, what is slower is a constant bias in any run. The sum starts as if it
// had been there for ever.
class BiasInstability {
 public:
  static constexpr int kProcesses = 5;
  static constexpr double kShortest_s = 0.1;  // correlation time; each next one is ten times as long

  // `coefficient` is B, in the sensor's unit.
  BiasInstability(double coefficient, double sample_period_s, std::uint64_t seed, std::string_view name);

  // At the next sample.
  Eigen::Vector3d sample();
  // Standard deviation of one of the processes.
  double sigma() const { return sigma_; }

 private:
  struct Process {
    double decay = 0.0;  // over a sampling period
    double kick = 0.0;
    Eigen::Vector3d state = Eigen::Vector3d::Zero();
  };

  double sigma_;
  RandomStream random_;
  std::array<Process, kProcesses> processes_;
};

// Rate random walk of a gyro, acceleration random walk of an accelerometer (IEEE Std 952-1997, annex C.1.4):
// integrated white noise with the variance K^2 t after a time t, Allan deviation K sqrt(tau / 3). Starts at
// zero.
class RandomWalk {
 public:
  // `coefficient` is K, in unit / sqrt(s).
  RandomWalk(double coefficient, double sample_period_s, std::uint64_t seed, std::string_view name);

  // At the next sample.
  Eigen::Vector3d sample();

 private:
  double kick_;
  RandomStream random_;
  Eigen::Vector3d state_ = Eigen::Vector3d::Zero();
};

}  // namespace koboshi::sim
