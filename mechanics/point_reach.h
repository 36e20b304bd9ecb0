#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

namespace koboshi::mechanics {

// A chain of hinges that carries a point.
struct PointChain {
  struct Hinge {
    Eigen::Vector3d anchor_P;  // in the frame of the hinge before, m; of the first: in the root's
    Eigen::Vector3d axis_P;    // unit vector; the frame behind has the same axes at position zero
    double lower_rad;
    double upper_rad;
  };
  static constexpr std::size_t kMaxHinges = 8;

  std::vector<Hinge> hinges;                      // at most kMaxHinges
  Eigen::Vector3d tip = Eigen::Vector3d::Zero();  // in the frame of the last hinge, m

  // Returns the point's position in the root's frame at these positions of the hinges, in rad.
  Eigen::Vector3d tip_at(std::span<const double> positions_rad) const;
};

// Turns the hinges, from these positions and within their limits, so that the point comes to the target:
// damped least squares (Wampler 1986) with hinges that stay at their limits while the step leads beyond.
// Returns the distance in m that is left, of the nearest pose on the way.
double reach_point(const PointChain& chain, const Eigen::Vector3d& target, std::span<double> positions_rad);

}  // namespace koboshi::mechanics
