#include "sim_board/world/placement.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace koboshi::sim_board {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr double kNever_m = -std::numeric_limits<double>::infinity();

struct Box {
  Isometry3d X_WG;
  Vector3d half_m;

  double reach_m(const Vector3d& axis_W) const {
    return (X_WG.linear().transpose() * axis_W).cwiseAbs().dot(half_m);
  }
};

std::vector<Box> boxes_of(const RobotDescription& robot, std::span<const Isometry3d> X_WLs) {
  std::vector<Box> boxes;
  for (std::size_t l = 0; l < robot.links.size(); ++l)
    for (const BoxDescription& box : robot.links[l].collisions)
      boxes.push_back({X_WLs[l] * box.X_LG, 0.5 * box.size_m});
  return boxes;
}

double lift_onto_plane(const Box& box, const GroundDescription& ground) {
  const Vector3d& normal_W = ground.normal_W;
  const double depth_m =
      box.reach_m(normal_W) - normal_W.dot(box.X_WG.translation()) + ground.offset_m * normal_W.norm();
  return depth_m / normal_W.z();
}

// Returns the upward displacement of `box` at which this axis, of any length, separates it from the other;
// kNever_m if no displacement does.
double lift_along(const Vector3d& axis_W, const Box& box, const Box& other) {
  const Vector3d upward_W = axis_W.z() < 0.0 ? Vector3d(-axis_W) : axis_W;
  const double length = upward_W.norm();
  if (length < 1e-9)
    return std::numeric_limits<double>::infinity();  // cross product of parallel edges: not
                                                     // an axis
  const double reach_m = box.reach_m(upward_W) + other.reach_m(upward_W);
  const double apart_m = upward_W.dot(box.X_WG.translation() - other.X_WG.translation());
  if (upward_W.z() > 1e-9 * length) return (reach_m - apart_m) / upward_W.z();
  return std::abs(apart_m) >= reach_m ? kNever_m : std::numeric_limits<double>::infinity();
}

double lift_onto_box(const Box& box, const Box& other) {
  double lift_m = std::numeric_limits<double>::infinity();
  const auto consider = [&](const Vector3d& axis_W) {
    lift_m = std::min(lift_m, lift_along(axis_W, box, other));
  };
  for (int i = 0; i < 3; ++i) {
    consider(box.X_WG.linear().col(i));
    consider(other.X_WG.linear().col(i));
    for (int j = 0; j < 3; ++j) consider(box.X_WG.linear().col(i).cross(other.X_WG.linear().col(j)));
  }
  return lift_m;
}

double lift_onto_points(const Box& box, const HeightField& field) {
  double lift_m = kNever_m;
  for (int row = 0; row < field.rows; ++row) {
    for (int column = 0; column < field.columns; ++column) {
      const Box point{field.X_WF * Eigen::Translation3d(field.point_F(column, row)), Vector3d::Zero()};
      lift_m = std::max(lift_m, lift_onto_box(box, point));
    }
  }
  return lift_m;
}

double lift_corners_onto(const Box& box, const HeightField& field) {
  double lift_m = kNever_m;
  const Isometry3d X_FG = field.X_WF.inverse() * box.X_WG;
  const Vector3d up_F = field.X_WF.linear().transpose() * Vector3d::UnitZ();
  for (int corner = 0; corner < 8; ++corner) {
    const Vector3d signs((corner & 1) - 0.5, ((corner >> 1) & 1) - 0.5, ((corner >> 2) & 1) - 0.5);
    const Vector3d p_F = X_FG * (2.0 * signs.cwiseProduct(box.half_m));
    if (const auto place = field.at(p_F.head<2>()))
      lift_m =
          std::max(lift_m, (place->height_m - p_F.z()) * place->normal_F.z() / place->normal_F.dot(up_F));
  }
  return lift_m;
}

}  // namespace

double lift_onto_ground(const RobotDescription& robot, std::span<const Isometry3d> X_WLs,
                        const GroundDescription& ground) {
  double lift_m = kNever_m;
  for (const Box& box : boxes_of(robot, X_WLs)) {
    if (ground.present) lift_m = std::max(lift_m, lift_onto_plane(box, ground));
    for (const GroundBox& other : ground.boxes)
      lift_m = std::max(lift_m, lift_onto_box(box, {other.X_WG, 0.5 * other.size_m}));
    for (const HeightField& field : ground.height_fields)
      lift_m = std::max({lift_m, lift_onto_points(box, field), lift_corners_onto(box, field)});
  }
  return lift_m == kNever_m ? 0.0 : lift_m;
}

}  // namespace koboshi::sim_board
