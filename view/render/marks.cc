#include "view/render/marks.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace koboshi::view {
namespace {

constexpr int kSides = 20;  // of round bodies
constexpr int kRings = 10;  // of a sphere, from pole to pole
constexpr int kDiscSides = 32;
constexpr double kHeadRadius = 2.6;  // of an arrow's head, relative to the shaft's
constexpr double kHeadLength = 7.0;

std::array<float, 4> rgba(const Colour& colour, double opacity) {
  return {colour.red, colour.green, colour.blue, static_cast<float>(opacity)};
}

// A ring of points about an axis; (u, v, axis) is right-handed.
struct Axes {
  Eigen::Vector3d u;
  Eigen::Vector3d v;
  Eigen::Vector3d axis;

  explicit Axes(const Eigen::Vector3d& direction) : axis(direction.normalized()) {
    u = axis.unitOrthogonal();
    v = axis.cross(u);
  }
  Eigen::Vector3d radial(int side, int sides) const {
    const double angle_rad = 2.0 * std::numbers::pi * side / sides;
    return std::cos(angle_rad) * u + std::sin(angle_rad) * v;
  }
};

// A ring of a body of revolution.
struct Ring {
  Eigen::Vector3d centre_m;
  double radius_m;
  double normal_radial;  // the surface's normal there
  double normal_axial;
};

void add_band(std::vector<MarkVertex>& out, const Axes& axes, const Ring& low, const Ring& high,
              const std::array<float, 4>& colour) {
  const auto vertex = [&](const Ring& ring, int side) {
    const Eigen::Vector3d radial = axes.radial(side, kSides);
    const Eigen::Vector3d normal = ring.normal_radial * radial + ring.normal_axial * axes.axis;
    return MarkVertex{(ring.centre_m + ring.radius_m * radial).cast<float>(), normal.cast<float>(), colour};
  };
  for (int side = 0; side < kSides; ++side) {
    const MarkVertex a = vertex(low, side);
    const MarkVertex b = vertex(low, side + 1);
    const MarkVertex c = vertex(high, side + 1);
    const MarkVertex d = vertex(high, side);
    out.insert(out.end(), {a, b, c, a, c, d});
  }
}

void add_cap(std::vector<MarkVertex>& out, const Axes& axes, const Eigen::Vector3d& centre_m, double radius_m,
             double outwards, const std::array<float, 4>& colour) {
  add_band(out, axes, {centre_m, 0.0, 0.0, outwards}, {centre_m, radius_m, 0.0, outwards}, colour);
}

void add_triangle(std::vector<MarkVertex>& out, const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                  const Eigen::Vector3d& c, const std::array<float, 4>& colour) {
  for (const Eigen::Vector3d& p_m : {a, b, c})
    out.push_back({p_m.cast<float>(), Eigen::Vector3f::Zero(), colour});
}

void add_ring(std::vector<MarkVertex>& out, const Eigen::Vector3d& centre_m, double radius_m,
              double inner_radius_m, const std::array<float, 4>& paint) {
  const Axes axes(Eigen::Vector3d::UnitZ());
  for (int side = 0; side < kDiscSides; ++side) {
    const Eigen::Vector3d a = axes.radial(side, kDiscSides);
    const Eigen::Vector3d b = axes.radial(side + 1, kDiscSides);
    add_triangle(out, centre_m + inner_radius_m * a, centre_m + radius_m * a, centre_m + radius_m * b, paint);
    if (inner_radius_m > 0.0)
      add_triangle(out, centre_m + inner_radius_m * a, centre_m + radius_m * b, centre_m + inner_radius_m * b,
                   paint);
  }
}

}  // namespace

void add_sphere(Marks& marks, const Eigen::Vector3d& centre_m, double radius_m, const Colour& colour) {
  const Axes axes(Eigen::Vector3d::UnitZ());
  const auto ring = [&](int i) {
    const double latitude_rad = std::numbers::pi * (static_cast<double>(i) / kRings - 0.5);
    return Ring{centre_m + radius_m * std::sin(latitude_rad) * axes.axis, radius_m * std::cos(latitude_rad),
                std::cos(latitude_rad), std::sin(latitude_rad)};
  };
  for (int i = 0; i < kRings; ++i) add_band(marks.solid, axes, ring(i), ring(i + 1), rgba(colour, 1.0));
}

void add_rod(Marks& marks, const Eigen::Vector3d& from_m, const Eigen::Vector3d& to_m, double radius_m,
             const Colour& colour) {
  if (!((to_m - from_m).norm() > 0.0)) return;
  const Axes axes(to_m - from_m);
  const std::array<float, 4> paint = rgba(colour, 1.0);
  add_band(marks.solid, axes, {from_m, radius_m, 1.0, 0.0}, {to_m, radius_m, 1.0, 0.0}, paint);
  add_cap(marks.solid, axes, from_m, radius_m, -1.0, paint);
  add_cap(marks.solid, axes, to_m, radius_m, 1.0, paint);
}

void add_arrow(Marks& marks, const Eigen::Vector3d& tail_m, const Eigen::Vector3d& tip_m, double radius_m,
               const Colour& colour) {
  const double length_m = (tip_m - tail_m).norm();
  if (!(length_m > 0.0)) return;
  const Axes axes(tip_m - tail_m);
  const double scale = std::min(1.0, length_m / (kHeadLength * radius_m));
  const double head_m = scale * kHeadLength * radius_m;
  const double head_radius_m = scale * kHeadRadius * radius_m;
  const Eigen::Vector3d neck_m = tip_m - head_m * axes.axis;
  if (length_m > head_m) add_rod(marks, tail_m, neck_m, radius_m, colour);
  const double slant_m = std::hypot(head_m, head_radius_m);
  const Ring base{neck_m, head_radius_m, head_m / slant_m, head_radius_m / slant_m};
  const Ring tip{tip_m, 0.0, base.normal_radial, base.normal_axial};
  add_band(marks.solid, axes, base, tip, rgba(colour, 1.0));
  add_cap(marks.solid, axes, neck_m, head_radius_m, -1.0, rgba(colour, 1.0));
}

void add_disc(Marks& marks, const Eigen::Vector3d& centre_m, double radius_m, double inner_radius_m,
              const Colour& colour, double opacity) {
  add_ring(marks.flat, centre_m, radius_m, inner_radius_m, rgba(colour, opacity));
}

void add_solid_disc(Marks& marks, const Eigen::Vector3d& centre_m, double radius_m, double inner_radius_m,
                    const Colour& colour) {
  add_ring(marks.solid, centre_m, radius_m, inner_radius_m, rgba(colour, 1.0));
}

void add_polygon(Marks& marks, std::span<const Eigen::Vector3d> corners_m, const Colour& colour,
                 double opacity) {
  for (std::size_t i = 2; i < corners_m.size(); ++i)
    add_triangle(marks.flat, corners_m[0], corners_m[i - 1], corners_m[i], rgba(colour, opacity));
}

void add_line(Marks& marks, std::span<const Eigen::Vector3d> points_m, double width_m, bool closed,
              const Colour& colour, double opacity) {
  const std::size_t segments = points_m.size() < 2 ? 0 : points_m.size() - (closed ? 0 : 1);
  for (std::size_t i = 0; i < segments; ++i) {
    const Eigen::Vector3d& from_m = points_m[i];
    const Eigen::Vector3d& to_m = points_m[(i + 1) % points_m.size()];
    const Eigen::Vector3d along = to_m - from_m;
    if (!(along.head<2>().norm() > 0.0)) continue;
    const Eigen::Vector3d aside = 0.5 * width_m * Eigen::Vector3d(-along.y(), along.x(), 0.0).normalized();
    add_triangle(marks.flat, from_m - aside, to_m - aside, to_m + aside, rgba(colour, opacity));
    add_triangle(marks.flat, from_m - aside, to_m + aside, from_m + aside, rgba(colour, opacity));
  }
}

}  // namespace koboshi::view
