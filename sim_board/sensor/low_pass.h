#pragma once

#include <Eigen/Core>
#include <cstdint>

namespace koboshi::sim_board {

// Analogue anti-alias filter in front of a sensor's converter: a second-order Butterworth low-pass with unit
// gain for three axes,
//
//   H(s) = wn^2 / (s^2 + sqrt(2) wn s + wn^2),   wn = 2 pi bandwidth,
//
// The input is interpolated linearly between the given values. For this input the output is exact, so it
// depends neither on the physics step nor on the division of a step at sampling instants. (This is not the
// low-pass of the paper, which the firmware implements.)
class LowPass {
 public:
  // The gain is -3 dB at `bandwidth_Hz`. Throws std::invalid_argument unless it is positive.
  explicit LowPass(double bandwidth_Hz);

  // Sets the steady state for a constant `input`.
  void settle(const Eigen::Vector3d& input);
  // Moves the input linearly from its last value to `input` within `duration_us`, greater than zero.
  void advance(const Eigen::Vector3d& input, std::uint64_t duration_us);

  const Eigen::Vector3d& input() const { return input_; }
  const Eigen::Vector3d& output() const { return output_; }

 private:
  // exp(-decay t) cos(decay t) and exp(-decay t) sin(decay t).
  struct Transition {
    std::uint64_t duration_us = 0;
    double cosine = 1.0;
    double sine = 0.0;
  };
  void prepare(std::uint64_t duration_us);

  double decay_per_s_;  // the poles are at decay * (-1 +- j)
  Transition transition_;
  Eigen::Vector3d input_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d output_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d slope_ = Eigen::Vector3d::Zero();  // of the output, divided by decay
};

}  // namespace koboshi::sim_board
