#pragma once

#include <QWidget>

#include "tools/teleop/key.h"

class QLabel;

namespace koboshi::studio {

class Disturbances;
class OperatorCommands;
class RunController;
class ScenarioSettings;

// The operator of a simulated robot, or of a robot on a bus: commands to its controller. For a simulation
// also pushes, faults, and the settings with which the scenario starts.
class OperatorPanel final : public QWidget {
  Q_OBJECT

 public:
  // The controller of the run must outlive the panel.
  explicit OperatorPanel(RunController& run, QWidget* parent = nullptr);
  // Obeys a key as `koboshi run` with teleop does.
  void press(tools::Key key);
  // Starts the scenario again with the settings.
  void restart();
  OperatorCommands& commands() { return *commands_; }

 private:
  void show_source();
  void show_state();

  RunController& run_;
  QLabel* const state_;
  ScenarioSettings* const settings_;
  OperatorCommands* const commands_;
  Disturbances* const disturbances_;
};

}  // namespace koboshi::studio
