#pragma once

#include <Eigen/Core>
#include <optional>

#include "tools/view/render/camera.h"
#include "tools/view/render/marks.h"

namespace koboshi::studio {

// Three arrows along the world's axes by which a body is moved along one of them.
struct Gizmo {
  Eigen::Vector3d p_W_m = Eigen::Vector3d::Zero();
  double length_m = 0.1;
};

// Length of the arrows as a share of the camera's distance: they keep their size on the screen.
inline constexpr double kGizmoShare = 0.09;

// x red, y green, z blue, as in RViz; the chosen axis is yellow.
void add_gizmo(view::Marks& marks, const Gizmo& gizmo, std::optional<int> chosen);
// The axis whose arrow is under the pixel; the outer part only, so that the body can be grabbed.
[[nodiscard]] std::optional<int> pick_axis(const Gizmo& gizmo, const view::Camera& camera, int width_px,
                                           int height_px, const Eigen::Vector2d& pixel);
// The displacement along an axis whose image is the drag's share along the arrow's image; zero for an axis
// that points at the camera.
[[nodiscard]] Eigen::Vector3d along_axis_W_m(const Gizmo& gizmo, int axis, const view::Camera& camera,
                                             int width_px, int height_px, const Eigen::Vector2d& drag_px);
// The rotation vector of a drag: about the camera's up axis and its right axis, half a turn across the
// height of the picture.
[[nodiscard]] Eigen::Vector3d rotation_W_rad(const view::Camera& camera, int height_px,
                                             const Eigen::Vector2d& drag_px);

}  // namespace koboshi::studio
