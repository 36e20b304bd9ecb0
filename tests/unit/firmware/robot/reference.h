#pragma once

#include <cmath>
#include <span>

#include "firmware/fixed/host/convert.h"
#include "firmware/robot/model.h"

// Kinematics in double, independent of the firmware: transforms points joint by joint from a link to the base
// with Rodrigues' formula, without matrices.
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

// Transforms a point (or, without anchors, a direction) from the frame of link `joint` to the base frame.
inline Point to_base(const robot::RobotModel& model, std::span<const double> angles_rad, int joint, Point p,
                     bool is_direction = false) {
  while (joint >= 0) {
    const robot::Joint& hinge = model.joints[static_cast<std::size_t>(joint)];
    p = turned(p, to_point(hinge.axis), angles_rad[static_cast<std::size_t>(joint)]);
    if (!is_direction) p = p + to_point(hinge.anchor);
    joint = hinge.parent.raw();
  }
  return p;
}

// Centre of mass of the whole robot in B.
inline Point centre_of_mass(const robot::RobotModel& model, std::span<const double> angles_rad) {
  double mass_kg = fixed::to_double(model.base_mass);
  Point moment = mass_kg * to_point(model.base_centre_of_mass);
  for (std::size_t i = 0; i < model.hinge_count(); ++i) {
    const double link_kg = fixed::to_double(model.joints[i].mass);
    moment = moment + link_kg * to_base(model, angles_rad, static_cast<int>(i),
                                        to_point(model.joints[i].centre_of_mass));
    mass_kg += link_kg;
  }
  return (1.0 / mass_kg) * moment;
}

// Transforms a point from a sole's frame to B, and back.
inline Point from_sole(const robot::RobotModel& model, std::span<const double> angles_rad, hal::Side side,
                       Point p_Sole) {
  p_Sole.z -= fixed::to_double(model.feet[static_cast<std::size_t>(side)].ankle_height);
  return to_base(model, angles_rad, static_cast<int>(model.foot_joint(side)), p_Sole);
}
inline Point to_sole(const robot::RobotModel& model, std::span<const double> angles_rad, hal::Side side,
                     const Point& p_B) {
  const auto ankle = static_cast<int>(model.foot_joint(side));
  const Point r = p_B - from_sole(model, angles_rad, side, {});
  const auto axis = [&](const Point& unit) { return dot(r, to_base(model, angles_rad, ankle, unit, true)); };
  return {axis({1, 0, 0}), axis({0, 1, 0}), axis({0, 0, 1})};
}

}  // namespace koboshi::test
