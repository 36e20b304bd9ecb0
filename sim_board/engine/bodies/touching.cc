#include "sim_board/engine/bodies/touching.h"

#include <cmath>

namespace koboshi::sim_board {
namespace {

using Eigen::Vector3d;
using Shape = Solid::Shape;

constexpr std::size_t kBoxCorners = 8;

Vector3d box_corner_W(const Solid& box, std::size_t number) {
  const Vector3d signs((number & 1u) != 0 ? 1.0 : -1.0, (number & 2u) != 0 ? 1.0 : -1.0,
                       (number & 4u) != 0 ? 1.0 : -1.0);
  return box.X_WG * box.half_m.cwiseProduct(signs);
}

// The nearest face of a box that contains the point, in the box's frame.
struct BoxFace {
  Vector3d normal_G = Vector3d::UnitZ();
  double depth_m = 0.0;
};

BoxFace nearest_face(const Vector3d& p_G, const Vector3d& half_m) {
  Eigen::Index axis = 0;
  const Vector3d depths_m = half_m - p_G.cwiseAbs();
  BoxFace face{.normal_G = Vector3d::Zero(), .depth_m = depths_m.minCoeff(&axis)};
  face.normal_G[axis] = p_G[axis] < 0.0 ? -1.0 : 1.0;
  return face;
}

void corners_in_plane(const Solid& box, const Solid& plane, TouchingPoints& found) {
  const Vector3d n_W = plane.X_WG.linear().col(2);
  for (std::size_t i = 0; i < kBoxCorners; ++i) {
    const Vector3d p_W = box_corner_W(box, i);
    const double depth_m = -n_W.dot(p_W - plane.X_WG.translation());
    if (depth_m > 0.0) found.add({i, p_W, n_W, depth_m});
  }
}

// Corners of `one` in `other`; `sign` turns the normal, which points from `other` to `one`.
void corners_in_box(const Solid& one, const Solid& other, std::size_t first, double sign,
                    TouchingPoints& found) {
  const Eigen::Isometry3d X_GW = other.X_WG.inverse();
  for (std::size_t i = 0; i < kBoxCorners; ++i) {
    const Vector3d p_W = box_corner_W(one, i);
    const BoxFace face = nearest_face(X_GW * p_W, other.half_m);
    if (face.depth_m > 0.0)
      found.add({first + i, p_W, sign * (other.X_WG.linear() * face.normal_G), face.depth_m});
  }
}

void sphere_on_plane(const Solid& sphere, const Solid& plane, TouchingPoints& found) {
  const Vector3d n_W = plane.X_WG.linear().col(2);
  const Vector3d& c_W = sphere.X_WG.translation();
  const double depth_m = sphere.half_m.x() - n_W.dot(c_W - plane.X_WG.translation());
  if (depth_m > 0.0) found.add({0, c_W - (sphere.half_m.x() - 0.5 * depth_m) * n_W, n_W, depth_m});
}

void sphere_on_box(const Solid& sphere, const Solid& box, double sign, TouchingPoints& found) {
  const double radius_m = sphere.half_m.x();
  const Vector3d c_G = box.X_WG.inverse() * sphere.X_WG.translation();
  const Vector3d nearest_G = c_G.cwiseMax(-box.half_m).cwiseMin(box.half_m);
  const Vector3d away_G = c_G - nearest_G;
  const double distance_m = away_G.norm();
  if (distance_m >= radius_m) return;
  const bool is_outside = distance_m > 1e-9;
  const BoxFace face = nearest_face(c_G, box.half_m);  // of a centre that is inside
  const Vector3d n_G = is_outside ? Vector3d(away_G / distance_m) : face.normal_G;
  const double depth_m = is_outside ? radius_m - distance_m : radius_m + face.depth_m;
  found.add(
      {0, box.X_WG * (c_G - (radius_m - 0.5 * depth_m) * n_G), sign * (box.X_WG.linear() * n_G), depth_m});
}

void sphere_on_sphere(const Solid& one, const Solid& other, TouchingPoints& found) {
  const Vector3d apart_W = one.X_WG.translation() - other.X_WG.translation();
  const double distance_m = apart_W.norm();
  const double depth_m = one.half_m.x() + other.half_m.x() - distance_m;
  if (depth_m <= 0.0) return;
  const Vector3d n_W = distance_m > 1e-9 ? Vector3d(apart_W / distance_m) : Vector3d::UnitZ();
  found.add({0, one.X_WG.translation() - (one.half_m.x() - 0.5 * depth_m) * n_W, n_W, depth_m});
}

}  // namespace

void find_touching_points(const Solid& body, const Solid& other, TouchingPoints& found) {
  found.count = 0;
  if (body.shape == Shape::kSphere) {
    if (other.shape == Shape::kPlane) return sphere_on_plane(body, other, found);
    if (other.shape == Shape::kBox) return sphere_on_box(body, other, 1.0, found);
    return sphere_on_sphere(body, other, found);
  }
  if (other.shape == Shape::kPlane) return corners_in_plane(body, other, found);
  if (other.shape == Shape::kSphere) return sphere_on_box(other, body, -1.0, found);
  corners_in_box(body, other, 0, 1.0, found);
  corners_in_box(other, body, kBoxCorners, -1.0, found);
}

}  // namespace koboshi::sim_board
