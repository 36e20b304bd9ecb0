#include "studio/controls/scenario_settings.h"

#include <QComboBox>
#include <QCoreApplication>
#include <QFormLayout>
#include <QLabel>
#include <QPushButton>
#include <QSpinBox>
#include <string>
#include <utility>

#include "base/text/user_units.h"
#include "sim_board/world/options.h"
#include "studio/controls/terrain.h"
#include "studio/widgets/spin_box.h"

namespace koboshi::studio {
namespace {

constexpr double kSteepest_deg = 20.0;

std::string tilt_text(const QDoubleSpinBox& roll, const QDoubleSpinBox& pitch) {
  return "[" + text_of(roll) + ", " + text_of(pitch) + "]";
}

}  // namespace

ScenarioSettings::ScenarioSettings(QWidget* parent)
    : QGroupBox(tr("Scenario"), parent),
      seed_(new QSpinBox),
      stepper_(new QComboBox),
      terrain_(new QComboBox),
      value_name_(new QLabel),
      value_(new QDoubleSpinBox),
      roll_(number_box(-kSteepest_deg, kSteepest_deg, 0.5, 0.0, QStringLiteral("°"),
                       tr("Slope of the ground to the side, in degrees"))),
      pitch_(number_box(-kSteepest_deg, kSteepest_deg, 0.5, 0.0, QStringLiteral("°"),
                        tr("Slope of the ground ahead, in degrees"))),
      friction_(number_box(0.0, 10.0, 0.05, 1.0, {}, tr("Coulomb's mu of the ground, without a unit"))) {
  auto* form = new QFormLayout(this);
  form->setRowWrapPolicy(QFormLayout::WrapLongRows);
  seed_->setRange(1, 1'000'000'000);
  seed_->setToolTip(tr("Seed of the sensors' noise and of rough ground"));
  form->addRow(tr("Seed"), seed_);
  for (const std::string& name : sim_board::stepper_names()) stepper_->addItem(QString::fromStdString(name));
  stepper_->setToolTip(tr("Method by which the physics engine computes a step"));
  stepper_->setObjectName(QStringLiteral("stepper"));
  form->addRow(tr("Stepper"), stepper_);
  for (const Terrain& terrain : terrains())
    terrain_->addItem(QCoreApplication::translate("Terrain", terrain.name));
  terrain_->setObjectName(QStringLiteral("terrain"));
  terrain_->setToolTip(tr("Ground in front of the robot, from 0.3 m on, 1 m wide"));
  connect(terrain_, &QComboBox::currentIndexChanged, this, &ScenarioSettings::show_terrain);
  form->addRow(tr("Ground"), terrain_);
  value_->setObjectName(QStringLiteral("terrain_value"));
  form->addRow(value_name_, value_);
  roll_->setObjectName(QStringLiteral("ground_roll"));
  form->addRow(tr("Roll"), roll_);
  form->addRow(tr("Pitch"), pitch_);
  form->addRow(tr("Friction"), friction_);
  auto* again = new QPushButton(tr("Start again"));
  again->setObjectName(QStringLiteral("restart"));
  again->setToolTip(tr("Resets the simulation and applies seed, stepper and ground"));
  connect(again, &QPushButton::clicked, this, &ScenarioSettings::restart_requested);
  form->addRow(again);
  show_terrain();
}

void ScenarioSettings::show_terrain() {
  const Terrain& terrain = terrains()[static_cast<std::size_t>(std::max(terrain_->currentIndex(), 0))];
  const bool has_value = *terrain.value != '\0';
  value_name_->setVisible(has_value);
  value_->setVisible(has_value);
  value_->setToolTip(tr("This ground has no number to choose."));
  if (!has_value) return;
  value_name_->setText(QCoreApplication::translate("Terrain", terrain.value));
  value_->setDecimals(terrain.decimals);
  value_->setRange(terrain.lowest, terrain.highest);
  value_->setSingleStep(terrain.decimals > 1 ? 0.05 : 0.5);
  value_->setSuffix(QLatin1Char(' ') + QString::fromUtf8(terrain.unit));
  value_->setValue(terrain.usual);
  value_->setToolTip(
      tr("%1 of the ground, in %2")
          .arg(value_name_->text(), *terrain.unit == '\0' ? tr("no unit") : QString::fromUtf8(terrain.unit)));
}

void ScenarioSettings::show_scenario(const simulation::Scenario& scenario) {
  shown_ = scenario.file;
  if (std::exchange(restarted_, {}) == scenario.file) return;
  terrain_->setCurrentIndex(0);
  seed_->setValue(static_cast<int>(scenario.seed));
  stepper_->setCurrentText(QString::fromUtf8(sim_board::name_of(scenario.physics.stepper).data()));
  roll_->setValue(kDegreesPerRad * scenario.ground.roll_rad);
  pitch_->setValue(kDegreesPerRad * scenario.ground.pitch_rad);
  friction_->setValue(scenario.ground.friction.value_or(sim_board::SurfaceDescription().friction));
  given_tilt_ = tilt_text(*roll_, *pitch_);
  given_friction_ = text_of(*friction_);
}

std::vector<Override> ScenarioSettings::overrides() {
  restarted_ = shown_;
  std::vector<Override> overrides{
      {"seed", std::to_string(seed_->value()), seed_->toolTip().toStdString()},
      {"physics.stepper", stepper_->currentText().toStdString(), stepper_->toolTip().toStdString()}};
  const std::string tilt = tilt_text(*roll_, *pitch_);
  if (tilt != given_tilt_) overrides.push_back({"ground.tilt_deg", tilt, roll_->toolTip().toStdString()});
  const std::string friction = text_of(*friction_);
  if (friction != given_friction_)
    overrides.push_back({"ground.friction", friction, friction_->toolTip().toStdString()});
  const Terrain& terrain = terrains()[static_cast<std::size_t>(terrain_->currentIndex())];
  if (terrain.kind != Terrain::Kind::kScenario)
    overrides.push_back(
        {"ground.shapes", terrain_shapes(terrain.kind, value_->value()), terrain_->toolTip().toStdString()});
  return overrides;
}

}  // namespace koboshi::studio
