#include "studio/soles/sole_picture.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "sim_board/world/gravity.h"
#include "sim_board/world/support_polygon.h"
#include "view/render/footprints.h"
#include "view/render/playback.h"

namespace koboshi::studio {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// The axes of the picture on the ground.
class SoleAxes {
 public:
  SoleAxes(const view::Scene& scene, const std::vector<view::Pose>& links) {
    Vector3d forward_W = Vector3d::Zero();
    for (std::size_t side = 0; side < 2; ++side) {
      for (const Vector3d& corner_m : view::sole_corners_W_m(scene, links, side))
        origin_W_m_ += 0.5 * corner_m.head<2>() / static_cast<double>(scene.soles_L[side].size());
      const view::Pose& sole = links[static_cast<std::size_t>(scene.sole_links[side])];
      forward_W += (sole.q_WL * Eigen::Vector3f::UnitX()).cast<double>();
    }
    if (forward_W.head<2>().norm() > 1e-6) x_W_ = forward_W.head<2>().normalized();
  }
  Vector2d flat(const Vector2d& p_W_m) const {
    const Vector2d offset_m = p_W_m - origin_W_m_;
    return {x_W_.dot(offset_m), x_W_.x() * offset_m.y() - x_W_.y() * offset_m.x()};
  }

 private:
  Vector2d origin_W_m_ = Vector2d::Zero();
  Vector2d x_W_ = Vector2d::UnitX();
};

// The centres of mass of samples, by index from `first` on.
struct ComTrack {
  std::size_t first = 0;
  std::vector<Vector3d> com_W_m;

  const Vector3d& at(std::size_t sample) const { return com_W_m[sample - first]; }
  bool has(std::size_t sample) const { return sample >= first && sample - first < com_W_m.size(); }
};

ComTrack track_com(const view::Recording& recording, std::size_t first, std::size_t last) {
  ComTrack track{first == 0 ? 0 : first - 1, {}};
  const std::size_t end = std::min(last + 2, recording.samples.size());
  for (std::size_t i = track.first; i < end; ++i)
    track.com_W_m.push_back(view::centre_of_mass_W_m(recording.scene, recording.samples[i].links));
  return track;
}

double lowest_sole_m(const view::Scene& scene, const std::vector<view::Pose>& links) {
  double lowest_m = std::numeric_limits<double>::infinity();
  for (std::size_t side = 0; side < 2; ++side)
    for (const Vector3d& corner_m : view::sole_corners_W_m(scene, links, side))
      lowest_m = std::min(lowest_m, corner_m.z());
  return lowest_m;
}

Vector2d capture_point_W_m(const view::Recording& recording, const ComTrack& track, std::size_t sample) {
  const std::size_t before = track.has(sample - 1) && sample > 0 ? sample - 1 : sample;
  const std::size_t after = track.has(sample + 1) ? sample + 1 : sample;
  const double time_s =
      1e-6 * static_cast<double>(recording.samples[after].time_us - recording.samples[before].time_us);
  if (!(time_s > 0.0)) return Vector2d::Constant(std::numeric_limits<double>::quiet_NaN());
  const Vector2d speed = (track.at(after) - track.at(before)).head<2>() / time_s;
  const double height_m =
      std::max(0.0, track.at(sample).z() - lowest_sole_m(recording.scene, recording.samples[sample].links));
  return track.at(sample).head<2>() + speed * std::sqrt(height_m / sim_board::kGravity_m_per_s2);
}

void finish(SolePoint point, std::vector<SolePoint>& points) {
  point.now_m = point.trail_m.back();
  const auto is_known = [](const Vector2d& p_m) { return p_m.allFinite(); };
  if (std::ranges::any_of(point.trail_m, is_known)) points.push_back(std::move(point));
}

}  // namespace

std::optional<SolePicture> sole_picture(const view::Recording& recording, std::uint64_t time_us) {
  const view::Scene& scene = recording.scene;
  if (recording.samples.empty() || scene.sole_links[0] < 0 || scene.sole_links[1] < 0) return std::nullopt;
  const std::size_t now = view::sample_at(recording, time_us);
  const view::Sample& sample = recording.samples[now];
  const std::size_t first =
      view::sample_at(recording, sample.time_us > kSoleTrail_us ? sample.time_us - kSoleTrail_us : 0);
  const SoleAxes axes(scene, sample.links);
  SolePicture picture;
  for (std::size_t side = 0; side < 2; ++side) {
    for (const Vector3d& corner_m : view::sole_corners_W_m(scene, sample.links, side))
      picture.soles_m[side].push_back(axes.flat(corner_m.head<2>()));
    picture.carry[side] = view::touches_ground(sample, scene.sole_links[side]);
  }
  for (const Vector2d& corner_m : view::support_polygon_W_m(scene, sample))
    picture.support_m.push_back(axes.flat(corner_m));
  const ComTrack track = track_com(recording, first, now);
  SolePoint com{.kind = SolePoint::Kind::kCom};
  SolePoint capture{.kind = SolePoint::Kind::kCapturePoint};
  for (std::size_t i = first; i <= now; ++i) {
    com.trail_m.push_back(axes.flat(track.at(i).head<2>()));
    capture.trail_m.push_back(axes.flat(capture_point_W_m(recording, track, i)));
  }
  finish(std::move(com), picture.points);
  finish(std::move(capture), picture.points);
  for (const view::ZmpSignals& zmp : view::zmp_signals(recording)) {
    SolePoint point{.kind = SolePoint::Kind::kZmp, .mark = zmp.mark};
    for (std::size_t i = first; i <= now; ++i)
      point.trail_m.push_back(axes.flat(zmp.at(recording.samples[i])));
    if (point.trail_m.back().allFinite() && picture.support_m.size() >= 3) {
      // kZmpMarks ends with the true one.
      if (picture.judged == nullptr || zmp.mark > picture.judged) {
        picture.judged = zmp.mark;
        picture.margin_m = sim_board::distance_inside(picture.support_m, point.trail_m.back());
      }
    }
    finish(std::move(point), picture.points);
  }
  return picture;
}

}  // namespace koboshi::studio
