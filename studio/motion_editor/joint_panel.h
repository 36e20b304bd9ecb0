#pragma once

#include <QScrollArea>
#include <optional>
#include <vector>

#include "studio/motion_editor/motion_editor.h"

class QCheckBox;
class QDoubleSpinBox;
class QGridLayout;
class QLabel;
class QLineEdit;
class QSlider;

namespace koboshi::studio {

class ValueFilter;

// A slider and a spin box for each joint, by limb, which show and change the pose of a step.
class JointPanel final : public QScrollArea {
  Q_OBJECT

 public:
  explicit JointPanel(MotionEditor& editor, QWidget* parent = nullptr);

  void set_row(std::optional<std::size_t> row);
  // Puts the cursor into the name of the pose.
  void edit_name();
  // Returns the steps that an edit of the pose concerns, as the user has chosen.
  PoseScope scope() const;
  // By joint of the robot.
  QSlider* slider(std::size_t joint) const { return joints_.at(joint).slider; }
  QDoubleSpinBox* spin_box(std::size_t joint) const { return joints_.at(joint).box; }

 Q_SIGNALS:
  // The joint that the user looks at.
  void joint_chosen(std::size_t joint);

 protected:
  bool eventFilter(QObject* watched, QEvent* event) override;

 private:
  struct JointRow {
    QLabel* name = nullptr;
    QSlider* slider = nullptr;
    QDoubleSpinBox* box = nullptr;
  };

  void build();
  void add_pose(QGridLayout& grid);
  void add_group(QGridLayout& grid, const QString& title, const std::vector<std::size_t>& joints);
  void add_joint(QGridLayout& grid, std::size_t joint);
  void refresh();
  void refresh_pose(const MotionRow* row);
  void refresh_joint(std::size_t joint, const MotionRow* row, bool is_allowed);
  void rename_pose();
  void change(std::size_t joint, double angle_deg);
  void drag_ended(std::size_t joint);

  MotionEditor& editor_;
  ValueFilter* const filter_;           // of sliders and boxes
  const MotionRobot* robot_ = nullptr;  // whose joints are shown
  std::optional<std::size_t> row_;
  QLabel* pose_ = nullptr;
  QLineEdit* name_ = nullptr;
  QLabel* uses_ = nullptr;
  QCheckBox* this_step_ = nullptr;
  std::vector<JointRow> joints_;
};

}  // namespace koboshi::studio
