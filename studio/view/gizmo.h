#pragma once

#include <Eigen/Core>
#include <limits>
#include <optional>

#include "view/render/camera.h"
#include "view/render/marks.h"

namespace koboshi::studio {

// Three arrows along the world's axes by which a body is moved along one of them, and three rings about the
// same axes by which it is rotated.
struct Gizmo {
  Eigen::Vector3d p_W_m = Eigen::Vector3d::Zero();
  double length_m = 0.1;  // of the arrows
  bool rotates = false;   // whether there are rings

  double ring_m() const;  // radius of the rings
};

// The part of a gizmo that the mouse grabs.
struct Handle {
  enum class Kind { kArrow, kRing };
  Kind kind = Kind::kArrow;
  int axis = 0;  // of the world: x, y, z
  bool operator==(const Handle&) const = default;
};

// A handle beside a pixel.
struct NearHandle {
  Handle handle;
  double distance_px = 0.0;
};

// Length of the arrows as a share of the camera's distance: they keep their size on the screen.
inline constexpr double kGizmoShare = 0.09;

// The colour of an axis: x red, y green, z blue, as in RViz; yellow if it is chosen.
[[nodiscard]] view::Colour gizmo_colour(int axis, bool chosen);
// Adds the half of each ring that faces the camera; a ring that is seen from its axis is shown entirely.
void add_gizmo(view::Marks& marks, const Gizmo& gizmo, const view::Camera& camera,
               const std::optional<Handle>& chosen);
// The arrow under the pixel; without one, the ring under it. Only the outer part of the gizmo counts, so that
// the body can be grabbed at its centre; only what add_gizmo shows; and no ring behind `surface_m`, the
// distance from the eye to what is seen at the pixel.
[[nodiscard]] std::optional<Handle> pick_handle(const Gizmo& gizmo, const view::Camera& camera, int width_px,
                                                int height_px, const Eigen::Vector2d& pixel,
                                                double surface_m = std::numeric_limits<double>::infinity());
// The arrow or ring that is seen nearest to the pixel and less than `reach_px` from it; otherwise as
// pick_handle().
[[nodiscard]] std::optional<NearHandle> nearest_handle(const Gizmo& gizmo, const view::Camera& camera,
                                                       int width_px, int height_px,
                                                       const Eigen::Vector2d& pixel, double surface_m,
                                                       double reach_px);
// The displacement along an axis whose image is the drag's share along the arrow's image; zero for an axis
// that points at the camera.
[[nodiscard]] Eigen::Vector3d along_axis_W_m(const Gizmo& gizmo, int axis, const view::Camera& camera,
                                             int width_px, int height_px, const Eigen::Vector2d& drag_px);
// The rotation vector of a drag: about the camera's up axis and its right axis, half a turn across the
// height of the picture.
[[nodiscard]] Eigen::Vector3d rotation_W_rad(const view::Camera& camera, int height_px,
                                             const Eigen::Vector2d& drag_px);

}  // namespace koboshi::studio
