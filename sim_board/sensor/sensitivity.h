#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string_view>

#include "sim_board/description/description.h"
#include "sim_board/sensor/noise.h"
#include "sim_board/world/world.h"

namespace koboshi::sim_board {

// Linear response of a triad to its own quantity: 1 + scale factor error on the diagonal, cross-axis
// sensitivity (which includes non-orthogonal axes) off it. Each element is drawn once, uniform within its
// bound.
class AxisGains {
 public:
  // Both bounds are fractions: 0.03 is 3 %.
  AxisGains(double scale_error, double cross_axis, std::uint64_t seed, std::string_view name);

  const Eigen::Matrix3d& value() const { return value_; }

 private:
  Eigen::Matrix3d value_;
};

// Linear response of a triad to another quantity, such as that of a gyro to acceleration. Each element is
// drawn once, uniform within +-largest, in the triad's unit per unit of the other quantity.
class CrossSensitivity {
 public:
  CrossSensitivity(double largest, std::uint64_t seed, std::string_view name);

  const Eigen::Matrix3d& value() const { return value_; }

 private:
  Eigen::Matrix3d value_;
};

// Crosstalk between the force axes and the torque axes of a six-axis sensor. Its strain gauges share one
// body, and calibration leaves a residual. Together with the AxisGains of both triads this fills the sensor's
// 6 x 6 matrix. Drawn once:
//
//   f_i += c_ij F/T tau_j,   tau_i += c'_ij T/F f_j,   |c|, |c'| <= crosstalk,
//
// where F and T are the ranges of force and torque.
class AnkleCrosstalk {
 public:
  AnkleCrosstalk(const AnkleSensorDescription& description, const SensorErrors& errors);

  Wrench apply(const Wrench& wrench) const;

 private:
  CrossSensitivity force_by_torque_;  // N / (N m)
  CrossSensitivity torque_by_force_;  // N m / N
};

}  // namespace koboshi::sim_board
