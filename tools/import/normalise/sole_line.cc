#include "tools/import/normalise/sole_line.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "base/text/user_units.h"

namespace koboshi::tools {
namespace {

using Eigen::Vector2d;

double cross(const Vector2d& a, const Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

// The lower half of the convex hull, from -x to +x (Andrew's monotone chain).
std::vector<Vector2d> lower_hull(std::vector<Vector2d> points) {
  std::ranges::sort(points, [](const Vector2d& a, const Vector2d& b) {
    return std::pair(a.x(), a.y()) < std::pair(b.x(), b.y());
  });
  std::vector<Vector2d> hull;
  for (const Vector2d& point : points) {
    while (hull.size() >= 2 &&
           cross(hull.back() - hull[hull.size() - 2], point - hull[hull.size() - 2]) <= 0.0)
      hull.pop_back();
    hull.push_back(point);
  }
  return hull;
}

}  // namespace

std::optional<Vector2d> sole_line(std::vector<Vector2d> points) {
  constexpr double kMinShare = 0.4;
  constexpr double kMaxTilt_rad = 35.0 * kRadPerDegree;
  if (points.size() < 2) return std::nullopt;
  const std::vector<Vector2d> hull = lower_hull(std::move(points));
  const double length_m = hull.back().x() - hull.front().x();
  Vector2d longest = Vector2d::Zero();
  for (std::size_t i = 1; i < hull.size(); ++i) {
    const Vector2d edge = hull[i] - hull[i - 1];
    if (std::abs(std::atan2(edge.y(), edge.x())) <= kMaxTilt_rad && edge.norm() > longest.norm())
      longest = edge;
  }
  if (longest.norm() <= 0.0 || longest.norm() < kMinShare * length_m) return std::nullopt;
  return longest.normalized();
}

}  // namespace koboshi::tools
