#pragma once

#include <QObject>
#include <QTemporaryDir>
#include <filesystem>
#include <optional>
#include <string>

#include "studio/model/robot_copy.h"

namespace koboshi::studio {

class ModelPanel;
class RobotView;
class RunController;

// Connects the model editor with the view and the run: what is chosen is the same in both, the view shows the
// edited shapes at once, and a simulation can start again with the edited robot before it is saved.
class ModelController final : public QObject {
  Q_OBJECT

 public:
  // All must outlive the controller.
  ModelController(RobotView& view, ModelPanel& panel, RunController& run, QObject* parent = nullptr);

  // Opens the robot that is edited. Returns an error of one line, or nothing. The view shows it after
  // follow_run().
  std::optional<QString> open(const std::filesystem::path& robot);
  // Shows the shapes of the edited robot at the poses of the run, if it is the same robot.
  void follow_run();

 Q_SIGNALS:
  // The run is to open again; the controller has told it with which robot.
  void restart_requested();
  void failed(const QString& message);

 private:
  void start_again();
  void show_shapes();
  void choose_link(int link);
  void mark_chosen();

  RobotView& view_;
  ModelPanel& panel_;
  RunController& run_;
  QTemporaryDir folder_;  // of the copies
  std::optional<RobotCopies> copies_;
};

}  // namespace koboshi::studio
