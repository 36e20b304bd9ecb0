#pragma once

#include <QObject>

class QLabel;

namespace koboshi::studio {

class PlantPanel;
class RobotView;
class RunController;

// Connects the panel of the plant with the view and the run: the panel shows the scenario that runs, a
// simulation can start again with values that are not saved, and the view names what differs from the model.
class PlantController final : public QObject {
  Q_OBJECT

 public:
  // All must outlive the controller.
  PlantController(RobotView& view, PlantPanel& panel, RunController& run, QObject* parent = nullptr);

 Q_SIGNALS:
  // The run is to open again.
  void restart_requested();

 private:
  void follow_run();
  void show_differences();

  RobotView& view_;
  PlantPanel& panel_;
  RunController& run_;
  QLabel* const differences_;  // in the corner of the view, which owns it
};

}  // namespace koboshi::studio
