#include "view/render/camera_path.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "view/render/playback.h"

namespace koboshi::view {
namespace {

// Half the span over which a following camera averages the robot's position: longer than a step, so that the
// picture does not sway with the gait, and shorter than a fall and its recovery.
constexpr std::uint64_t kSmoothing_us = 700'000;
// Links are points here; the flesh around them, and some air.
constexpr double kMargin_m = 0.085;

Eigen::AlignedBox3d bounds_W_m(const Sample& sample) {
  Eigen::AlignedBox3d box;
  for (const Pose& link : sample.links) box.extend(link.p_WL_m.cast<double>());
  return box;
}

}  // namespace

CameraPath::CameraPath(const Recording& recording, const CameraChoice& choice, const Interval& shown,
                       double aspect)
    : recording_(recording), choice_(choice), shown_(shown) {
  const std::size_t first = sample_at(recording, shown.from_us);
  const std::size_t last = sample_at(recording, shown.to_us);
  Eigen::AlignedBox3d way;
  double robot_m = 0.0;  // largest extent at any time
  double tallest_m = 0.0;
  for (std::size_t i = 0; i < recording.samples.size(); ++i) {
    const Eigen::AlignedBox3d box = bounds_W_m(recording.samples[i]);
    lowest_m_.push_back(box.min().z());
    robot_m = std::max(robot_m, box.sizes().maxCoeff());
    tallest_m = std::max(tallest_m, box.sizes().z());
    if (i >= first && i <= last) way.extend(box);
  }
  camera_.azimuth_rad = choice.azimuth_rad;
  camera_.elevation_rad = choice.elevation_rad;
  height_m_ = 0.5 * tallest_m;
  const bool follows = choice.motion == CameraMotion::kFollow;
  const double radius_m = kMargin_m + 0.5 * (follows ? robot_m : way.diagonal().norm());
  camera_.distance_m = choice.distance_m.value_or(distance_to_fit(camera_, aspect, radius_m));
  camera_.target_W_m = choice.target_W_m.value_or(way.center());
}

Eigen::Vector3d CameraPath::followed_W_m(std::uint64_t time_us) const {
  const std::size_t first =
      sample_at(recording_, time_us > kSmoothing_us ? time_us - kSmoothing_us : std::uint64_t{0});
  const std::size_t last = sample_at(recording_, time_us + kSmoothing_us);
  // A raised cosine as weight; samples before the begin and after the end count as the nearest.
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double weights = 0.0;
  for (std::size_t i = first; i <= last; ++i) {
    const Sample& sample = recording_.samples[i];
    const double offset = (static_cast<double>(sample.time_us) - static_cast<double>(time_us)) /
                          static_cast<double>(kSmoothing_us);
    const double weight = 1.0 + std::cos(std::numbers::pi * std::clamp(offset, -1.0, 1.0)) + 1e-6;
    Eigen::Vector3d p_m = bounds_W_m(sample).center();
    p_m.z() = lowest_m_[i] + height_m_;
    sum += weight * p_m;
    weights += weight;
  }
  return sum / weights;
}

Camera CameraPath::at(std::uint64_t time_us) const {
  Camera camera = camera_;
  const double elapsed_s = 1e-6 * (static_cast<double>(time_us) - static_cast<double>(shown_.from_us));
  if (choice_.motion == CameraMotion::kOrbit) camera.azimuth_rad += choice_.orbit_rad_per_s * elapsed_s;
  if (choice_.motion == CameraMotion::kFollow && !choice_.target_W_m)
    camera.target_W_m = followed_W_m(time_us);
  return camera;
}

}  // namespace koboshi::view
