#include "studio/controls/operator_panel.h"

#include <QLabel>
#include <QVBoxLayout>
#include <cmath>

#include "studio/controls/disturbances.h"
#include "studio/controls/operator_commands.h"
#include "studio/controls/run_controller.h"
#include "studio/controls/scenario_settings.h"
#include "view/render/playback.h"

namespace koboshi::studio {

OperatorPanel::OperatorPanel(RunController& run, QWidget* parent)
    : QWidget(parent),
      run_(run),
      state_(new QLabel),
      settings_(new ScenarioSettings),
      commands_(new OperatorCommands(run)),
      disturbances_(new Disturbances(run)) {
  auto* layout = new QVBoxLayout(this);
  state_->setObjectName(QStringLiteral("controller_state"));
  state_->setToolTip(tr("State that the controller reports"));
  state_->setAccessibleName(tr("State of the controller"));
  state_->setWordWrap(true);
  for (QWidget* part : {static_cast<QWidget*>(state_), static_cast<QWidget*>(settings_),
                        static_cast<QWidget*>(commands_), static_cast<QWidget*>(disturbances_)})
    layout->addWidget(part);
  layout->addStretch();
  connect(settings_, &ScenarioSettings::restart_requested, this, &OperatorPanel::restart);
  connect(&run_, &RunController::opened, this, &OperatorPanel::show_source);
  connect(&run_, &RunController::status_changed, this, &OperatorPanel::show_state);
  connect(&run_, &RunController::cursor_moved, this, &OperatorPanel::show_state);
  show_source();
}

void OperatorPanel::press(tools::Key key) { commands_->press(key); }

void OperatorPanel::restart() {
  if (run_.session() != nullptr) run_.reopen(settings_->overrides());
}

void OperatorPanel::show_source() {
  const bool simulates = run_.session() != nullptr;
  settings_->setEnabled(simulates);
  disturbances_->setEnabled(simulates);
  if (simulates) settings_->show_scenario(run_.session()->scenario());
  show_state();
}

// The state at the cursor.
void OperatorPanel::show_state() {
  const view::Recording& recording = run_.recording();
  const bool is_on_bus = run_.source() == RunController::Source::kBus;
  const auto signal = view::find_signal(recording, is_on_bus ? RunController::kBusState : "state_name");
  QString name;
  if (signal && !recording.samples.empty())
    name = QString::fromStdString(
        view::name_of_value(recording, *signal, view::sample_at(recording, run_.cursor_us())));
  QString text = tr("No controller runs.");
  if (!name.isEmpty()) text = tr("Controller: <b>%1</b>").arg(name);
  if (name.isEmpty() && is_on_bus) text = tr("No controller sends on this bus.");
  if (state_->text() != text) state_->setText(text);
}

}  // namespace koboshi::studio
