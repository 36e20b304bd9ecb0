#pragma once

#include <Eigen/Core>
#include <optional>

#include "studio/view/gizmo.h"

namespace koboshi::studio {

// The point of the shown part of a ring whose image is nearest to a pixel.
struct RingPoint {
  double distance_px = 0.0;  // from the pixel; infinite if no part is shown
  double from_eye_m = 0.0;
};
[[nodiscard]] RingPoint nearest_on_ring(const Gizmo& gizmo, int axis, const view::Camera& camera,
                                        int width_px, int height_px, const Eigen::Vector2d& pixel);
// The half of a ring that faces the camera; the whole ring if its axis is within 6 degrees of the line of
// sight, or if `entire`.
void add_ring(view::Marks& marks, const Gizmo& gizmo, int axis, const view::Camera& camera, bool entire,
              const view::Colour& colour);

// A rotation about an axis of the world by a drag of a ring: by the angle that the mouse sweeps about the
// centre in the plane of the ring, where the ray through the pixel meets it. Turns are counted. Near the
// centre, where the direction is uncertain, the angle stays.
//
// The image of a ring that is seen within 12 degrees of edge-on is nearly a line, and the ray meets its
// plane at a grazing angle. The near side of that ring follows the mouse along the line: 1 rad per radius of
// the ring.
class RingDrag {
 public:
  // Begins at this pixel.
  RingDrag(const Gizmo& gizmo, int axis, const view::Camera& camera, int width_px, int height_px,
           const Eigen::Vector2d& pixel);

  void move_to(const view::Camera& camera, int width_px, int height_px, const Eigen::Vector2d& pixel);
  // Since the beginning; positive is counter-clockwise as seen from the tip of the axis.
  double angle_rad() const { return angle_rad_; }
  Eigen::Vector3d rotation_W_rad() const { return angle_rad_ * Eigen::Vector3d::Unit(axis_); }
  bool is_edge_on() const { return is_edge_on_; }
  // The ring with a spoke where the drag began and one where it is now.
  void add(view::Marks& marks, const view::Camera& camera) const;

 private:
  std::optional<double> direction_rad(const view::Camera& camera, int width_px, int height_px,
                                      const Eigen::Vector2d& pixel) const;

  Gizmo gizmo_;
  int axis_;
  bool is_edge_on_ = false;
  Eigen::Vector2d start_px_;
  Eigen::Vector2d tangent_px_ = Eigen::Vector2d::Zero();  // image of one radius along the near side
  double start_rad_ = 0.0;
  double angle_rad_ = 0.0;
};

}  // namespace koboshi::studio
