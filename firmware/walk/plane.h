#pragma once

#include "firmware/fixed/trigonometry.h"
#include "firmware/fixed/units.h"

namespace koboshi::walk {

// A point on level ground, or the vector between two, in the frame of the support foot's sole: x forward, y
// to the left.
struct Point {
  fixed::Length x;
  fixed::Length y;

  friend constexpr Point operator+(Point a, Point b) { return {a.x + b.x, a.y + b.y}; }
  friend constexpr Point operator-(Point a, Point b) { return {a.x - b.x, a.y - b.y}; }
  friend constexpr bool operator==(const Point&, const Point&) = default;
};

// Rotates `p` to the left by `angle`.
[[nodiscard]] inline Point turned(Point p, fixed::Angle angle) {
  const auto [s, c] = fixed::sin_cos(angle);
  return {fixed::product_sum<fixed::Length>(p.x, c, -p.y, s),
          fixed::product_sum<fixed::Length>(p.x, s, p.y, c)};
}

// Pose of a sole in the plane of the ground, on it or above it.
struct Foothold {
  Point p;
  fixed::Angle yaw;

  friend constexpr bool operator==(const Foothold&, const Foothold&) = default;
};

}  // namespace koboshi::walk
