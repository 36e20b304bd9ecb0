#pragma once

#include <Eigen/Core>
#include <vector>

namespace koboshi::sim {

// Plane geometry of the support polygon. Points in m.

// The corners of the convex hull of the points, counter-clockwise; points on its edges are not corners. Fewer
// than three when the points lie on a line or in one place.
std::vector<Eigen::Vector2d> convex_hull(std::vector<Eigen::Vector2d> points);

// Distance from the point to the edge of a convex polygon as convex_hull makes it: positive inside, negative
// outside. A polygon of one or two corners has no inside; one without corners is infinitely far away.
double distance_inside(const std::vector<Eigen::Vector2d>& polygon, const Eigen::Vector2d& point);

}  // namespace koboshi::sim
