#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "view/recording/recording.h"
#include "view/render/camera.h"

namespace koboshi::view {

enum class CameraMotion {
  kFixed,   // the robot's whole way is in the picture
  kOrbit,   // around the robot's way
  kFollow,  // beside the robot
};

// Where the camera is during a film. Without a value, distance and target are those at which the robot, for
// kFixed and kOrbit its whole way, is in the picture.
struct CameraChoice {
  CameraMotion motion = CameraMotion::kFollow;
  double azimuth_rad = 0.9;
  double elevation_rad = 0.2;
  double orbit_rad_per_s = 0.52;  // one turn in 12 s
  std::optional<double> distance_m{};
  std::optional<Eigen::Vector3d> target_W_m{};
};

// An interval of a recording.
struct Interval {
  std::uint64_t from_us = 0;
  std::uint64_t to_us = 0;
};

class CameraPath {
 public:
  // For pictures of this aspect, width divided by height. The recording must outlive this.
  CameraPath(const Recording& recording, const CameraChoice& choice, const Interval& shown, double aspect);
  Camera at(std::uint64_t time_us) const;

 private:
  Eigen::Vector3d followed_W_m(std::uint64_t time_us) const;

  const Recording& recording_;
  CameraChoice choice_;
  Interval shown_;
  Camera camera_;                 // at the beginning
  double height_m_ = 0.0;         // of the target above the lowest link, following
  std::vector<double> lowest_m_;  // height of the lowest link, by sample
};

}  // namespace koboshi::view
