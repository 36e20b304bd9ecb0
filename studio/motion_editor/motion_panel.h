#pragma once

#include <QList>
#include <QWidget>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "studio/motion_editor/motion_editor.h"
#include "studio/widgets/message_kind.h"

class QAction;
class QBoxLayout;
class QDoubleSpinBox;
class QLineEdit;
class QTableView;
class QToolBar;

namespace koboshi::studio {

class JointPanel;
class MessageLine;
class OfferBar;
class StepModel;
class Timeline;

// The motion editor: the steps as a table and as a timeline, the joints of the current step as sliders, and a
// line with messages. It never opens a window because of an error.
class MotionPanel final : public QWidget {  // Large: one function per action of the menu
  Q_OBJECT

 public:
  explicit MotionPanel(QWidget* parent = nullptr);
  ~MotionPanel() override;

  // Opens a motion for this robot's file. Returns an error of one line, or nothing.
  std::optional<QString> open(const std::filesystem::path& motion, const std::filesystem::path& robot);
  // Sets the robot for which new motions are begun while none is open. Returns an error of one line, or
  // nothing.
  std::optional<QString> set_robot(std::shared_ptr<const sim_board::RobotDescription> robot);
  // Whether the motion differs from its file.
  bool modified() const;
  // Edits and ways to play, with separators.
  QList<QAction*> edit_actions() const { return edit_actions_; }
  QList<QAction*> file_actions() const { return file_actions_; }
  // Returns false after an error, or if the file was changed by another program; the panel says which. A
  // motion without a file is saved where the user chooses; false: nowhere.
  bool save();
  bool save_as(const std::filesystem::path& file);
  void undo();
  void redo();
  // The question before another motion takes the place of this one: it calls `go_on` unless the user wants
  // to keep this one. Without it, there is no question.
  using Guard = std::function<void(std::function<void()> go_on)>;
  void set_guard(Guard guard) { guard_ = std::move(guard); }
  // Whether the keys of the edits act wherever the window has the keyboard, or in this panel alone.
  void set_keys_everywhere(bool everywhere);
  // Writes the recovery now, which stays after the end of this program.
  void keep_recovery();
  // Empty: none, or a new motion.
  std::filesystem::path file() const;

  // The motion's source as it is now.
  std::string text() const;

  // The current step; nothing without one.
  std::optional<std::size_t> current_row() const;
  // The angles of the current step by joint if it is a move, whose pose can be edited; otherwise empty.
  std::vector<double> editable_pose() const;
  const MotionEditor& editor() const { return *editor_; }
  // Changes angles of the current step. Calls up to end_pose_drag() are one step of the undo history.
  bool drag_pose(std::span<const JointAngle> angles);
  void end_pose_drag();
  // Inserts a move to these angles, by joint, behind the selected steps.
  void insert_pose(std::span<const double> angles_rad, const std::string& name);
  // The motion of the steps from this row on, which begins with a move to the pose before it. A row within a
  // loop, branch or routine stands for the step of the main program around it. Throws InputError.
  std::string text_from(std::size_t row) const;

  // When a row of the main program begins on the nominal path; 0 for a row of a routine.
  std::uint64_t start_us(std::size_t row) const;
  // Where a preview begins: at the cursor of the timeline, or else with this row.
  std::uint64_t preview_start_us(std::size_t row) const;

  // Selects one row and shows it.
  void show_row(std::size_t row);

 Q_SIGNALS:
  // Joint angles of the current step or of the time at which the user looks, by the robot's order of joints.
  void pose_changed(const std::vector<double>& angles_rad);
  // From row 0: all of the motion.
  void play_requested(bool physics, int from_row);
  void title_changed();
  // The user has changed the motion, or begun or restored another one.
  void edited();
  // A message that the panel shows.
  void told(const QString& text, koboshi::studio::MessageKind kind);

 protected:
  void changeEvent(QEvent* event) override;

 private:
  void build_layout();
  QWidget* build_scale_bar();
  void follow_document();
  void follow_selection();
  void show_pose();
  void show_tick(std::size_t tick);
  void offer_recovery();
  void restore(const Recovery& recovery);
  // Calls the guard before this function, which replaces the motion.
  void replace(const std::function<void()>& go_on);
  void offer_reload(DiskChange change);
  bool report(const std::optional<QString>& error);

  // panel_actions.cc
  QAction* add_action(QList<QAction*>& actions, const QString& name, const QString& text,
                      const QKeySequence& keys, const QString& tip, std::function<void()> act);
  QAction* add_edit(const char* name, const QString& text, const QKeySequence& keys, const QString& tip,
                    std::function<void()> act);
  QAction* add_button(const char* name, const QString& text, const QString& keys, const QString& tip,
                      std::function<void()> act);
  void add_separator(QList<QAction*>& actions);
  void build_name();
  void update_name();
  void build_actions();
  void build_step_actions();
  void build_time_actions();
  void build_play_actions();
  void build_file_actions();
  void build_view_actions();
  void update_actions();
  std::vector<std::size_t> selected() const;
  void select_rows(std::size_t first, std::size_t count);
  // Edits the selected rows.
  void edit_selected(const std::function<void(MotionDocument&, std::span<const std::size_t>)>& change);
  // Adds steps behind the selected rows and selects them.
  void add_steps(const std::function<std::size_t(MotionDocument&, const StepPlace&)>& add);
  void copy();
  void paste();
  void move(int direction);
  void scale_time();
  void new_motion();
  bool choose_file();

  MotionEditor* editor_;
  StepModel* model_;
  QTableView* table_;
  Timeline* timeline_;
  JointPanel* joints_;
  MessageLine* messages_;
  std::optional<std::size_t> scrubbed_tick_;  // of the last check; none: the current step is shown
  OfferBar* recovery_bar_;
  OfferBar* disk_bar_;
  QWidget* scale_bar_ = nullptr;
  QDoubleSpinBox* scale_factor_ = nullptr;
  QToolBar* tools_;
  QLineEdit* name_ = nullptr;
  QList<QAction*> edit_actions_;
  QList<QAction*> file_actions_;
  Guard guard_;
};

}  // namespace koboshi::studio
