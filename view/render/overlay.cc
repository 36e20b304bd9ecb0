#include "view/render/overlay.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "sim_board/world/foot.h"
#include "sim_board/world/support_polygon.h"

namespace koboshi::view {
namespace {

constexpr std::uint64_t kFade_us = 8'000'000;  // age at which a footprint vanishes
constexpr double kMinForce_N = 0.3;            // a smaller contact force is not drawn
constexpr double kArrow_m = 0.0022;            // radius of an arrow's shaft
constexpr double kPushArrow_m = 0.0035;
constexpr double kLine_m = 0.0022;
constexpr double kLift_m = 0.0008;  // of a body that lies on the ground

std::vector<Eigen::Vector3d> ground_contacts_W_m(const Sample& sample) {
  std::vector<Eigen::Vector3d> points_W_m;
  for (const ContactForce& contact : sample.contacts) {
    if (contact.other_link < 0 && contact.f_W_N.norm() > 0.0F)
      points_W_m.push_back(contact.p_W_m.cast<double>());
  }
  return points_W_m;
}

bool carries(const Sample& sample, int link) {
  return std::ranges::any_of(sample.contacts, [link](const ContactForce& contact) {
    return contact.link == link && contact.other_link < 0 && contact.f_W_N.norm() > 0.0F;
  });
}

std::vector<Eigen::Vector2d> plan_view(const std::vector<Eigen::Vector3d>& points_m) {
  std::vector<Eigen::Vector2d> result;
  std::ranges::transform(points_m, std::back_inserter(result),
                         [](const Eigen::Vector3d& p) -> Eigen::Vector2d { return p.head<2>(); });
  return result;
}

}  // namespace

std::vector<Eigen::Vector2d> support_polygon_W_m(const Scene& scene, const Sample& sample) {
  std::vector<Eigen::Vector2d> points_m;
  const bool is_only_a_plane = scene.planes.size() == 1 && scene.ground.empty();
  for (std::size_t side = 0; side < scene.sole_links.size() && is_only_a_plane; ++side) {
    if (!carries(sample, scene.sole_links[side])) continue;
    for (const Eigen::Vector3d& corner_m : sole_corners_W_m(scene, sample.links, side))
      if (scene.planes[0].normal_W.dot(corner_m) - scene.planes[0].offset_m < sim_board::kTouching_m)
        points_m.emplace_back(corner_m.head<2>());
  }
  const std::size_t corners = points_m.size();
  for (const Eigen::Vector2d& contact_m : plan_view(ground_contacts_W_m(sample))) {
    const auto is_at = [&](const Eigen::Vector2d& corner_m) {
      return (corner_m - contact_m).norm() < sim_board::kTouching_m;
    };
    if (std::none_of(points_m.begin(), points_m.begin() + static_cast<std::ptrdiff_t>(corners), is_at))
      points_m.push_back(contact_m);
  }
  return sim_board::convex_hull(std::move(points_m));
}

Eigen::Vector2d ZmpSignals::at(const Sample& sample) const {
  return {static_cast<double>(sample.values[signals[0]]), static_cast<double>(sample.values[signals[1]])};
}

std::vector<ZmpSignals> zmp_signals(const Recording& recording) {
  std::vector<ZmpSignals> found;
  for (const ZmpMark& mark : kZmpMarks) {
    const auto x = find_signal(recording, std::string(mark.signal) + "_x");
    const auto y = find_signal(recording, std::string(mark.signal) + "_y");
    if (x && y) found.push_back({{*x, *y}, &mark});
  }
  return found;
}

OverlayMarks::OverlayMarks(const Recording& recording, const Overlays& overlays)
    : recording_(recording), overlays_(overlays) {
  follow(0);
  if (overlays.has(Overlay::kZmp)) zmps_ = zmp_signals(recording);
}

void OverlayMarks::follow(std::size_t first_sample) {
  if (overlays_.has(Overlay::kFootprints)) footprints_.follow(recording_, first_sample);
}

double OverlayMarks::ground_m(const Sample& sample, const Eigen::Vector2d& p_W_m) const {
  double nearest_m = std::numeric_limits<double>::infinity();
  double height_m = 0.0;
  if (!recording_.scene.planes.empty()) {
    const Plane& plane = recording_.scene.planes.front();
    height_m = (plane.offset_m - plane.normal_W.head<2>().dot(p_W_m)) / plane.normal_W.z();
  }
  for (const Eigen::Vector3d& contact_W_m : ground_contacts_W_m(sample)) {
    const double distance_m = (contact_W_m.head<2>() - p_W_m).norm();
    if (distance_m >= nearest_m) continue;
    nearest_m = distance_m;
    height_m = std::max(height_m, contact_W_m.z());
  }
  return height_m;
}

void OverlayMarks::add_footprints_at(Marks& marks, std::uint64_t time_us) const {
  for (const Footprint& print : footprints_.at(time_us, kFade_us)) {
    if (print.corners_W_m.size() < 3) continue;
    const std::uint64_t age_us = time_us > print.end_us ? time_us - print.end_us : 0;
    const double opacity = 1.0 - static_cast<double>(age_us) / static_cast<double>(kFade_us);
    add_polygon(marks, print.corners_W_m, kSideColours[print.side], 0.16 * opacity);
    add_line(marks, print.corners_W_m, kLine_m, true, kSideColours[print.side], 0.75 * opacity);
  }
}

void OverlayMarks::add_support(Marks& marks, const Sample& sample) const {
  std::vector<Eigen::Vector3d> hull_W_m;
  for (const Eigen::Vector2d& corner_m : support_polygon_W_m(recording_.scene, sample))
    hull_W_m.emplace_back(corner_m.x(), corner_m.y(), ground_m(sample, corner_m));
  if (hull_W_m.size() < 3) return;
  add_polygon(marks, hull_W_m, kMeasuredColour, 0.14);
  add_line(marks, hull_W_m, kLine_m, true, kMeasuredColour, 0.8);
}

void OverlayMarks::add_zmp(Marks& marks, const Sample& sample) const {
  for (const ZmpSignals& zmp : zmps_) {
    const Eigen::Vector2d p_m = zmp.at(sample);
    if (!p_m.allFinite()) continue;
    add_solid_disc(marks, {p_m.x(), p_m.y(), ground_m(sample, p_m) + kLift_m}, zmp.mark->radius_m,
                   zmp.mark->inner_radius_m, zmp.mark->colour);
  }
}

void OverlayMarks::add_com(Marks& marks, std::uint64_t time_us, const Sample& sample) const {
  const Eigen::Vector3d com_m = centre_of_mass_W_m(recording_.scene, poses_at(recording_, time_us));
  const Eigen::Vector3d below_m(com_m.x(), com_m.y(), ground_m(sample, com_m.head<2>()));
  add_sphere(marks, com_m, 0.011, kComColour);
  add_rod(marks, com_m, below_m, 0.0012, kComColour);
  add_disc(marks, below_m, 0.011, 0.008, kComColour, 1.0);
}

void OverlayMarks::add_contacts(Marks& marks, const Sample& sample) const {
  for (const ContactForce& contact : sample.contacts) {
    if (contact.f_W_N.norm() < static_cast<float>(kMinForce_N)) continue;
    const Eigen::Vector3d tail_m = contact.p_W_m.cast<double>();
    add_arrow(marks, tail_m, tail_m + kForceScale_m_per_N * contact.f_W_N.cast<double>(), kArrow_m,
              kContactColour);
  }
}

// The tip is where the force acts.
void OverlayMarks::add_pushes(Marks& marks, std::uint64_t time_us) const {
  const std::vector<Pose> poses = poses_at(recording_, time_us);
  for (const Push& push : recording_.pushes) {
    if (time_us < push.start_us || time_us >= push.end_us) continue;
    const Pose& link = poses[static_cast<std::size_t>(push.link)];
    const Eigen::Vector3d tip_m = link.p_WL_m.cast<double>() + link.q_WL.cast<double>() * push.p_L_m;
    add_arrow(marks, tip_m - kForceScale_m_per_N * push.f_W_N, tip_m, kPushArrow_m, kPushColour);
  }
}

Marks OverlayMarks::at(std::uint64_t time_us) const {
  Marks marks;
  const Sample& sample = recording_.samples[sample_at(recording_, time_us)];
  add_footprints_at(marks, time_us);
  if (overlays_.has(Overlay::kSupport)) add_support(marks, sample);
  add_zmp(marks, sample);
  if (overlays_.has(Overlay::kCom)) add_com(marks, time_us, sample);
  if (overlays_.has(Overlay::kContacts)) add_contacts(marks, sample);
  if (overlays_.has(Overlay::kPushes)) add_pushes(marks, time_us);
  return marks;
}

}  // namespace koboshi::view
