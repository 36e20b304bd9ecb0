#include <Eigen/Geometry>

#include <fmt/format.h>

#include "tools/robot_file/check/checked_model.h"

namespace koboshi::tools {
namespace {

using Eigen::Vector3d;

// An inertia with respect to that of a uniform box around the link's shapes. Mass at the corners has three
// times as much; a servo within a wide bracket has a tenth. Set by hand (2026-11-24).
constexpr double kMostInertia = 3.3;
constexpr double kLeastInertia = 1.0 / 40.0;

void extend(Eigen::AlignedBox3d& extent, const sim_board::BoxDescription& box) {
  for (int corner = 0; corner < 8; ++corner) {
    const Vector3d sign((corner & 1) != 0 ? 0.5 : -0.5, (corner & 2) != 0 ? 0.5 : -0.5,
                        (corner & 4) != 0 ? 0.5 : -0.5);
    extent.extend(box.X_LG * sign.cwiseProduct(box.size_m));
  }
}

// The box around all shapes of a link, in its frame.
Eigen::AlignedBox3d extent_of(const sim_board::LinkDescription& link, MeshStore& meshes) {
  Eigen::AlignedBox3d extent;
  for (const auto* boxes : {&link.visual_boxes, &link.collisions})
    for (const sim_board::BoxDescription& box : *boxes) extend(extent, box);
  for (const sim_board::MeshDescription& description : link.meshes) {
    const auto& mesh = meshes.of(description.file).stl.mesh;
    if (!mesh) continue;
    for (const Eigen::Vector3f& vertex : mesh->vertices_m)
      extent.extend(description.X_LG * vertex.cast<double>().cwiseProduct(description.scale));
  }
  return extent;
}

}  // namespace

void check_inertias(CheckedModel& model) {
  for (const sim_board::LinkDescription& link : model.robot.links) {
    const Eigen::AlignedBox3d extent = extent_of(link, model.meshes);
    if (extent.isEmpty()) continue;
    const Vector3d size_m = extent.sizes();
    for (int axis = 0; axis < 3; ++axis) {
      const double square_m2 = size_m.squaredNorm() - size_m(axis) * size_m(axis);
      const double uniform_kg_m2 = link.mass_kg * square_m2 / 12.0;
      const double share = link.I_LCom_L(axis, axis) / uniform_kg_m2;
      if (share <= kMostInertia && share >= kLeastInertia) continue;
      model.warn(
          "R002", model.places.of("link", link.name, "inertial"),
          fmt::format(
              "an inertia of {} about its {} axis of {:.2g} kg m^2, {:.2g} times that of a uniform box "
              "around its shapes",
              link.name, "xyz"[axis], link.I_LCom_L(axis, axis), share),
          fmt::format("{:.3f} to {:.1f} times", kLeastInertia, kMostInertia),
          fmt::format("A uniform box has {:.3g} kg m^2.", uniform_kg_m2));
      break;
    }
  }
}

}  // namespace koboshi::tools
