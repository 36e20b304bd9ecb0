#include "view/render/footprints.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <iterator>

namespace koboshi::view {
namespace {

constexpr std::uint64_t kStill_us = 150'000;
constexpr double kMoved_m = 0.010;

bool has_moved(const Footprint& from, const std::vector<Eigen::Vector3d>& corners_W_m) {
  for (std::size_t i = 0; i < corners_W_m.size(); ++i) {
    if ((from.corners_W_m[i] - corners_W_m[i]).norm() > kMoved_m) return true;
  }
  return false;
}

bool is_long(const Footprint& print) { return print.end_us - print.start_us >= kStill_us; }

}  // namespace

bool touches_ground(const Sample& sample, int link) {
  return std::ranges::any_of(sample.contacts,
                             [link](const ContactForce& c) { return c.link == link && c.other_link < 0; });
}

std::vector<Eigen::Vector3d> sole_corners_W_m(const Scene& scene, const std::vector<Pose>& links,
                                              std::size_t side) {
  std::vector<Eigen::Vector3d> corners_W_m;
  if (scene.sole_links[side] < 0) return corners_W_m;
  const Pose& pose = links[static_cast<std::size_t>(scene.sole_links[side])];
  Eigen::Isometry3d X_WL = Eigen::Isometry3d::Identity();
  X_WL.linear() = pose.q_WL.cast<double>().toRotationMatrix();
  X_WL.translation() = pose.p_WL_m.cast<double>();
  for (const Eigen::Vector3d& corner_L : scene.soles_L[side]) corners_W_m.push_back(X_WL * corner_L);
  return corners_W_m;
}

// A print that ends later was open at the last sample that stays.
void Footprints::forget_after(Foot& foot, const Recording& recording, std::size_t first_sample) {
  if (first_sample == 0) {
    foot = {};
    return;
  }
  const std::uint64_t last_us = recording.samples[first_sample - 1].time_us;
  std::erase_if(foot.prints, [&](const Footprint& print) { return print.start_us > last_us; });
  foot.is_open = !foot.prints.empty() && foot.prints.back().end_us >= last_us;
  if (foot.is_open) foot.prints.back().end_us = last_us;
}

void Footprints::add(Foot& foot, std::size_t side, const Scene& scene, const Sample& sample) {
  if (!touches_ground(sample, scene.sole_links[side])) {
    foot.is_open = false;
    return;
  }
  const auto corners_W_m = sole_corners_W_m(scene, sample.links, side);
  if (foot.is_open && has_moved(foot.prints.back(), corners_W_m)) foot.is_open = false;
  if (!foot.is_open) foot.prints.push_back({sample.time_us, sample.time_us, side, corners_W_m});
  foot.is_open = true;
  foot.prints.back().end_us = sample.time_us;
}

void Footprints::follow(const Recording& recording, std::size_t first_sample) {
  const std::size_t first = std::min(first_sample, recording.samples.size());
  for (std::size_t side = 0; side < feet_.size(); ++side) {
    if (recording.scene.sole_links[side] < 0) continue;
    forget_after(feet_[side], recording, first);
    for (std::size_t i = first; i < recording.samples.size(); ++i)
      add(feet_[side], side, recording.scene, recording.samples[i]);
  }
}

std::vector<Footprint> Footprints::all() const {
  std::vector<Footprint> found;
  for (const Foot& foot : feet_) std::ranges::copy_if(foot.prints, std::back_inserter(found), is_long);
  std::ranges::stable_sort(found, {}, &Footprint::start_us);
  return found;
}

std::vector<Footprint> Footprints::at(std::uint64_t time_us, std::uint64_t age_us) const {
  std::vector<Footprint> found;
  for (const Foot& foot : feet_) {
    auto print = foot.prints.begin();
    if (time_us >= age_us)
      print = std::ranges::upper_bound(foot.prints, time_us - age_us, {}, &Footprint::end_us);
    for (; print != foot.prints.end() && print->start_us <= time_us; ++print)
      if (is_long(*print)) found.push_back(*print);
  }
  std::ranges::stable_sort(found, {}, &Footprint::start_us);
  return found;
}

std::vector<Footprint> footprints(const Recording& recording) {
  Footprints prints;
  prints.follow(recording, 0);
  return prints.all();
}

}  // namespace koboshi::view
