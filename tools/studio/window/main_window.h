#pragma once

#include <QList>
#include <QMainWindow>
#include <array>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "tools/studio/view/robot_view.h"
#include "tools/studio/window/run_controller.h"
#include "tools/view/render/overlay.h"

class QLabel;

namespace koboshi::studio {

class CommandSearch;
class MessageBar;
class ModelController;
class ModelPanel;
class MotionPanel;
class MotionPlayback;
class Panels;
class PoseController;

// The studio's window: the view of the robot in the middle, panels around it (Panels), every action in a menu
// and in the command search. All panels show the moment of the run's cursor.
class MainWindow final : public QMainWindow {
  Q_OBJECT

 public:
  // `robot` is the file of the robot whose motions are edited while no scenario is open.
  explicit MainWindow(const std::filesystem::path& robot);
  ~MainWindow() override;

  // Opens a scenario, a motion, or a recorded run by what the file holds. What cannot be opened is said in
  // the message bar.
  void open(const std::filesystem::path& file);

  // Scenarios that are opened from now on have the robot of the constructor instead of their own.
  void use_robot_in_scenarios() { run_->set_robot_of_scenarios(robot_file_); }

  // Follows a robot on a CAN bus, named as for sim::open_transport.
  void attach(const std::string& transport, const sim::TransportOptions& options = {});

  RunController& run() { return *run_; }
  RobotView& view() { return *view_; }
  MotionPanel& motion();
  ModelPanel& model();
  MessageBar& messages() { return *messages_; }
  // All actions of the menus.
  QList<QAction*> all_actions() const;

 protected:
  void closeEvent(QCloseEvent* event) override;
  void dragEnterEvent(QDragEnterEvent* event) override;
  void dropEvent(QDropEvent* event) override;

 private:
  void arrange();
  void make_menus();
  void make_run_menu();
  void make_view_menu();
  void make_robot_menu();
  QAction* add_action(QMenu& menu, const QString& text, const QKeySequence& shortcut,
                      const std::function<void()>& does);
  void connect_view();
  void show_edited_robot();

  void choose_file();
  void choose_bus();
  void show_opened();
  void show_cursor();
  void show_marks();
  void show_link_name(int link);
  void push(int link, const Eigen::Vector3d& p_L_m, const Eigen::Vector3d& force_W_N);
  void update_title();

  const std::filesystem::path robot_file_;
  RunController* const run_;
  RobotView* const view_;
  MessageBar* const messages_;
  CommandSearch* const search_;
  Panels* const panels_;
  PoseController* const poses_;
  ModelController* const models_;
  MotionPlayback* const playback_;
  std::array<QAction*, view::kOverlayNames.size()> overlay_actions_{};
  std::optional<view::OverlayMarks> marks_;
  QString bus_ = QStringLiteral("socketcan:vcan0");  // the one chosen last
  sim::TransportOptions bus_options_;
  bool warned_of_changes_ = false;  // by an attempt to close
  QLabel* const link_name_;
};

}  // namespace koboshi::studio
