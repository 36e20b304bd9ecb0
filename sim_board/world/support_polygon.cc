#include "sim_board/world/support_polygon.h"

#include <algorithm>
#include <limits>
#include <tuple>

namespace koboshi::sim_board {
namespace {

using Eigen::Vector2d;

// Positive if a, b, c make a left turn.
double turn(const Vector2d& a, const Vector2d& b, const Vector2d& c) {
  const Vector2d ab = b - a;
  const Vector2d ac = c - a;
  return ab.x() * ac.y() - ab.y() * ac.x();
}

double distance_to_edge(const Vector2d& a, const Vector2d& b, const Vector2d& point) {
  const Vector2d ab = b - a;
  const double length2 = ab.squaredNorm();
  const double along = length2 > 0.0 ? std::clamp(ab.dot(point - a) / length2, 0.0, 1.0) : 0.0;
  return (point - a - along * ab).norm();
}

}  // namespace

// Andrew's monotone chain: the lower hull from left to right, then the upper hull back.
std::vector<Vector2d> convex_hull(std::vector<Vector2d> points) {
  std::ranges::sort(points, {}, [](const Vector2d& p) { return std::tuple(p.x(), p.y()); });
  points.erase(std::unique(points.begin(), points.end()), points.end());
  if (points.size() < 3) return points;
  std::vector<Vector2d> hull;
  const auto add = [&hull](const Vector2d& point, std::size_t side_begin) {
    while (hull.size() >= side_begin + 2 && turn(hull[hull.size() - 2], hull.back(), point) <= 0.0)
      hull.pop_back();
    hull.push_back(point);
  };
  for (const Vector2d& point : points) add(point, 0);
  const std::size_t upper_begin = hull.size() - 1;
  for (auto point = points.rbegin() + 1; point != points.rend(); ++point) add(*point, upper_begin);
  hull.pop_back();  // a duplicate of the first point
  return hull;
}

double distance_inside(const std::vector<Vector2d>& polygon, const Vector2d& point) {
  bool inside = polygon.size() >= 3;
  double distance_m = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vector2d& a = polygon[i];
    const Vector2d& b = polygon[(i + 1) % polygon.size()];
    inside = inside && turn(a, b, point) >= 0.0;
    distance_m = std::min(distance_m, distance_to_edge(a, b, point));
  }
  return inside ? distance_m : -distance_m;
}

}  // namespace koboshi::sim_board
