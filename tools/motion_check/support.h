#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace koboshi::tools {

// How a rigid body rests on level ground with some of its corners.
struct Rest {
  Eigen::Vector3d up_B = Eigen::Vector3d::UnitZ();  // unit vector against gravity
  double height_m = 0.0;                            // of the ground along up_B, from the origin of B
  std::uint32_t corners = 0;                        // bit i: corner i is on the ground
  double tip_rad = 0.0;                             // rotation from the initial attitude
  double drop_m = 0.0;                              // by which the rotation lowers the centre of mass
  bool rests = false;  // false: the body tips over; the other members are then those of the initial attitude
};

// Finds the attitude in which a body comes to rest, quasi-statically: from `up_B` it rolls about the nearest
// corner or edge of its support polygon, in the direction of its centre of mass, until the next corner
// touches, as often as the centre of mass is not above the polygon. Each roll lowers the centre of mass, so
// the result is the local minimum of its height. Corners within `tolerance_m` of the lowest one touch: the
// servos yield by as much. At most 31 corners.
[[nodiscard]] Rest find_rest(std::span<const Eigen::Vector3d> corners_B, const Eigen::Vector3d& com_B,
                             const Eigen::Vector3d& up_B, double tolerance_m);

// The horizontal axes in which margins are given: x is the trunk's forward axis, projected to the ground, and
// y points to the left.
struct GroundAxes {
  Eigen::Vector3d x_B;
  Eigen::Vector3d y_B;

  explicit GroundAxes(const Eigen::Vector3d& up_B);
  Eigen::Vector2d flat(const Eigen::Vector3d& p_B) const { return {x_B.dot(p_B), y_B.dot(p_B)}; }
};

// The position of a point relative to a support polygon.
struct Margin {
  double distance_m = 0.0;  // from the edge, positive inside
  Eigen::Vector2d outward;  // unit vector across the nearest edge, away from the polygon
};

// The margin in a convex polygon in the order of sim_board::convex_hull. A polygon of one or two corners has
// no inside.
[[nodiscard]] Margin margin_in(std::span<const Eigen::Vector2d> polygon, const Eigen::Vector2d& point);

}  // namespace koboshi::tools
