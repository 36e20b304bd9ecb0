#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string_view>

#include "sim_board/random/random_stream.h"

// Random errors of a triad of sensor axes, by IEEE Std 952-1997, annex C: bias, its drift, and white noise.
// The three axes are independent. `name` and the seed identify the random stream of each error.
namespace koboshi::sim_board {

// Seed and scale of all random errors of a robot's sensors.
struct SensorErrors {
  std::uint64_t seed = 1;
  double scale = 1.0;  // 0 disables all random errors; bandwidth, range, resolution, rate and delay remain
};

// White noise with the one-sided density that data sheets specify, band-limited to half the sampling rate:
//
//   standard deviation of a sample = density * sqrt(rate / 2).
//
// This is the angle random walk of a gyro and the velocity random walk of an accelerometer. IEEE Std 952 uses
// the two-sided density: N = density / sqrt(2), with the Allan deviation N / sqrt(tau).
//
// The noise is added after the anti-alias filter, so its density is correct up to half the sampling rate.
class WhiteNoise {
 public:
  // `density` in unit / sqrt(Hz).
  WhiteNoise(double density, double sample_period_s, std::uint64_t seed, std::string_view name);

  // Returns the noise of the next sample.
  Eigen::Vector3d sample();
  // Standard deviation of a sample.
  double sigma() const { return sigma_; }

 private:
  double sigma_;
  RandomStream random_;
};

// Constant offset, drawn once: uniform within +-largest on each axis.
class Bias {
 public:
  Bias(double largest, std::uint64_t seed, std::string_view name);

  const Eigen::Vector3d& value() const { return value_; }

 private:
  Eigen::Vector3d value_;
};

// The two drift processes below change by a step of fixed size and random sign at each sample. A correlation
// time comprises at least a hundred samples, so their sum is normally distributed without the cost of normal
// random numbers.

// Flicker noise with the coefficient B of annex C.1.3:
//
//   density S(f) = B^2 / (2 pi f)   (two-sided),   Allan deviation sqrt(2 ln 2 / pi) B = 0.664 B.
//
// It is approximated by the sum of five first-order Gauss-Markov processes with correlation times of 0.1 s to
// 1000 s, one per decade, each with variance B^2 ln(10) / pi. The power density of the sum is within 6 % of
// S(f) over the band (M. S. Keshner, "1/f noise", Proc. IEEE 70(3), 1982). A single process, as often used,
// has no flat Allan deviation. Faster processes would be hidden by white noise; slower ones are constant in a
// run. The processes start in their stationary distribution.
class BiasInstability {
 public:
  static constexpr int kProcesses = 5;
  static constexpr double kShortest_s = 0.1;  // shortest correlation time; each is ten times the previous one

  // `coefficient` is B, in the sensor's unit.
  BiasInstability(double coefficient, double sample_period_s, std::uint64_t seed, std::string_view name);

  // Returns the drift at the next sample.
  Eigen::Vector3d sample();
  // Standard deviation of one of the processes.
  double sigma() const { return sigma_; }

 private:
  struct Process {
    double decay = 0.0;  // over a sampling period
    double kick = 0.0;   // size of a step
    Eigen::Vector3d state = Eigen::Vector3d::Zero();
  };

  double sigma_;
  RandomStream random_;
  std::array<Process, kProcesses> processes_;
};

// Rate random walk of a gyro, acceleration random walk of an accelerometer (annex C.1.4): integrated white
// noise with variance K^2 t after time t and Allan deviation K sqrt(tau / 3). Starts at zero.
class RandomWalk {
 public:
  // `coefficient` is K, in unit / sqrt(s).
  RandomWalk(double coefficient, double sample_period_s, std::uint64_t seed, std::string_view name);

  // Returns the drift at the next sample.
  Eigen::Vector3d sample();

 private:
  double kick_;
  RandomStream random_;
  Eigen::Vector3d state_ = Eigen::Vector3d::Zero();
};

}  // namespace koboshi::sim_board
