#pragma once

#include <Eigen/Core>

namespace koboshi::view {

// A perspective camera that looks at a point, with the world's z axis upwards in the picture.
struct Camera {
  Eigen::Vector3d target_W_m = Eigen::Vector3d::Zero();
  double azimuth_rad = 0.0;    // from which side: 0 from ahead (+x), pi/2 from the robot's left (+y)
  double elevation_rad = 0.0;  // above the horizon; the camera keeps off the zenith by 1e-3
  double distance_m = 1.5;
  double field_of_view_rad = 0.42;  // vertical; narrow, so that near limbs do not look large

  Eigen::Vector3d eye_W_m() const;
  // World to camera: x to the right, y up, z towards the viewer.
  Eigen::Matrix4f view() const;
  // Camera to clip coordinates of OpenGL. `aspect` is width divided by height.
  Eigen::Matrix4f projection(double aspect) const;
};

// Orthographic projection of the box [-half_width, half_width]^2 x [-far, -near] to clip coordinates.
Eigen::Matrix4f orthographic(double half_width_m, double near_m, double far_m);
// The rigid transform to a frame at `eye` that looks along `forward`, with `up` upwards.
Eigen::Matrix4f look_along(const Eigen::Vector3d& eye_m, const Eigen::Vector3d& forward,
                           const Eigen::Vector3d& up);

// The position in a picture, in pixels from its upper left corner; nothing behind the camera is asked for.
Eigen::Vector2d project(const Camera& camera, int width_px, int height_px, const Eigen::Vector3d& p_W_m);

// The distance from which a sphere about the target just fits into the picture.
double distance_to_fit(const Camera& camera, double aspect, double radius_m);

}  // namespace koboshi::view
