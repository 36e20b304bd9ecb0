#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string_view>

#include "sim_board/random/random_stream.h"

namespace koboshi::sim {

// By how much each axis of a triad answers to each direction: what a data sheet calls scale factor tolerance
// (on the diagonal, 1 + error) and cross-axis sensitivity (beside it; axes that are not orthogonal are part
// of it). Drawn once by the seed: uniform within the given bounds.
class AxisGains {
 public:
  // Both bounds are shares, as 0.03 for 3 %.
  AxisGains(double scale_error, double cross_axis, std::uint64_t seed, std::string_view name);

  const Eigen::Matrix3d& value() const { return value_; }

 private:
  Eigen::Matrix3d value_;
};

// What a triad shows of another quantity than its own, as a gyro of acceleration: a matrix that is drawn once
// by the seed, each element uniform within +-largest, in the unit of the one by the unit of the other.
class CrossSensitivity {
 public:
  CrossSensitivity(double largest, std::uint64_t seed, std::string_view name);

  const Eigen::Matrix3d& value() const { return value_; }

 private:
  Eigen::Matrix3d value_;
};

}  // namespace koboshi::sim
