#include "studio/view/pose_handles.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <utility>

namespace koboshi::studio {
namespace {

// Distance from the eye to what is seen of the robot that can be posed.
double surface_m(const RobotPicture& picture, const PicturePlace& place) {
  const auto hit = picture.posed_link_at(place);
  return hit ? hit->distance_m : std::numeric_limits<double>::infinity();
}

}  // namespace

bool PoseHandles::set_links(std::vector<Posable> links) {
  if (links == links_) return false;
  links_ = std::move(links);
  hide();
  return true;
}

bool PoseHandles::hover(const Grabbed& grabbed) {
  const bool other_handle = std::exchange(hovered_, grabbed.handle) != grabbed.handle;
  const bool other_link = grabbed.link && std::exchange(link_, grabbed.link->link) != grabbed.link->link;
  return other_handle || other_link;
}

bool PoseHandles::is_posable(int link) const {
  return std::ranges::find(links_, link, &Posable::link) != links_.end();
}

std::optional<Gizmo> PoseHandles::gizmo(const RobotPicture& picture) const {
  const auto found = std::ranges::find(links_, link_, &Posable::link);
  const auto link = static_cast<std::size_t>(link_);
  if (found == links_.end() || link >= picture.posed().size()) return std::nullopt;
  const view::Pose& pose = picture.posed()[link];
  const Eigen::Vector3d p_W_m = pose.p_WL_m.cast<double>() + pose.q_WL.cast<double>() * found->p_L_m;
  return Gizmo{p_W_m, kGizmoShare * picture.camera().distance_m, found->rotates};
}

std::optional<Hit> PoseHandles::link_at(const RobotPicture& picture, const PicturePlace& place) const {
  if (links_.empty()) return std::nullopt;
  const auto hit = picture.posed_link_at(place);
  return hit && is_posable(hit->link) ? hit : std::nullopt;
}

std::optional<Handle> PoseHandles::handle_at(const RobotPicture& picture, const PicturePlace& place) const {
  const auto handles = gizmo(picture);
  if (!handles) return std::nullopt;
  return pick_handle(*handles, picture.camera(), place.width_px, place.height_px, place.pixel,
                     surface_m(picture, place));
}

PoseHandles::Grabbed PoseHandles::grabbed_at(const RobotPicture& picture, const PicturePlace& place,
                                             bool with_handles) const {
  if (links_.empty()) return {};
  const auto handles = with_handles ? gizmo(picture) : std::nullopt;
  if (handles)
    if (const auto handle = handle_at(picture, place)) return {.handle = handle};
  if (const auto link = link_at(picture, place)) return {.link = link};
  const auto handle = handles ? nearest_handle(*handles, picture.camera(), place.width_px, place.height_px,
                                               place.pixel, surface_m(picture, place), kNear_px)
                              : std::nullopt;
  const auto link = pick_near(picture.picker(), picture.posed(), picture.camera(), place.width_px,
                              place.height_px, place.pixel, [this](int one) { return is_posable(one); });
  if (handle && (!link || handle->distance_px <= link->distance_px)) return {.handle = handle->handle};
  return link ? Grabbed{.link = link->hit} : Grabbed{};
}

}  // namespace koboshi::studio
