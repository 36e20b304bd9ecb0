#include "sim_board/engine/ode/near_boxes.h"

#include <algorithm>
#include <array>

#include "sim_board/engine/ode/eigen.h"
#include "sim_board/world/box_overlap.h"

namespace koboshi::sim_board {
namespace {

using Eigen::Vector3d;

// Normals of the moved box within this cosine of its move are those of the surfaces that are about to meet.
// Others belong to a face beside the way.
constexpr double kSameWay = 0.9;
// A point of the moved box this near to a touching one, along the surface, is that point.
constexpr double kSamePoint_m = 1e-4;

Vector3d half_of(dGeomID box) {
  dVector3 size;
  dGeomBoxGetLengths(box, size);
  return 0.5 * vector_of(size);
}

std::size_t collide(dGeomID box, dGeomID other, std::span<dContactGeom> points) {
  if (points.empty()) return 0;
  return static_cast<std::size_t>(
      dCollide(box, other, static_cast<int>(points.size()), points.data(), sizeof(dContactGeom)));
}

}  // namespace

Bounds bounds_of(dGeomID geom) {
  Bounds bounds;
  dGeomGetAABB(geom, bounds.data());
  return bounds;
}

std::size_t NearBoxes::find(dGeomID box, dGeomID other, bool may_touch, double reach_m,
                            std::span<dContactGeom> points) {
  const std::size_t touching = may_touch ? collide(box, other, points) : 0;
  return reach_m > 0.0 ? find_gaps(box, other, reach_m, touching, points) : touching;
}

std::size_t NearBoxes::find_gaps(dGeomID box, dGeomID other, double reach_m, std::size_t touching,
                                 std::span<dContactGeom> points) {
  const Eigen::Isometry3d X_WB = pose_of(box);
  Vector3d n_W;
  if (touching > 0) {
    n_W = vector_of(points[0].normal);
  } else {
    const BoxSeparation separation = box_separation(X_WB, half_of(box), pose_of(other), half_of(other));
    if (separation.gap_m > reach_m) return 0;
    n_W = separation.n_W;
  }
  const Vector3d p_W = X_WB.translation() - reach_m * n_W;
  const Vector3d size_m = 2.0 * half_of(box);
  dGeomBoxSetLengths(probe_.get(), size_m.x(), size_m.y(), size_m.z());
  dGeomSetPosition(probe_.get(), p_W.x(), p_W.y(), p_W.z());
  dGeomSetRotation(probe_.get(), dGeomGetRotation(box));

  const auto is_touching = [&](const dContactGeom& point) {
    return std::ranges::any_of(points.first(touching), [&](const dContactGeom& touch) {
      const Vector3d way_W = vector_of(point.pos) - vector_of(touch.pos);
      return (way_W - n_W.dot(way_W) * n_W).norm() < kSamePoint_m;
    });
  };
  const std::span<dContactGeom> free = points.subspan(touching);
  const std::size_t found = collide(probe_.get(), other, free);
  std::size_t count = touching;
  for (dContactGeom& point : free.first(found)) {
    const double share = n_W.dot(vector_of(point.normal));
    point.depth -= share * reach_m;
    if (share < kSameWay || (touching > 0 && (point.depth >= 0.0 || is_touching(point)))) continue;
    point.depth = std::min(point.depth, 0.0);
    point.g1 = box;
    points[count++] = point;
  }
  return count;
}

}  // namespace koboshi::sim_board
