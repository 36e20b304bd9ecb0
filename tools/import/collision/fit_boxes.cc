#include "tools/import/collision/fit_boxes.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "base/text/error.h"
#include "base/text/user_units.h"
#include "tools/import/decide/role_joints.h"

namespace koboshi::tools {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;

constexpr double kMinSide_m = 0.002;
constexpr double kMicron_m = 1e-6;
// Points of a foot this far above its lowest one touch the ground, too: studs, fillets, rubber.
constexpr double kSole_m = 0.003;

// `with_visuals`: where a link has no collision shape.
std::vector<Vector3d> points_of(const ImportedLink& link, bool with_visuals) {
  std::vector<Vector3d> points;
  const auto add = [&points](const std::vector<ImportedShape>& shapes) {
    for (const ImportedShape& shape : shapes)
      if (shape.surface)
        for (const Eigen::Vector3f& vertex : shape.surface->vertices_m)
          points.push_back(shape.X_LG * vertex.cast<double>());
  };
  add(link.collisions);
  if (points.empty() && with_visuals) add(link.visuals);
  return points;
}

// The part of a foot that touches the ground, up to the top of the foot or the ankle.
AlignedBox3d sole_of(const std::vector<Vector3d>& points) {
  double lowest = std::numeric_limits<double>::infinity();
  double highest = -lowest;
  for (const Vector3d& point : points) {
    lowest = std::min(lowest, point.z());
    highest = std::max(highest, point.z());
  }
  AlignedBox3d sole;
  for (const Vector3d& point : points)
    if (point.z() <= lowest + kSole_m) sole.extend(point);
  sole.min().z() = lowest;
  sole.max().z() = std::max(lowest + kMinSide_m, std::min(highest, 0.0));
  return sole;
}

double corner_error_m(const AlignedBox3d& box, const std::vector<Vector3d>& points) {
  double error_m = 0.0;
  for (int corner = 0; corner < 8; ++corner) {
    const Vector3d p = box.corner(static_cast<AlignedBox3d::CornerType>(corner));
    double nearest_m = std::numeric_limits<double>::infinity();
    for (const Vector3d& point : points) nearest_m = std::min(nearest_m, (p - point).norm());
    error_m = std::max(error_m, nearest_m);
  }
  return error_m;
}

void widen(AlignedBox3d& box) {
  for (int axis = 0; axis < 3; ++axis) {
    const double missing_m = kMinSide_m - (box.max()[axis] - box.min()[axis]);
    if (missing_m <= 0.0) continue;
    box.min()[axis] -= 0.5 * missing_m;
    box.max()[axis] += 0.5 * missing_m;
  }
}

AlignedBox3d mirrored(const AlignedBox3d& box) {
  AlignedBox3d image = box;
  image.min().y() = -box.max().y();
  image.max().y() = -box.min().y();
  return image;
}

AlignedBox3d rounded(const AlignedBox3d& box) {
  const auto round = [](double value) { return std::round(value / kMicron_m) * kMicron_m; };
  return {box.min().unaryExpr(round), box.max().unaryExpr(round)};
}

// The mean of both sides, so that no side wins.
void mirror_boxes(const ImportedRobot& robot, std::vector<AlignedBox3d>& boxes) {
  for (std::size_t i = 0; i < robot.links.size(); ++i) {
    if (!robot.links[i].name.starts_with("left_")) continue;
    for (std::size_t k = 0; k < robot.links.size(); ++k) {
      if (robot.links[k].name != mirrored_name(robot.links[i].name)) continue;
      if (boxes[i].isEmpty() && boxes[k].isEmpty()) continue;
      const AlignedBox3d image = boxes[k].isEmpty() ? boxes[i] : mirrored(boxes[k]);
      const AlignedBox3d& own = boxes[i].isEmpty() ? image : boxes[i];
      boxes[i] = AlignedBox3d(0.5 * (own.min() + image.min()), 0.5 * (own.max() + image.max()));
      boxes[k] = mirrored(boxes[i]);
    }
  }
}

// In a file with collision shapes, a link without any is meant to make no contacts, unless the file gives
// them to a few links only, such as the feet of a robot that is never to fall.
bool gives_collisions(const ImportedRobot& robot) {
  const auto with_collisions =
      std::ranges::count_if(robot.links, [](const ImportedLink& link) { return !link.collisions.empty(); });
  const auto with_shapes = std::ranges::count_if(robot.links, [](const ImportedLink& link) {
    return !link.collisions.empty() || !link.visuals.empty();
  });
  return 2 * with_collisions > with_shapes;
}

}  // namespace

void fit_boxes(ImportedRobot& robot, bool symmetric, ImportReport& report) {
  std::vector<AlignedBox3d> boxes(robot.links.size());
  const bool has_collisions = gives_collisions(robot);
  for (std::size_t i = 0; i < robot.links.size(); ++i) {
    const ImportedLink& link = robot.links[i];
    const bool is_foot = link.name == "left_foot" || link.name == "right_foot";
    const std::vector<Vector3d> points = points_of(link, is_foot || !has_collisions);
    if (points.empty()) {
      if (is_foot)
        throw InputError(robot.file, link.line, "the foot " + link.name + " without a shape", "a sole");
      continue;
    }
    for (const Vector3d& point : points) boxes[i].extend(point);
    if (is_foot) boxes[i] = sole_of(points);
    widen(boxes[i]);
    report.normalised.push_back(fmt::format("{}: a box instead of its shape, corners up to {:.1f} mm from it",
                                            link.name, kMmPerM * corner_error_m(boxes[i], points)));
  }
  if (symmetric) mirror_boxes(robot, boxes);
  for (std::size_t i = 0; i < robot.links.size(); ++i) {
    robot.links[i].collisions.clear();
    if (boxes[i].isEmpty()) continue;
    const AlignedBox3d box = rounded(boxes[i]);
    ImportedShape shape{.kind = ShapeKind::kBox, .size_m = box.sizes()};
    shape.X_LG.translation() = box.center();
    robot.links[i].collisions.push_back(std::move(shape));
  }
}

}  // namespace koboshi::tools
