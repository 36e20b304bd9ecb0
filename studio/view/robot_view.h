#pragma once

#include <Eigen/Core>
#include <QImage>
#include <QPoint>
#include <QString>
#include <QTimer>
#include <QWidget>
#include <optional>
#include <vector>

#include "studio/view/picture_surface.h"
#include "studio/view/pose_handles.h"
#include "studio/view/ring.h"
#include "studio/view/robot_picture.h"
#include "studio/view/scaled_framebuffer.h"

namespace koboshi::studio {

// Shows the picture of a robot and turns what mouse and keyboard do into changes of it and into signals.
// Drag: turn; drag with Shift or the middle button: move; wheel: distance; double click: look at that place;
// drag a link with Ctrl: push it. Drag of a link that can be posed: move it, or along an axis by the arrows
// at it; by the rings at it: rotate it about an axis, with Ctrl+Shift as the picture shows; the right button
// turns the camera there as well. While the picture moves, its resolution follows the machine's speed; 150 ms
// after that it is drawn in full.
class RobotView final : public QWidget {
  Q_OBJECT

 public:
  // Force of a push per length of the drag.
  static constexpr double kPush_N_per_m = 60.0;
  static constexpr double kMaxPush_N = 60.0;

  using Posable = PoseHandles::Posable;
  using Grabbed = PoseHandles::Grabbed;

  explicit RobotView(QWidget* parent = nullptr);

  // The picture, to change it; it is drawn anew.
  RobotPicture& change();
  const RobotPicture& picture() const { return picture_; }
  // As RobotPicture; these also end what the mouse does, or draw with the resolution of a moving picture.
  void set_scene(view::Scene scene, const sim_board::RobotDescription* robot = nullptr);
  void show_robot(std::vector<view::Pose> links, view::Marks marks);
  void show_ghost(std::vector<view::Pose> links);
  void show_onion(std::vector<view::Ghost> poses);
  void look_from(double azimuth_rad, double elevation_rad);
  void look_at_robot();

  void set_pushable(bool pushable) { pushable_ = pushable; }
  // The links that can be posed by dragging: of the second robot if there is one. Empty: none.
  void set_posable(std::vector<Posable> links);

  // The arrows and rings at the link that was under the mouse last; nothing without such a link.
  std::optional<Gizmo> gizmo() const { return handles_.gizmo(picture_); }
  // The link, the posable link, and the arrow or ring under a place of the widget.
  std::optional<Hit> link_at(const QPointF& place) const { return picture_.link_at(at(place)); }
  std::optional<Hit> posable_at(const QPointF& place) const { return handles_.link_at(picture_, at(place)); }
  std::optional<Handle> gizmo_handle_at(const QPointF& place) const;
  // The thing that a press in the widget grabs.
  Grabbed grabbed_at(const QPointF& place, bool with_handles = true) const;
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

  PicturePlace at(const QPointF& place) const;
  double aspect() const;
  void redraw_moving();
  void draw();
  view::Marks all_marks() const;
  bool begin_pose_drag(const QMouseEvent& event);
  void continue_pose_drag(const QPointF& place);
  void hover(const QPointF& place);
  void pick(const QPointF& place);
  void name_marks(const QPointF& place);

  RobotPicture picture_;
  PoseHandles handles_;
  bool pushable_ = false;

  PictureSurface surface_;
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
  std::optional<PoseGrab> grab_;
  int hovered_ = -1;
  bool names_marks_ = false;  // the tooltip is that of a mark
};

}  // namespace koboshi::studio
