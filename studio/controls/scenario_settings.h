#pragma once

#include <QGroupBox>
#include <filesystem>
#include <string>
#include <vector>

#include "base/yaml/yaml_tree.h"
#include "simulation/scenario/scenario.h"

class QComboBox;
class QDoubleSpinBox;
class QLabel;
class QSpinBox;

namespace koboshi::studio {

// The settings with which a scenario starts again: seed, stepper, and ground.
class ScenarioSettings final : public QGroupBox {
  Q_OBJECT

 public:
  explicit ScenarioSettings(QWidget* parent = nullptr);
  // Shows the settings of this scenario. After overrides() of the same file, they stay as the user set them.
  void show_scenario(const simulation::Scenario& scenario);
  // The settings as overrides of the scenario's file. The ground stays that of the file where nobody has
  // changed it.
  std::vector<Override> overrides();

 Q_SIGNALS:
  void restart_requested();

 private:
  void show_terrain();

  QSpinBox* const seed_;
  QComboBox* const stepper_;
  QComboBox* const terrain_;
  QLabel* const value_name_;
  QDoubleSpinBox* const value_;
  QDoubleSpinBox* const roll_;
  QDoubleSpinBox* const pitch_;
  QDoubleSpinBox* const friction_;
  std::filesystem::path shown_;      // file of the scenario
  std::filesystem::path restarted_;  // the file for which overrides() were asked last
  // The values of the scenario's file as they are shown.
  std::string given_tilt_;
  std::string given_friction_;
};

}  // namespace koboshi::studio
