#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstddef>

namespace koboshi::sim_board {

// A solid that a free body may touch, or a free body itself.
struct Solid {
  enum class Shape { kPlane, kBox, kSphere };

  Shape shape = Shape::kPlane;
  // The pose of its centre. The z axis of a plane is its normal, the origin a point of it.
  Eigen::Isometry3d X_WG = Eigen::Isometry3d::Identity();
  Eigen::Vector3d half_m =
      Eigen::Vector3d::Zero();  // half the edges of a box; the first is a sphere's radius

  // The radius of the sphere about the origin that contains it; of a plane 0.
  double radius_m() const { return shape == Shape::kBox ? half_m.norm() : half_m.x(); }
};

struct TouchingPoint {
  std::size_t number = 0;  // the same in each step, below kMaxTouchingPoints
  Eigen::Vector3d p_W = Eigen::Vector3d::Zero();
  Eigen::Vector3d n_W = Eigen::Vector3d::UnitZ();  // unit normal from the other solid towards the body
  double depth_m = 0.0;                            // above 0
};

inline constexpr std::size_t kMaxTouchingPoints = 16;  // of two solids: the corners of both

struct TouchingPoints {
  std::array<TouchingPoint, kMaxTouchingPoints> points{};
  std::size_t count = 0;

  const TouchingPoint* begin() const { return points.data(); }
  const TouchingPoint* end() const { return points.data() + count; }
  void add(const TouchingPoint& point) { points[count++] = point; }
};

// Finds the points at which a body, a box or sphere, overlaps another solid. A sphere touches at the point
// where it is deepest. Boxes touch at the corners of one in the other, in the direction of the nearest face;
// edges that cross without a corner inside do not count, which lets bodies overlap by a fraction of their
// roundness and no more.
void find_touching_points(const Solid& body, const Solid& other, TouchingPoints& found);

}  // namespace koboshi::sim_board
