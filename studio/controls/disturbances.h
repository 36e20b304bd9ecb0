#pragma once

#include <QWidget>

class QComboBox;
class QDoubleSpinBox;
class QGroupBox;
class QLineEdit;

namespace koboshi::studio {

class RunController;

// Pushes and faults for a simulated robot.
class Disturbances final : public QWidget {
  Q_OBJECT

 public:
  // The controller of the run must outlive this widget.
  explicit Disturbances(RunController& run, QWidget* parent = nullptr);

 private:
  void add_push();
  void add_fault();
  void push();
  void cause_fault();
  void show_robot();

  RunController& run_;
  QComboBox* const push_link_;
  QDoubleSpinBox* const push_force_;
  QDoubleSpinBox* const push_duration_;
  QDoubleSpinBox* const push_direction_;
  QComboBox* const fault_kind_;
  QComboBox* const fault_target_;
  QDoubleSpinBox* const fault_duration_;
  QLineEdit* const fault_details_;
};

}  // namespace koboshi::studio
