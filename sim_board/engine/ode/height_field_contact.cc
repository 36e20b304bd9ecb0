#include "sim_board/engine/ode/height_field_contact.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace koboshi::sim_board {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr std::size_t kCorners = 8;

Vector3d corner(std::size_t number, const Vector3d& half_m) {
  return {(number & 1U) != 0 ? half_m.x() : -half_m.x(), (number & 2U) != 0 ? half_m.y() : -half_m.y(),
          (number & 4U) != 0 ? half_m.z() : -half_m.z()};
}

// Returns the number of points of a grid row below a length.
std::size_t points_below(double length_m, double spacing_m, int points) {
  return static_cast<std::size_t>(std::min(length_m / spacing_m + 2.0, static_cast<double>(points)));
}

}  // namespace

HeightFieldContact::HeightFieldContact(const HeightField& field, const Vector3d& largest_half_m)
    : field_(field), X_FW_(field.X_WF.inverse()), highest_m_(*std::ranges::max_element(field.heights_m)) {
  const double diagonal_m = 2.0 * largest_half_m.norm();
  const Vector2d spacing_m = field.spacing_m();
  points_.reserve(kCorners + points_below(diagonal_m, spacing_m.x(), field.columns) *
                                 points_below(diagonal_m, spacing_m.y(), field.rows));
}

std::span<const HeightFieldContact::Point> HeightFieldContact::touch(const Isometry3d& X_WG,
                                                                     const Vector3d& half_m, double reach_m,
                                                                     std::size_t most) {
  points_.clear();
  const Isometry3d X_FG = X_FW_ * X_WG;
  const Vector3d extent_m = (X_FG.linear().cwiseAbs() * half_m).array() + reach_m;
  const bool beside =
      ((X_FG.translation().head<2>().cwiseAbs() - extent_m.head<2>()).array() > 0.5 * field_.size_m.array())
          .any();
  if (beside || X_FG.translation().z() - extent_m.z() > highest_m_) return {};
  add_corners(X_FG, half_m, reach_m);
  add_grid_points(X_FG, half_m, reach_m);
  spread(most);
  for (Point& point : points_) {
    point.p_W = field_.X_WF * point.p_W;
    point.n_W = field_.X_WF.linear() * point.n_W;
  }
  return points_;
}

void HeightFieldContact::add_corners(const Isometry3d& X_FG, const Vector3d& half_m, double reach_m) {
  for (std::size_t number = 0; number < kCorners; ++number) {
    const Vector3d p_F = X_FG * corner(number, half_m);
    const auto place = field_.at(p_F.head<2>());
    if (!place) continue;
    const double depth_m = (place->height_m - p_F.z()) * place->normal_F.z();
    if (depth_m > -reach_m) points_.push_back({p_F, place->normal_F, depth_m});
  }
}

void HeightFieldContact::add_grid_points(const Isometry3d& X_FG, const Vector3d& half_m, double reach_m) {
  const Vector2d extent_m = (X_FG.linear().cwiseAbs() * half_m).head<2>().array() + reach_m;
  const Vector2d spacing_m = field_.spacing_m();
  const Vector2d first =
      (X_FG.translation().head<2>() - extent_m + 0.5 * field_.size_m).cwiseQuotient(spacing_m);
  const Vector2d last =
      (X_FG.translation().head<2>() + extent_m + 0.5 * field_.size_m).cwiseQuotient(spacing_m);
  const int last_row = static_cast<int>(std::min(last.y(), field_.rows - 1.0));
  const int last_column = static_cast<int>(std::min(last.x(), field_.columns - 1.0));
  for (int row = static_cast<int>(std::ceil(std::max(first.y(), 0.0))); row <= last_row; ++row)
    for (int column = static_cast<int>(std::ceil(std::max(first.x(), 0.0))); column <= last_column; ++column)
      add_grid_point(field_.point_F(column, row), X_FG, half_m, reach_m);
}

// A point below a face is outside along the axis of that face only.
void HeightFieldContact::add_grid_point(const Vector3d& p_F, const Isometry3d& X_FG, const Vector3d& half_m,
                                        double reach_m) {
  const Vector3d p_G = X_FG.linear().transpose() * (p_F - X_FG.translation());
  const Vector3d inside_m = half_m - p_G.cwiseAbs();
  if (inside_m.minCoeff() <= -reach_m || (inside_m.array() <= 0.0).count() > 1) return;
  double depth_m = std::numeric_limits<double>::infinity();
  Vector3d n_F = Vector3d::UnitZ();
  for (int axis = 0; axis < 3; ++axis) {
    const Vector3d into_box_F = X_FG.linear().col(axis) * (p_G[axis] > 0.0 ? -1.0 : 1.0);
    // The ground pushes sideways or upwards, never downwards into the box.
    if (into_box_F.z() < -1e-9 || inside_m[axis] >= depth_m) continue;
    depth_m = inside_m[axis];
    n_F = into_box_F;
  }
  const bool is_beside = inside_m.minCoeff() <= 0.0 && depth_m > 0.0;
  if (std::isfinite(depth_m) && !is_beside) points_.push_back({p_F, n_F, depth_m});
}

void HeightFieldContact::spread(std::size_t most) {
  if (points_.size() <= most) return;
  const auto deepest = std::ranges::max_element(points_, {}, &Point::depth_m);
  std::swap(points_.front(), *deepest);
  for (std::size_t kept = 1; kept < most; ++kept) {
    std::size_t farthest = kept;
    double farthest_m = -1.0;
    for (std::size_t i = kept; i < points_.size(); ++i) {
      double nearest_m = std::numeric_limits<double>::infinity();
      for (std::size_t k = 0; k < kept; ++k)
        nearest_m = std::min(nearest_m, (points_[i].p_W - points_[k].p_W).squaredNorm());
      if (nearest_m > farthest_m) {
        farthest_m = nearest_m;
        farthest = i;
      }
    }
    std::swap(points_[kept], points_[farthest]);
  }
  points_.resize(most, points_.front());
}

}  // namespace koboshi::sim_board
