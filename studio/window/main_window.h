#pragma once

#include <QList>
#include <QMainWindow>
#include <array>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "studio/controls/run_controller.h"
#include "studio/view/robot_view.h"
#include "view/render/overlay.h"

class QLabel;

namespace koboshi::studio {

class CommandSearch;
class Documents;
class MessageBar;
class ModelController;
class ModelPanel;
class MotionPanel;
class MotionPlayback;
class Panels;
class PlantController;
class PlantPanel;
class PoseController;

// The studio's window: the view of the robot in the middle, panels around it (Panels), every action in a menu
// and in the command search. All panels show the moment of the run's cursor.
class MainWindow final : public QMainWindow {
  Q_OBJECT

 public:
  // `robot` is the file of the robot whose motions are edited while no scenario is open.
  explicit MainWindow(const std::filesystem::path& robot);
  ~MainWindow() override;

  // Opens a scenario, a motion, or a recorded run by what the file holds. The message bar names a file that
  // cannot be opened.
  void open(const std::filesystem::path& file);

  // Scenarios that are opened from now on have the robot of the constructor instead of their own.
  void use_robot_in_scenarios() { run_->set_robot_of_scenarios(robot_file_); }

  // Follows a robot on a CAN bus, named as for sim_board::open_transport.
  void attach(const std::string& transport, const sim_board::TransportOptions& options = {});

  RunController& run() { return *run_; }
  RobotView& view() { return *view_; }
  MotionPanel& motion();
  ModelPanel& model();
  PlantPanel& plant();
  MessageBar& messages() { return *messages_; }
  Documents& documents() { return *documents_; }
  // Ends without a question, as when the system ends the program: unsaved changes are kept for recovery.
  void end();
  // Lets the user save or discard changes at the end of the desktop's session. Returns false if he cancels.
  bool end_session(bool may_ask);

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
  void connect_documents();
  void show_edited_robot();

  void choose_file();
  void open_motion(const std::filesystem::path& file);
  void open_scenario(const std::filesystem::path& file);
  void show_active_document();
  void choose_bus();
  void show_opened();
  void show_cursor();
  void show_marks();
  void show_link_name(int link);
  void push(int link, const Eigen::Vector3d& p_L_m, const Eigen::Vector3d& force_W_N);

  const std::filesystem::path robot_file_;
  RunController* const run_;
  RobotView* const view_;
  MessageBar* const messages_;
  CommandSearch* const search_;
  Panels* const panels_;
  PoseController* const poses_;
  ModelController* const models_;
  PlantController* const plants_;
  MotionPlayback* const playback_;
  Documents* const documents_;
  std::array<QAction*, view::kOverlayNames.size()> overlay_actions_{};
  std::optional<view::OverlayMarks> marks_;
  QString bus_ = QStringLiteral("socketcan:vcan0");  // the one chosen last
  sim_board::TransportOptions bus_options_;
  bool may_close_ = false;  // changes are saved, discarded or kept for recovery
  QLabel* const document_name_;
  QLabel* const link_name_;
};

}  // namespace koboshi::studio
