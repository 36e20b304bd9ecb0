#include "sim_board/sensor/low_pass.h"

#include <cmath>
#include <numbers>
#include <stdexcept>

namespace koboshi::sim {

LowPass::LowPass(double bandwidth_Hz) : decay_per_s_(std::numbers::sqrt2 * std::numbers::pi * bandwidth_Hz) {
  if (!(bandwidth_Hz > 0.0)) throw std::invalid_argument("low-pass: bandwidth must be greater than zero");
}

void LowPass::settle(const Eigen::Vector3d& input) {
  input_ = input;
  output_ = input;
  slope_.setZero();
}

// With u(t) = u0 + r t and a the decay, y_p = u - r/a solves y'' + 2a y' + 2a^2 y = 2a^2 u. What remains, e =
// y - y_p, decays freely; with g = e'/a and the angle at = a t it turns by
//   e(t) = exp(-at) ((cos at + sin at) e0 + sin at g0),   g(t) = exp(-at) ((cos at - sin at) g0 - 2 sin at
//   e0).
void LowPass::advance(const Eigen::Vector3d& input, std::uint64_t duration_us) {
  if (duration_us != transition_.duration_us) prepare(duration_us);
  const double c = transition_.cosine;
  const double s = transition_.sine;
  // r/a: how far the output trails a ramp once it has settled.
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
  // Sine and cosine from one tangent: compilers fuse sin and cos of one argument or not, as the build type
  // goes.
  const double tangent = std::tan(0.5 * angle);
  const double norm = 1.0 + tangent * tangent;
  transition_ = {duration_us, shrink * (1.0 - tangent * tangent) / norm, shrink * 2.0 * tangent / norm};
}

}  // namespace koboshi::sim
