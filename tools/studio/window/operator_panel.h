#pragma once

#include <QWidget>
#include <memory>
#include <string>

#include "sim_board/scenario/scenario.h"
#include "tools/teleop/key.h"
#include "tools/teleop/pilot.h"

class QComboBox;
class QDoubleSpinBox;
class QGroupBox;
class QLabel;
class QLineEdit;
class QPushButton;
class QSpinBox;

namespace koboshi::studio {

class RunController;

// The operator of a simulated robot: commands to its controller, walking by velocity, motions, pushes,
// parameters, and the settings with which the scenario starts.
class OperatorPanel final : public QWidget {
  Q_OBJECT

 public:
  // The controller of the run must outlive the panel.
  explicit OperatorPanel(RunController& run, QWidget* parent = nullptr);
  // Obeys a key as `koboshi run` with teleop does.
  void press(tools::Key key);
  // Starts the scenario again with the seed and stepper that are set.
  void restart();

 private:
  void add_settings();
  void add_commands();
  void add_velocity();
  void add_push();
  void add_fault();
  void cause_fault();
  void update_run();
  void update_state();
  void command(sim::Command::Kind kind);
  double heading_rad() const;
  // A push button that gives a command, with its tooltip.
  QPushButton* button(const QString& text, const QString& tip, sim::Command::Kind kind);

  RunController& run_;
  std::unique_ptr<tools::Pilot> pilot_;
  QLabel* state_;
  QSpinBox* seed_;
  QComboBox* stepper_;
  QDoubleSpinBox* ground_roll_;
  QDoubleSpinBox* ground_pitch_;
  QDoubleSpinBox* ground_friction_;
  QComboBox* motion_;
  QDoubleSpinBox* forward_;
  QDoubleSpinBox* left_;
  QDoubleSpinBox* turn_;
  QComboBox* push_link_;
  QDoubleSpinBox* push_force_;
  QDoubleSpinBox* push_duration_;
  QDoubleSpinBox* push_direction_;
  QComboBox* fault_kind_;
  QComboBox* fault_target_;
  QDoubleSpinBox* fault_duration_;
  QLineEdit* fault_details_;
};

}  // namespace koboshi::studio
