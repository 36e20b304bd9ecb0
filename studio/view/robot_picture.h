#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "studio/view/link_layers.h"
#include "studio/view/model_layer.h"
#include "studio/view/picking.h"
#include "view/recording/recording.h"
#include "view/render/renderer.h"

namespace koboshi::studio {

// A place in a picture of this size, in pixels from its upper left corner.
struct PicturePlace {
  int width_px = 1;
  int height_px = 1;
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
};

// A robot and its ground as a view shows them, and from where: the robot, a translucent second one, more of
// them, marks, and the camera, which can follow the robot. It needs no window.
class RobotPicture {
 public:
  RobotPicture();

  // Shows another robot, with the camera on it once it is posed. `robot` gives the axes of its joints, and
  // the pairs of links whose penetration is outlined in red beside the collision shapes; without it, neither
  // is shown.
  void set_scene(view::Scene scene, const sim_board::RobotDescription* robot);
  // Replaces the shapes of the same links; camera, poses and marks stay.
  void set_shapes(view::Scene scene, const sim_board::RobotDescription& robot);
  // Poses by index of Scene::links, and marks of this instant. `aspect` is the picture's width by its height.
  void show_robot(std::vector<view::Pose> links, view::Marks marks, double aspect);
  // A second robot in the scene, translucent; empty: none.
  void show_ghost(std::vector<view::Pose> links);
  // More translucent robots, which cannot be dragged; each hides what is behind it of the later ones.
  void show_onion(std::vector<view::Ghost> poses);
  // Marks of joints at their limits, and colours of the links of the robot that can be posed, by link; empty:
  // their own.
  void show_limits(view::Marks marks, std::vector<view::Tint> tints);

  void set_collisions(bool collisions);
  void set_link_frames(bool frames) { layers_.frames = frames; }
  void set_joint_axes(bool axes) { layers_.axes = axes; }
  void set_inertias(bool inertias) { model_.inertias = inertias; }
  // Marks a link with its frame and the axis of its joint; -1: none.
  void set_chosen_link(int link) { model_.chosen_link = link; }
  // Shows the links apart from each other.
  void set_exploded(bool exploded);
  // The camera goes with the robot.
  void set_follow(bool follow);

  void look_from(double azimuth_rad, double elevation_rad);
  void look_at_robot(double aspect);
  void look_at(const Eigen::Vector3d& place_W_m);
  // Turns the camera around its target, moves it, or changes its distance, as a drag of so many pixels does.
  void orbit(const Eigen::Vector2d& drag_px, int height_px);
  void pan(const Eigen::Vector2d& drag_px, int height_px);
  void zoom(double factor);

  const view::Scene& scene() const { return scene_; }
  // Changes with each set_scene and set_shapes.
  std::uint64_t scene_version() const { return scene_version_; }
  const view::Camera& camera() const { return drawn_.camera; }
  // The picture that is drawn, but for the marks that marks() adds.
  const view::Picture& drawn() const { return drawn_; }
  bool can_be_drawn() const { return !scene_.links.empty() && drawn_.links.size() == scene_.links.size(); }
  // All marks: those of this instant, of limits, and of the links.
  view::Marks marks() const;
  // The robot that can be posed, by index of Scene::links: the second robot if there is one.
  const std::vector<view::Pose>& posed() const { return ghost_.empty() ? drawn_.links : ghost_; }
  bool has_ghost() const { return !ghost_.empty(); }
  bool has_onion() const { return !onion_.empty(); }
  // Poses as given; those that are drawn may be apart.
  const std::vector<view::Pose>& links() const { return links_; }
  const LinkLayers& layers() const { return layers_; }
  const Picker& picker() const { return picker_; }

  // The link under a place, or the nearest within kNear_px.
  std::optional<Hit> link_at(const PicturePlace& place) const;
  std::optional<Hit> link_near(const PicturePlace& place) const;
  // The link under a place of the robot that can be posed.
  std::optional<Hit> posed_link_at(const PicturePlace& place) const;
  Eigen::Vector3d point_W_m(const Hit& hit) const;

 private:
  void update_ghosts();
  void update_overlaps();
  std::vector<view::Pose> apart(const std::vector<view::Pose>& links) const;
  void follow_robot();

  view::Scene scene_;
  std::uint64_t scene_version_ = 0;
  Picker picker_;
  view::Picture drawn_;
  std::vector<view::Pose> links_;
  std::vector<view::Pose> ghost_links_;  // as given
  std::vector<view::Pose> ghost_;        // as drawn
  std::vector<view::Ghost> onion_;
  std::vector<view::Tint> tints_;
  view::Marks limit_marks_;
  LinkLayers layers_;
  ModelLayer model_;
  bool exploded_ = false;
  bool framed_ = false;  // the camera has looked at this robot
  bool follow_ = true;
  std::optional<Eigen::Vector3d> followed_W_m_;
};

}  // namespace koboshi::studio
