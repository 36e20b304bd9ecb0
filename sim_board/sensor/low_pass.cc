#include "sim_board/sensor/low_pass.h"

#include <cmath>
#include <numbers>
#include <stdexcept>

namespace koboshi::sim_board {

LowPass::LowPass(double bandwidth_Hz) : decay_per_s_(std::numbers::sqrt2 * std::numbers::pi * bandwidth_Hz) {
  if (!(bandwidth_Hz > 0.0)) throw std::invalid_argument("low-pass: bandwidth must be greater than zero");
}

void LowPass::settle(const Eigen::Vector3d& input) {
  input_ = input;
  output_ = input;
  slope_.setZero();
}

// For the input u(t) = u0 + r t and the decay a, y_p = u - r/a is a particular solution of
//   y'' + 2a y' + 2a^2 y = 2a^2 u.
// The error e = y - y_p satisfies the homogeneous equation. With g = e'/a its solution is
//   e(t) = exp(-at) ((cos at + sin at) e0 + sin at g0),
//   g(t) = exp(-at) ((cos at - sin at) g0 - 2 sin at e0).
void LowPass::advance(const Eigen::Vector3d& input, std::uint64_t duration_us) {
  if (duration_us != transition_.duration_us) prepare(duration_us);
  const double c = transition_.cosine;
  const double s = transition_.sine;
  // r/a: steady-state lag of the output behind a ramp.
  const Eigen::Vector3d lag = (input - input_) / (decay_per_s_ * static_cast<double>(duration_us) * 1e-6);
  const Eigen::Vector3d error = output_ - (input_ - lag);
  const Eigen::Vector3d error_slope = slope_ - lag;
  output_ = input - lag + (c + s) * error + s * error_slope;
  slope_ = lag + (c - s) * error_slope - 2.0 * s * error;
  input_ = input;
}

void LowPass::prepare(std::uint64_t duration_us) {
  const double angle = decay_per_s_ * static_cast<double>(duration_us) * 1e-6;
  const double shrink = std::exp(-angle);
  // Sine and cosine from one tangent: some compilers and build types fuse sin and cos of one argument, others
  // do not, and the results differ in their last bits.
  const double tangent = std::tan(0.5 * angle);
  const double norm = 1.0 + tangent * tangent;
  transition_ = {duration_us, shrink * (1.0 - tangent * tangent) / norm, shrink * 2.0 * tangent / norm};
}

}  // namespace koboshi::sim_board
