#pragma once

#include <Eigen/Core>
#include <vector>

namespace koboshi::sim_board {

// Plane geometry of the support polygon; points in m.

// Returns the corners of the convex hull, counter-clockwise, without points on its edges. Fewer than three
// corners if all points are on a line or coincide.
std::vector<Eigen::Vector2d> convex_hull(std::vector<Eigen::Vector2d> points);

// Returns the distance of the point from the edge of a convex polygon in the order of convex_hull: positive
// inside, negative outside. A polygon of one or two corners has no inside; an empty one is infinitely far
// away.
double distance_inside(const std::vector<Eigen::Vector2d>& polygon, const Eigen::Vector2d& point);

}  // namespace koboshi::sim_board
