#pragma once

#include <Eigen/Geometry>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "studio/view/camera_control.h"
#include "view/recording/recording.h"

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

// Distance of the mouse from a link or a handle within which a press still grabs it.
inline constexpr double kNear_px = 9.0;

// A hit beside a pixel.
struct NearHit {
  Hit hit;
  double distance_px = 0.0;
};

// The accepted link that is seen nearest to a pixel, at most kNear_px from it, to a third of that. Nothing if
// there is none.
std::optional<NearHit> pick_near(const Picker& picker, std::span<const view::Pose> links,
                                 const view::Camera& camera, int width_px, int height_px,
                                 const Eigen::Vector2d& pixel, const std::function<bool(int link)>& accepts);

}  // namespace koboshi::studio
