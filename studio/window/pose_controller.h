#pragma once

#include <QObject>
#include <array>
#include <filesystem>
#include <optional>
#include <vector>

#include "studio/document/pose_drag.h"
#include "studio/view/robot_view.h"
#include "studio/window/onion_skin.h"
#include "studio/window/pose_ghost.h"

class QAction;
class QMenu;

namespace koboshi::studio {

class MotionPanel;
class RunController;

// Shows the pose of the motion editor in the view and edits it there: hands, feet and the trunk are dragged
// with inverse kinematics.
class PoseController final : public QObject {
  Q_OBJECT

 public:
  PoseController(RobotView& view, MotionPanel& motion, RunController& run, QObject* parent = nullptr);

  // Throws InputError.
  void set_robot(std::shared_ptr<const sim_board::RobotDescription> robot);
  const std::optional<PoseGhost>& ghost() const { return ghost_; }
  // Adds the actions for poses.
  void fill_menu(QMenu& menu);
  // Shows a pose alone, or as a ghost in the place of the robot of a run; joint angles by joint.
  void show_pose(const std::vector<double>& angles_rad);
  // Inserts a move to the joint angles of the run at the cursor behind the current step.
  void insert_run_pose();

 Q_SIGNALS:
  // A remark for the user on a drag, such as a joint at its limit; one line.
  void told(const QString& text);

 private:
  enum Support { kAutomatic, kLeft, kRight, kBoth };
  // A link that stays where it is in the view while the pose is edited.
  struct Anchor {
    std::size_t row = 0;
    int link = 0;
    view::Pose at = {};
  };

  QAction* add_choice(QMenu& menu, const QString& text, Support support);
  void update_posable();
  std::optional<DragBody> body_of(int link) const;
  bool is_support(DragBody body) const;
  DragSupport trunk_support() const;
  float foot_height_m(DragBody foot) const;
  DragBody anchor_foot(DragBody body) const;
  void begin(int link, const Eigen::Vector3d& p_W_m);
  void drag(const Eigen::Vector3d& displacement_W_m, const Eigen::Vector3d& rotation_W_rad);
  void end();
  static QString rotation_text(const Eigen::Vector3d& rotation_W_rad);
  void show_limits(const DraggedPose& pose, const QString& drag_text);
  std::vector<view::Tint> tints_of(const DraggedPose& pose) const;
  void show_onion();

  RobotView& view_;
  MotionPanel& motion_;
  RunController& run_;
  std::optional<PoseGhost> ghost_;
  std::vector<RobotView::Posable> links_;  // by DragBody; index -1: the robot has none
  OnionSkin* onion_;
  Support support_ = kAutomatic;
  QAction* by_mouse_ = nullptr;
  std::optional<PoseDrag> drag_;
  std::vector<double> shown_rad_;
  Eigen::Quaterniond q_WB_ = Eigen::Quaterniond::Identity();  // of the trunk when the drag began
  std::optional<Anchor> anchor_;
};

}  // namespace koboshi::studio
