#include "sim_board/world/ground.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

namespace koboshi::sim_board {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// The surface of a convex body below a point is the face through which an upward vertical line leaves it.
double height_above(const GroundBox& box, const Vector3d& p_W) {
  const Vector3d p_G = box.X_WG.inverse() * p_W;
  // Vertical in the world, so that the top of a tilted box (a ramp) is found.
  const Vector3d up_G = box.X_WG.linear().transpose() * Vector3d::UnitZ();
  double enter_m = -kInfinity;
  double leave_m = kInfinity;
  int top = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double half_m = 0.5 * box.size_m[axis];
    if (std::abs(up_G[axis]) < 1e-12) {
      if (std::abs(p_G[axis]) > half_m) return kInfinity;
      continue;
    }
    const double one_m = (-half_m - p_G[axis]) / up_G[axis];
    const double other_m = (half_m - p_G[axis]) / up_G[axis];
    enter_m = std::max(enter_m, std::min(one_m, other_m));
    if (std::max(one_m, other_m) < leave_m) {
      leave_m = std::max(one_m, other_m);
      top = axis;
    }
  }
  if (enter_m > leave_m || enter_m > 0.0) return kInfinity;  // beside or under the box
  return -leave_m * std::abs(up_G[top]);
}

double height_above(const HeightField& field, const Vector3d& p_W) {
  const Vector3d p_F = field.X_WF.inverse() * p_W;
  const auto place = field.at(p_F.head<2>());
  return place ? (p_F.z() - place->height_m) * place->normal_F.z() : kInfinity;
}

}  // namespace

bool FrictionPatch::holds(const Vector3d& p_W) const {
  const Vector2d p_P = (X_WP.inverse() * p_W).head<2>();
  if (outline == Outline::kDisc) return p_P.norm() <= 0.5 * size_m.x();
  return (p_P.cwiseAbs().array() <= 0.5 * size_m.array()).all();
}

Vector2d HeightField::spacing_m() const { return {size_m.x() / (columns - 1), size_m.y() / (rows - 1)}; }

Vector3d HeightField::point_F(int column, int row) const {
  const Vector2d spacing = spacing_m();
  const auto index =
      static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(column);
  return {column * spacing.x() - 0.5 * size_m.x(), row * spacing.y() - 0.5 * size_m.y(), heights_m[index]};
}

std::optional<HeightField::Place> HeightField::at(const Vector2d& xy_F) const {
  const Vector2d cells = (xy_F + 0.5 * size_m).cwiseQuotient(spacing_m());
  if (!(cells.x() >= 0.0) || !(cells.y() >= 0.0) || cells.x() > columns - 1 || cells.y() > rows - 1)
    return std::nullopt;
  const int column = std::min(static_cast<int>(cells.x()), columns - 2);
  const int row = std::min(static_cast<int>(cells.y()), rows - 2);
  const Vector3d lowest_F = point_F(column, row);
  const Vector3d highest_F = point_F(column + 1, row + 1);
  const bool right_of_diagonal = cells.x() - column > cells.y() - row;
  const Vector3d third_F = right_of_diagonal ? point_F(column + 1, row) : point_F(column, row + 1);
  const Vector3d upward_F =
      (highest_F - lowest_F).cross(third_F - lowest_F) * (right_of_diagonal ? -1.0 : 1.0);
  const Vector3d normal_F = upward_F.normalized();
  const Vector2d offset_m = xy_F - lowest_F.head<2>();
  return Place{lowest_F.z() - normal_F.head<2>().dot(offset_m) / normal_F.z(), normal_F};
}

void check(const GroundDescription& ground) {
  if (!(ground.normal_W.norm() > 0.0)) throw std::invalid_argument("the ground's normal is zero");
  for (const FrictionPatch& patch : ground.patches)
    if (!(patch.size_m.minCoeff() > 0.0)) throw std::invalid_argument("a patch of ground has no size");
  for (const GroundBox& box : ground.boxes)
    if (!(box.size_m.minCoeff() > 0.0)) throw std::invalid_argument("a box of the ground has no size");
  for (const HeightField& field : ground.height_fields) {
    const bool has_grid = field.columns >= 2 && field.rows >= 2 && field.size_m.minCoeff() > 0.0;
    if (!has_grid || field.heights_m.size() !=
                         static_cast<std::size_t>(field.columns) * static_cast<std::size_t>(field.rows))
      throw std::invalid_argument("a height field without a height for each point of its grid");
    if (!std::ranges::all_of(field.heights_m, [](double height_m) { return std::isfinite(height_m); }))
      throw std::invalid_argument("a height field with a height that is not finite");
  }
}

GroundBox ramp_box(const Ramp& ramp) {
  const double slope_m = ramp.length_m / std::cos(ramp.angle_rad);
  const double thickness_m =
      slope_m * std::tan(ramp.angle_rad);  // puts the lower edge of the far end on the plane
  GroundBox box;
  box.size_m = {slope_m, ramp.width_m, thickness_m};
  box.X_WG = ramp.X_WR * Eigen::AngleAxisd(-ramp.angle_rad, Vector3d::UnitY()) *
             Eigen::Translation3d(0.5 * slope_m, 0.0, -0.5 * thickness_m);
  return box;
}

std::vector<GroundBox> stair_boxes(const Stairs& stairs) {
  std::vector<GroundBox> boxes;
  for (int tread = 0; tread < stairs.count; ++tread) {
    const double height_m = (tread + 1) * stairs.rise_m;
    GroundBox& box = boxes.emplace_back();
    box.size_m = {stairs.run_m, stairs.width_m, height_m};
    box.X_WG = stairs.X_WR * Eigen::Translation3d((tread + 0.5) * stairs.run_m, 0.0, 0.5 * height_m);
  }
  return boxes;
}

double height_above(const GroundDescription& ground, const Vector3d& p_W) {
  double height_m = kInfinity;
  if (ground.present) height_m = ground.normal_W.normalized().dot(p_W) - ground.offset_m;
  for (const GroundBox& box : ground.boxes) height_m = std::min(height_m, height_above(box, p_W));
  for (const HeightField& field : ground.height_fields)
    height_m = std::min(height_m, height_above(field, p_W));
  return height_m;
}

}  // namespace koboshi::sim_board
