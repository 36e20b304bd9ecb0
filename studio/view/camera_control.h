#pragma once

#include <Eigen/Core>
#include <span>

#include "view/recording/recording.h"
#include "view/render/camera.h"

namespace koboshi::studio {

// Changes of a camera by mouse and keyboard, in pixels of a picture of this height.

// Turns about the target: a drag across the height of the picture turns by half a turn.
void orbit(view::Camera& camera, const Eigen::Vector2d& drag_px, int height_px);
// Moves the target so that what is in its plane stays under the mouse.
void pan(view::Camera& camera, const Eigen::Vector2d& drag_px, int height_px);
// Comes closer by this factor, and goes away for factors below 1; between kNearest_m and kFarthest_m.
void zoom(view::Camera& camera, double factor);
inline constexpr double kNearest_m = 0.05;
inline constexpr double kFarthest_m = 50.0;

// Height above the ground at which the eye stays.
inline constexpr double kClearance_m = 0.02;
// After a turn or a change of the distance: raises the elevation until the eye is kClearance_m above every
// plane of the ground. A target below a plane is lifted to it. Without planes nothing changes.
void raise_above(view::Camera& camera, std::span<const view::Plane> ground);
// After a movement: lifts eye and target together by as much as raise_above() demands of either.
void lift_above(view::Camera& camera, std::span<const view::Plane> ground);

// A half line in the world.
struct Ray {
  Eigen::Vector3d origin_W_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d direction_W = Eigen::Vector3d::UnitX();  // unit vector
};

// The ray through this pixel, counted from the upper left corner.
Ray ray_through(const view::Camera& camera, int width_px, int height_px, const Eigen::Vector2d& pixel);

// The displacement in the plane through `p_W_m` parallel to the picture that a drag by these pixels shows.
Eigen::Vector3d displacement_W_m(const view::Camera& camera, int height_px, const Eigen::Vector3d& p_W_m,
                                 const Eigen::Vector2d& drag_px);

}  // namespace koboshi::studio
