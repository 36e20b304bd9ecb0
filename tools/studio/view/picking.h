#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "tools/studio/view/camera_control.h"
#include "tools/view/recording/recording.h"

namespace koboshi::studio {

// A point on the surface of a link.
struct Hit {
  int link = 0;
  double distance_m = 0.0;  // from the origin of the ray
  Eigen::Vector3d p_L_m = Eigen::Vector3d::Zero();
};

// The first visible surface of a robot that a ray meets, or nothing. `links` are the poses by index of Scene::links.
std::optional<Hit> pick(const view::Scene& scene, std::span<const view::Pose> links, const Ray& ray);

}  // namespace koboshi::studio
