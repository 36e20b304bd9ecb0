#pragma once

#include <Eigen/Core>
#include <cstdint>

namespace koboshi::sim {

// The analogue anti-alias filter in front of a sensor's converter: a 2nd-order Butterworth low-pass of unit
// gain,
//
//   H(s) = wn^2 / (s^2 + sqrt(2) wn s + wn^2),   wn = 2 pi bandwidth,
//
// for three axes alike. The input is taken as a straight line between the values that it is given, and for
// such an input the output is exact: it depends neither on the physics step nor on how a step is divided at
// sampling instants. (The low-pass of the paper is another one, and the firmware's.)
class LowPass {
 public:
  // `bandwidth_Hz` is where the gain is -3 dB; greater than zero.
  explicit LowPass(double bandwidth_Hz);

  // At rest, as if `input` had been there for ever.
  void settle(const Eigen::Vector3d& input);
  // The input moves on a straight line from its last value to `input` within `duration_us`, which is greater
  // than zero.
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

}  // namespace koboshi::sim
