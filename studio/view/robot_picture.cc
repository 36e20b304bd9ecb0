#include "studio/view/robot_picture.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <utility>

#include "base/text/user_units.h"
#include "studio/view/camera_control.h"
#include "view/render/playback.h"

namespace koboshi::studio {
namespace {

// Share of the distance between two links by which they are shown apart.
constexpr double kExplosion = 0.8;

void append(view::Marks& marks, const view::Marks& more) {
  marks.flat.insert(marks.flat.end(), more.flat.begin(), more.flat.end());
  marks.solid.insert(marks.solid.end(), more.solid.begin(), more.solid.end());
}

}  // namespace

RobotPicture::RobotPicture() {
  drawn_.camera.azimuth_rad = 50.0 * kRadPerDegree;
  drawn_.camera.elevation_rad = 14.0 * kRadPerDegree;
}

void RobotPicture::set_scene(view::Scene scene, const sim_board::RobotDescription* robot) {
  scene_ = std::move(scene);
  ++scene_version_;
  picker_ = Picker(scene_);
  drawn_.links.clear();
  links_.clear();
  layers_.set_robot(robot);
  model_.set_robot(robot);
  ghost_links_.clear();
  onion_.clear();
  tints_.clear();
  update_ghosts();
  drawn_.marks = {};
  framed_ = false;
  followed_W_m_.reset();
}

void RobotPicture::set_shapes(view::Scene scene, const sim_board::RobotDescription& robot) {
  if (scene.links.size() != scene_.links.size()) return set_scene(std::move(scene), &robot);
  scene_ = std::move(scene);
  ++scene_version_;
  picker_ = Picker(scene_);
  layers_.set_robot(&robot);
  model_.set_robot(&robot);
}

void RobotPicture::show_robot(std::vector<view::Pose> links, view::Marks marks, double aspect) {
  links_ = std::move(links);
  drawn_.links = apart(links_);
  drawn_.marks = std::move(marks);
  if (!framed_) look_at_robot(aspect);
  follow_robot();
}

void RobotPicture::show_ghost(std::vector<view::Pose> links) {
  ghost_links_ = std::move(links);
  update_ghosts();
}

void RobotPicture::show_onion(std::vector<view::Ghost> poses) {
  onion_ = std::move(poses);
  update_ghosts();
}

void RobotPicture::show_limits(view::Marks marks, std::vector<view::Tint> tints) {
  limit_marks_ = std::move(marks);
  tints_ = std::move(tints);
  update_ghosts();
}

void RobotPicture::set_collisions(bool collisions) {
  drawn_.collisions = collisions;
  update_overlaps();
}

void RobotPicture::set_exploded(bool exploded) {
  exploded_ = exploded;
  drawn_.links = apart(links_);
  update_ghosts();
  update_overlaps();
}

void RobotPicture::set_follow(bool follow) {
  follow_ = follow;
  followed_W_m_.reset();
}

// Links that are shown apart penetrate nothing.
void RobotPicture::update_overlaps() { layers_.overlaps = drawn_.collisions && !exploded_; }

void RobotPicture::update_ghosts() {
  ghost_ = apart(ghost_links_);
  drawn_.ghosts.clear();
  drawn_.tints = ghost_.empty() ? tints_ : std::vector<view::Tint>();
  if (!ghost_.empty()) drawn_.ghosts.push_back({.links = ghost_, .tints = tints_});
  for (const view::Ghost& pose : onion_) {
    if (pose.links.size() != scene_.links.size()) continue;
    drawn_.ghosts.push_back(pose);
    drawn_.ghosts.back().links = apart(pose.links);
  }
}

std::vector<view::Pose> RobotPicture::apart(const std::vector<view::Pose>& links) const {
  return exploded_ && links.size() == scene_.links.size() ? exploded(scene_, links, kExplosion) : links;
}

void RobotPicture::look_from(double azimuth_rad, double elevation_rad) {
  drawn_.camera.azimuth_rad = azimuth_rad;
  drawn_.camera.elevation_rad = elevation_rad;
  raise_above(drawn_.camera, scene_.planes);
}

void RobotPicture::look_at_robot(double aspect) {
  if (drawn_.links.empty()) return;
  Eigen::AlignedBox3d box;
  for (const view::Pose& pose : drawn_.links) box.extend(pose.p_WL_m.cast<double>());
  constexpr double kAroundOrigins_m = 0.06;            // limbs reach beyond the origins of their links
  constexpr double kLowest_rad = 6.0 * kRadPerDegree;  // that of the view from the front
  drawn_.camera.target_W_m = box.center();
  drawn_.camera.elevation_rad = std::max(drawn_.camera.elevation_rad, kLowest_rad);
  drawn_.camera.distance_m = view::distance_to_fit(drawn_.camera, std::max(1.0, aspect),
                                                   0.5 * box.diagonal().norm() + kAroundOrigins_m);
  raise_above(drawn_.camera, scene_.planes);
  framed_ = true;
  followed_W_m_.reset();
}

void RobotPicture::look_at(const Eigen::Vector3d& place_W_m) {
  drawn_.camera.target_W_m = place_W_m;
  raise_above(drawn_.camera, scene_.planes);
}

void RobotPicture::orbit(const Eigen::Vector2d& drag_px, int height_px) {
  studio::orbit(drawn_.camera, drag_px, height_px);
  raise_above(drawn_.camera, scene_.planes);
}

void RobotPicture::pan(const Eigen::Vector2d& drag_px, int height_px) {
  studio::pan(drawn_.camera, drag_px, height_px);
  lift_above(drawn_.camera, scene_.planes);
}

void RobotPicture::zoom(double factor) {
  studio::zoom(drawn_.camera, factor);
  raise_above(drawn_.camera, scene_.planes);
}

// Moves the camera along the ground as the trunk does.
void RobotPicture::follow_robot() {
  if (!follow_ || drawn_.links.empty()) return;
  const Eigen::Vector3d now_m = drawn_.links.front().p_WL_m.cast<double>();
  if (followed_W_m_) drawn_.camera.target_W_m.head<2>() += (now_m - *followed_W_m_).head<2>();
  followed_W_m_ = now_m;
  lift_above(drawn_.camera, scene_.planes);
}

view::Marks RobotPicture::marks() const {
  view::Marks marks = drawn_.marks;
  append(marks, limit_marks_);
  layers_.add(marks, scene_, drawn_.links);
  model_.add(marks, drawn_.links);
  return marks;
}

Eigen::Vector3d RobotPicture::point_W_m(const Hit& hit) const {
  const view::Pose& pose = drawn_.links[static_cast<std::size_t>(hit.link)];
  return pose.q_WL.cast<double>() * hit.p_L_m + pose.p_WL_m.cast<double>();
}

std::optional<Hit> RobotPicture::link_at(const PicturePlace& place) const {
  return picker_.pick(drawn_.links, ray_through(camera(), place.width_px, place.height_px, place.pixel));
}

std::optional<Hit> RobotPicture::link_near(const PicturePlace& place) const {
  const auto any = [](int) { return true; };
  const auto found =
      pick_near(picker_, drawn_.links, camera(), place.width_px, place.height_px, place.pixel, any);
  return found ? std::optional(found->hit) : std::nullopt;
}

std::optional<Hit> RobotPicture::posed_link_at(const PicturePlace& place) const {
  return picker_.pick(posed(), ray_through(camera(), place.width_px, place.height_px, place.pixel));
}

}  // namespace koboshi::studio
