#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <span>
#include <vector>

#include "tools/studio/view/camera_control.h"
#include "tools/view/recording/recording.h"

namespace koboshi::studio {

// A point on the surface of a link.
struct Hit {
  int link = 0;
  double distance_m = 0.0;  // from the origin of the ray
  Eigen::Vector3d p_L_m = Eigen::Vector3d::Zero();
};

// Finds the visible surface of a robot that a ray meets first.
class Picker {
 public:
  Picker() = default;
  // The scene must outlive this.
  explicit Picker(const view::Scene& scene);

  // `links` are the poses by index of Scene::links. Nothing if the ray meets no link.
  std::optional<Hit> pick(std::span<const view::Pose> links, const Ray& ray) const;

 private:
  // A shape with the box that holds it, in the frame of its geometry.
  struct Target {
    const view::Shape* shape;
    int link;
    Eigen::AlignedBox3d bounds;
  };

  std::vector<Target> targets_;
};

}  // namespace koboshi::studio
