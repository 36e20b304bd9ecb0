#pragma once

#include <QList>
#include <QMainWindow>
#include <QTemporaryDir>
#include <QTimer>
#include <array>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>

#include "tools/studio/view/robot_view.h"
#include "tools/studio/window/run_controller.h"
#include "tools/view/render/overlay.h"

class QActionGroup;
class QLabel;
class QStandardItemModel;
class QTableView;

namespace koboshi::studio {

class CanPanel;
class CommandSearch;
class MessageBar;
class MotionPanel;
class ObjectPanel;
class OperatorPanel;
class PlotPanel;
class PoseController;

// The studio's window: the view of the robot in the middle, panels around it, every action in a menu and in
// the command search. All panels show the moment of the run's cursor.
class MainWindow final : public QMainWindow {
  Q_OBJECT

 public:
  // `robot` is the file of the robot whose motions are edited while no scenario is open.
  explicit MainWindow(const std::filesystem::path& robot);
  ~MainWindow() override;

  // Opens a scenario, a motion, or a recorded run by what the file holds. What cannot be opened is said in
  // the message bar.
  void open(const std::filesystem::path& file);

  // Follows a robot on a CAN bus, named as for sim::open_transport.
  void attach(const std::string& transport, bool real_bus = false);

  RunController& run() { return *run_; }
  RobotView& view() { return *view_; }
  MotionPanel& motion() { return *motion_; }
  MessageBar& messages() { return *messages_; }
  // All actions of the menus.
  QList<QAction*> all_actions() const;

 protected:
  void closeEvent(QCloseEvent* event) override;
  void dragEnterEvent(QDragEnterEvent* event) override;
  void dropEvent(QDropEvent* event) override;

 private:
  void make_panels();
  void make_menus();
  void make_view_menu();
  void make_robot_menu();
  QDockWidget* add_panel(const QString& name, const QString& title, QWidget* widget, Qt::DockWidgetArea area);
  QAction* add_action(QMenu& menu, const QString& text, const QKeySequence& shortcut,
                      const std::function<void()>& does);
  void connect_run();
  void restore_layout();
  void reset_layout();

  void choose_file();
  void choose_bus();
  void upload_motion();
  std::optional<std::filesystem::path> write_played_motion(const std::string& text);
  void show_opened();
  void show_grown(std::size_t first_sample);
  void show_cursor();
  void show_marks();
  void show_events();
  void play_opened();
  void repeat_playback();
  void play_motion(bool physics, int from_row);
  void push(int link, const Eigen::Vector3d& p_L_m, const Eigen::Vector3d& force_W_N);
  void update_title();

  const std::filesystem::path robot_file_;
  RunController* const run_;
  RobotView* const view_;
  MessageBar* const messages_;
  CommandSearch* const search_;
  QMenu* panels_menu_ = nullptr;
  PlotPanel* plots_ = nullptr;
  CanPanel* can_ = nullptr;
  ObjectPanel* objects_ = nullptr;
  MotionPanel* motion_ = nullptr;
  OperatorPanel* operator_ = nullptr;
  QStandardItemModel* events_ = nullptr;
  QTableView* event_table_ = nullptr;
  std::size_t shown_events_ = 0;
  std::array<QAction*, view::kOverlayNames.size()> overlay_actions_{};
  std::optional<view::OverlayMarks> marks_;
  PoseController* poses_ = nullptr;
  std::uint64_t play_from_us_ = 0;  // of a playback
  QAction* loop_ = nullptr;
  bool was_playing_ = false;
  QTemporaryDir played_;  // texts of motions that are played before they are saved
  QByteArray default_layout_;
  QTimer can_timer_;  // the table of frames is updated less often than the view
  bool play_when_opened_ = false;
  QString bus_ = QStringLiteral("socketcan:vcan0");  // the one chosen last
  bool real_bus_ = false;
  bool warned_of_changes_ = false;  // by an attempt to close
  QLabel* link_name_ = nullptr;
};

}  // namespace koboshi::studio
