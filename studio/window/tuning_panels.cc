#include "studio/window/tuning_panels.h"

#include "simulation/assembly/parameters.h"
#include "studio/controls/run_controller.h"
#include "studio/tuning/compare_panel.h"
#include "studio/tuning/parameter_panel.h"
#include "studio/tuning/study_panel.h"

namespace koboshi::studio {
namespace {

namespace fs = std::filesystem;

// The folder `studies` beside one that the robot's file is in; empty: none.
fs::path studies_of(const fs::path& robot) {
  for (fs::path folder = fs::absolute(robot).parent_path(); folder != folder.root_path();
       folder = folder.parent_path())
    if (fs::is_directory(folder / "studies")) return folder / "studies";
  return {};
}

}  // namespace

TuningPanels::TuningPanels(RunController& run, QObject* parent)
    : QObject(parent),
      run_(run),
      parameters_(new ParameterPanel),
      comparison_(new ComparePanel),
      studies_(new StudyPanel) {
  connect_run();
  connect_panels();
}

void TuningPanels::connect_run() {
  ParameterEditor& editor = parameters_->editor();
  connect(&run_, &RunController::opened, this, &TuningPanels::show_opened);
  connect(&run_, &RunController::answered, &editor, &ParameterEditor::take_answer);
  connect(&run_, &RunController::rewound, &editor, &ParameterEditor::run_rewound);
  const auto give = [this](const simulation::ObjectRequest& request) { run_.give(request); };
  connect(&editor, &ParameterEditor::requested, this, give);
  run_.set_preparation([&editor] { return editor.preparation(); });
}

void TuningPanels::connect_panels() {
  ParameterEditor& editor = parameters_->editor();
  comparison_->set_edited([&editor] { return editor.preparation(); });
  connect(parameters_, &ParameterPanel::restart_wanted, this, &TuningPanels::restart_wanted);
  const auto fail = [this](const QString& error) { Q_EMIT told(error, MessageKind::kError); };
  connect(comparison_, &ComparePanel::failed, this, fail);
  connect(studies_, &StudyPanel::failed, this, fail);
  connect(studies_, &StudyPanel::adopted, this, &TuningPanels::adopt);
}

void TuningPanels::set_robot(const sim_board::RobotDescription& robot) {
  parameters_->editor().set_robot(robot);
  const ParameterDocument* document = parameters_->editor().document(ParameterEditor::kRobot);
  studies_->set_folder(studies_of(document != nullptr ? document->file() : robot.file));
}

bool TuningPanels::shows_parameters_of(const fs::path& robot) const {
  const ParameterDocument* open = parameters_->editor().document(ParameterEditor::kRobot);
  std::error_code ignored;
  return open != nullptr && fs::equivalent(open->file(), robot.parent_path() / "parameters.yaml", ignored);
}

bool TuningPanels::shows_gait(const fs::path& gait) const {
  const ParameterDocument* open = parameters_->editor().document(ParameterEditor::kGait);
  return open != nullptr && open->file() == fs::absolute(gait);
}

void TuningPanels::show_opened() {
  ParameterEditor& editor = parameters_->editor();
  if (Session* session = run_.session()) {
    const simulation::Scenario& scenario = session->scenario();
    set_robot(*run_.robot());
    editor.set_gait(scenario.gait ? scenario.gait->file : fs::path());
    editor.run_opened(simulation::controller_values(session->played()));
    comparison_->set_scenario(run_.file(), scenario.seed);
    return;
  }
  comparison_->set_scenario({}, 1);
  if (run_.bus() == nullptr) return editor.run_closed();
  set_robot(*run_.robot());
  editor.set_gait({});
  editor.run_attached();
}

void TuningPanels::adopt(const StudyRun& run, const StudyEvaluation& evaluation) {
  ParameterEditor& editor = parameters_->editor();
  editor.show(ParameterEditor::kRobot);
  if (editor.document() == nullptr) return;
  const Adoption adopted = adoption(run, evaluation, editor.document()->table());
  const QString label = tr("Adopt evaluation %1 of %2")
                            .arg(evaluation.number)
                            .arg(QString::fromStdString(run.settings.study.filename().string()));
  if (!editor.adopt(adopted.values, label)) return;
  QString text = tr("%1 parameters adopted, not saved").arg(adopted.values.size());
  if (!adopted.left_out.empty())
    text += tr("; not in this file: %1").arg(QString::fromStdString(adopted.left_out.front()));
  if (adopted.left_out.size() > 1) text += tr(" and %1 more").arg(adopted.left_out.size() - 1);
  Q_EMIT told(text, adopted.left_out.empty() ? MessageKind::kSuccess : MessageKind::kWarning);
}

}  // namespace koboshi::studio
