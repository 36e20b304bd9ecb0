#pragma once

#include <Eigen/Core>
#include <QImage>
#include <QPoint>
#include <QString>
#include <QTimer>
#include <QWidget>
#include <memory>
#include <optional>
#include <vector>

#include "studio/view/gizmo.h"
#include "studio/view/gl_context.h"
#include "studio/view/link_layers.h"
#include "studio/view/model_layer.h"
#include "studio/view/picking.h"
#include "studio/view/ring.h"
#include "studio/view/scaled_framebuffer.h"
#include "view/recording/recording.h"
#include "view/render/renderer.h"

namespace koboshi::studio {

// Shows a robot and its ground. Drag: turn; drag with Shift or the middle button: move; wheel: distance;
// double click: look at that place; drag a link with Ctrl: push it. Drag of a link that can be posed: move
// it, or along an axis by the arrows at it; by the rings at it: rotate it about an axis, with Ctrl+Shift as
// the picture shows; the right button turns the camera there as well. While the picture moves, its resolution
// follows the machine's speed; 150 ms after that it is drawn in full.
class RobotView final : public QWidget {
  Q_OBJECT

 public:
  // Force of a push per length of the drag.
  static constexpr double kPush_N_per_m = 60.0;
  static constexpr double kMaxPush_N = 60.0;

  // A link that can be posed, the point of it where its arrows begin, and whether it can be rotated.
  struct Posable {
    int link = 0;
    Eigen::Vector3d p_L_m = Eigen::Vector3d::Zero();
    bool rotates = false;
    bool operator==(const Posable&) const = default;
  };

  explicit RobotView(QWidget* parent = nullptr);
  ~RobotView() override;

  // Shows another robot, with the camera on it once it is posed.
  // `robot` gives the axes of its joints, and the pairs of links whose penetration is outlined in red beside
  // the collision shapes; without it, neither is shown.
  void set_scene(view::Scene scene, const sim_board::RobotDescription* robot = nullptr);
  // Replaces the shapes of the same links; camera, poses and marks stay.
  void set_shapes(view::Scene scene, const sim_board::RobotDescription& robot);
  // Marks a link with its frame and the axis of its joint; -1: none.
  void set_chosen_link(int link);
  void set_inertias(bool inertias);
  // Poses by index of Scene::links, and marks of this instant.
  void show_robot(std::vector<view::Pose> links, view::Marks marks);
  // A second robot in the scene, translucent; empty: none.
  void show_ghost(std::vector<view::Pose> links);
  // More translucent robots, which cannot be dragged; each hides what is behind it of the later ones.
  void show_onion(std::vector<view::Ghost> poses);
  void set_collisions(bool collisions);
  void set_link_frames(bool frames);
  void set_joint_axes(bool axes);
  // Shows the links apart from each other.
  void set_exploded(bool exploded);
  // The camera goes with the robot.
  void set_follow(bool follow);
  void set_pushable(bool pushable) { pushable_ = pushable; }
  // The links that can be posed by dragging: of the second robot if there is one. Empty: none.
  void set_posable(std::vector<Posable> links);
  // Marks of joints at their limits, and colours of the links of the robot that can be posed, by link; empty:
  // their own.
  void show_limits(view::Marks marks, std::vector<view::Tint> tints);
  void look_from(double azimuth_rad, double elevation_rad);
  void look_at_robot();

  const view::Scene& scene() const { return scene_; }
  const view::Camera& camera() const { return picture_.camera; }
  // The robot that can be posed, by index of Scene::links: the second robot if there is one.
  const std::vector<view::Pose>& posed() const { return ghost_.empty() ? picture_.links : ghost_; }
  bool has_ghost() const { return !ghost_.empty(); }
  // All that is drawn now.
  const view::Picture& picture() const { return picture_; }
  // The arrows and rings at the link that was under the mouse last; nothing without such a link.
  std::optional<Gizmo> gizmo() const;
  // A link under a place of the widget.
  std::optional<Hit> link_at(const QPointF& place) const;
  // The posable link, and the arrow or ring, under a place of the widget.
  std::optional<Hit> posable_at(const QPointF& place) const;
  std::optional<Handle> gizmo_handle_at(const QPointF& place) const;
  // The thing that a press in the widget grabs: the handle under it, else the posable link under it, else
  // the nearest of both within kNear_px. Nothing of both: none.
  struct Grabbed {
    std::optional<Handle> handle = {};
    std::optional<Hit> link = {};
  };
  Grabbed grabbed_at(const QPointF& place, bool with_handles = true) const;
  // The link under a place of the widget, or the nearest within kNear_px.
  std::optional<Hit> link_near(const QPointF& place) const;
  // Names and places of the shown link frames and joint axes under a place of the widget; empty: none.
  QString mark_text_at(const QPointF& place) const;
  // Whether the picture rests, so that it is drawn in full resolution.
  bool rests() const { return !moving_; }
  // Number of frames drawn so far.
  std::uint64_t frames() const { return frames_; }
  // The error of OpenGL that keeps the view empty; empty: none.
  const QString& error() const { return error_; }

 Q_SIGNALS:
  // At the end of a drag: the point in the link's frame, the force in the world.
  void push_requested(int link, const Eigen::Vector3d& p_L_m, const Eigen::Vector3d& force_W_N);
  // A drag of a posable link begins at this point of the link, continues, and ends. Displacement of the point
  // and rotation vector since the beginning, in the world.
  void pose_drag_began(int link, const Eigen::Vector3d& p_W_m);
  void pose_dragged(const Eigen::Vector3d& displacement_W_m, const Eigen::Vector3d& rotation_W_rad);
  void pose_drag_ended();
  // The link under the mouse, -1: none.
  void hovered(int link);
  // A click without a drag on a link.
  void picked(int link);
  void failed(const QString& error);

 protected:
  void paintEvent(QPaintEvent* event) override;
  void mousePressEvent(QMouseEvent* event) override;
  void mouseMoveEvent(QMouseEvent* event) override;
  void mouseReleaseEvent(QMouseEvent* event) override;
  void mouseDoubleClickEvent(QMouseEvent* event) override;
  void wheelEvent(QWheelEvent* event) override;
  void keyPressEvent(QKeyEvent* event) override;

 private:
  enum class Drag { kNone, kOrbit, kPan, kPush, kPose };
  struct PoseGrab {
    Eigen::Vector3d p_W_m = Eigen::Vector3d::Zero();
    std::optional<Handle> handle = {};  // none: in the plane of the picture
    std::optional<RingDrag> turn = {};  // of a ring
    bool rotates = false;               // freely
  };
  struct PushDrag {
    Hit hit;
    Eigen::Vector3d force_W_N = Eigen::Vector3d::Zero();
  };

  void redraw_moving();
  void update_ghosts();
  void update_overlaps();
  QString frame_text(std::size_t link) const;
  QString axis_text(const JointAxis& axis) const;
  std::vector<view::Pose> apart(const std::vector<view::Pose>& links) const;
  void draw();
  void follow_robot();
  Eigen::Vector3d robot_W_m() const;
  Eigen::Vector3d point_W_m(const Hit& hit) const;
  view::Marks all_marks() const;
  void add_handles(view::Marks& marks) const;
  bool begin_pose_drag(const QMouseEvent& event);
  void continue_pose_drag(const QPointF& place);
  void hover(const QPointF& place);
  bool is_posable(int link) const;
  double surface_m(const QPointF& place) const;
  void pick(const QPointF& place);
  void name_marks(const QPointF& place);

  view::Scene scene_;
  Picker picker_;
  view::Picture picture_;
  std::vector<view::Pose> links_;  // as given; those of the picture may be apart
  std::vector<view::Pose> ghost_links_;
  std::vector<view::Pose> ghost_;  // as drawn
  std::vector<view::Ghost> onion_;
  std::vector<view::Tint> tints_;
  LinkLayers layers_;
  ModelLayer model_;
  bool exploded_ = false;
  bool scene_changed_ = false;
  bool framed_ = false;  // the camera has looked at this robot
  bool follow_ = true;
  bool pushable_ = false;
  std::optional<Eigen::Vector3d> followed_W_m_;

  std::unique_ptr<GlContext> gl_;  // before everything that is made in it
  std::unique_ptr<view::Renderer> renderer_;
  std::unique_ptr<ScaledFramebuffer> framebuffer_;
  QImage image_;  // as drawn last
  AdaptiveResolution resolution_;
  bool moving_ = false;
  QTimer rest_;
  std::uint64_t frames_ = 0;
  QString error_;

  Drag drag_ = Drag::kNone;
  QPointF drag_start_;
  QPointF drag_last_;
  std::optional<PushDrag> push_;
  int hovered_ = -1;
  bool names_marks_ = false;  // the tooltip is that of a mark
  std::vector<Posable> posable_;
  int gizmo_link_ = -1;
  std::optional<Handle> gizmo_handle_;  // under the mouse
  std::optional<PoseGrab> grab_;
  view::Marks limit_marks_;
};

}  // namespace koboshi::studio
