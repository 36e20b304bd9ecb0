#include "tools/motion_check/support.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "sim_board/world/support_polygon.h"

namespace koboshi::tools {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// A body that has to roll further than this to find its next corner falls: on feet of 100 mm it meets the
// ground with something other than a sole.
constexpr double kMaxTip_rad = 25.0 * std::numbers::pi / 180.0;
constexpr int kMaxRolls = 8;

// The nearest point of a polygon's boundary.
Vector2d nearest_on(std::span<const Vector2d> polygon, const Vector2d& point) {
  Vector2d nearest = polygon.front();
  double least_m2 = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vector2d& a = polygon[i];
    const Vector2d ab = polygon[(i + 1) % polygon.size()] - a;
    const double length_m2 = ab.squaredNorm();
    const double along = length_m2 > 0.0 ? std::clamp(ab.dot(point - a) / length_m2, 0.0, 1.0) : 0.0;
    const Vector2d candidate = a + along * ab;
    const double m2 = (candidate - point).squaredNorm();
    if (m2 >= least_m2) continue;
    least_m2 = m2;
    nearest = candidate;
  }
  return nearest;
}

}  // namespace

GroundAxes::GroundAxes(const Vector3d& up_B)
    : x_B((Vector3d::UnitX() - up_B.x() * up_B).normalized()), y_B(up_B.cross(x_B)) {}

Margin margin_in(std::span<const Vector2d> polygon, const Vector2d& point) {
  Margin margin{-std::numeric_limits<double>::infinity(), Vector2d::UnitX()};
  if (polygon.empty()) return margin;
  bool inside = polygon.size() >= 3;
  for (std::size_t i = 0; inside && i < polygon.size(); ++i) {
    const Vector2d ab = polygon[(i + 1) % polygon.size()] - polygon[i];
    const Vector2d ap = point - polygon[i];
    inside = ab.x() * ap.y() - ab.y() * ap.x() >= 0.0;
  }
  const Vector2d offset = point - nearest_on(polygon, point);
  const double distance_m = offset.norm();
  margin.distance_m = inside ? distance_m : -distance_m;
  if (distance_m > 0.0)
    margin.outward = inside ? Vector2d(-offset / distance_m) : Vector2d(offset / distance_m);
  return margin;
}

Rest find_rest(std::span<const Vector3d> corners_B, const Vector3d& com_B, const Vector3d& up_B,
               double tolerance_m) {
  Rest initial;
  Rest rest;
  rest.up_B = up_B;
  std::vector<Vector2d> touching;
  std::array<double, 32> heights_m{};
  for (int roll = 0; roll <= kMaxRolls; ++roll) {
    double lowest_m = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < corners_B.size(); ++i) {
      heights_m[i] = rest.up_B.dot(corners_B[i]);
      lowest_m = std::min(lowest_m, heights_m[i]);
    }
    const GroundAxes axes(rest.up_B);
    rest.corners = 0;
    rest.height_m = lowest_m;
    touching.clear();
    for (std::size_t i = 0; i < corners_B.size(); ++i) {
      if (heights_m[i] > lowest_m + tolerance_m) continue;
      rest.corners |= 1U << i;
      touching.push_back(axes.flat(corners_B[i]));
    }
    if (roll == 0) initial = rest;
    const std::vector<Vector2d> hull = sim_board::convex_hull(touching);
    const Vector2d com = axes.flat(com_B);
    if (margin_in(hull, com).distance_m >= 0.0) {
      rest.rests = true;
      const auto height_m = [&](const Rest& at) { return at.up_B.dot(com_B) - at.height_m; };
      rest.drop_m = height_m(initial) - height_m(rest);
      return rest;
    }
    // Rolls about the pivot in the direction u: up' = cos(t) up - sin(t) u. Corner i touches at
    // tan(t) = (height above the pivot) / (distance along u).
    const Vector2d pivot = nearest_on(hull, com);
    const Vector2d way = (com - pivot).normalized();
    const Vector3d u_B = way.x() * axes.x_B + way.y() * axes.y_B;
    double least_tangent = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < corners_B.size(); ++i) {
      if ((rest.corners >> i & 1U) != 0) continue;
      const double along_m = u_B.dot(corners_B[i]) - way.dot(pivot);
      if (along_m > 0.0) least_tangent = std::min(least_tangent, (heights_m[i] - lowest_m) / along_m);
    }
    const double angle_rad = std::atan(least_tangent);
    rest.tip_rad += angle_rad;
    if (rest.tip_rad > kMaxTip_rad) return initial;
    rest.up_B = (std::cos(angle_rad) * rest.up_B - std::sin(angle_rad) * u_B).normalized();
  }
  return initial;
}

}  // namespace koboshi::tools
