#pragma once

#include <cmath>
#include <span>

#include "firmware/fixed/host/convert.h"
#include "firmware/robot/model.h"

// Kinematics in double, written independently of the firmware: points are carried from a link to the base
// joint by joint, each turned by Rodrigues' formula for vectors; no matrices.
namespace koboshi::test {

struct Point {
  double x = 0.0;
  double y = 0.0;
  double z = 0.0;
};

inline Point operator+(const Point& a, const Point& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Point operator-(const Point& a, const Point& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Point operator*(double s, const Point& a) { return {s * a.x, s * a.y, s * a.z}; }
inline double dot(const Point& a, const Point& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline double norm(const Point& a) { return std::sqrt(dot(a, a)); }
inline Point cross(const Point& a, const Point& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

template <fixed::AnyQuantity Q>
Point to_point(const robot::Vector<Q>& v) {
  return {fixed::to_double(v.x), fixed::to_double(v.y), fixed::to_double(v.z)};
}

inline Point turned(const Point& p, const Point& axis, double angle_rad) {
  return std::cos(angle_rad) * p + std::sin(angle_rad) * cross(axis, p) +
         ((1.0 - std::cos(angle_rad)) * dot(axis, p)) * axis;
}

// A point (or, without anchors, a direction) of link `joint` seen from the base.
inline Point to_base(const robot::RobotModel& model, std::span<const double> angles_rad, int joint, Point p,
                     bool is_direction = false) {
  while (joint >= 0) {
    const robot::Joint& hinge = model.joints[static_cast<std::size_t>(joint)];
    p = turned(p, to_point(hinge.axis), angles_rad[static_cast<std::size_t>(joint)]);
    if (!is_direction) p = p + to_point(hinge.anchor);
    joint = hinge.parent;
  }
  return p;
}

}  // namespace koboshi::test
