#pragma once

#include <Eigen/Geometry>
#include <span>
#include <vector>

#include "sim_board/description/description.h"
#include "view/recording/recording.h"
#include "view/render/marks.h"

namespace koboshi::studio {

// The uniform ellipsoid with the mass and the inertia of a link, as in Drake and MuJoCo.
struct InertiaEllipsoid {
  int link = 0;
  Eigen::Isometry3d X_LE = Eigen::Isometry3d::Identity();  // at the centre of mass, along the principal axes
  Eigen::Vector3d radii_m = Eigen::Vector3d::Zero();
};

// One for each link, in their order.
[[nodiscard]] std::vector<InertiaEllipsoid> inertia_ellipsoids(const sim_board::RobotDescription& robot);

// Draws the ellipsoids as three rings each, in the principal planes.
void add_inertia_ellipsoids(view::Marks& marks, std::span<const view::Pose> links,
                            std::span<const InertiaEllipsoid> ellipsoids);

}  // namespace koboshi::studio
