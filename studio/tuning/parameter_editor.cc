#include "studio/tuning/parameter_editor.h"

#include <QDateTime>
#include <algorithm>
#include <stdexcept>
#include <system_error>
#include <utility>

namespace koboshi::studio {
namespace {

constexpr int kAutosaveInterval_ms = 5000;

std::filesystem::path recovery_folder_of_parameters() { return default_recovery_folder() / "parameters"; }

}  // namespace

ParameterEditor::ParameterEditor(QObject* parent) : QObject(parent) {
  const auto send = [this](const simulation::ObjectRequest& request) { Q_EMIT requested(request); };
  files_[kRobot].live = std::make_unique<LiveParameters>(controller_table(), send);
  files_[kGait].live = std::make_unique<LiveParameters>(gait_table(), send, 2 * LiveParameters::kFirstNumber);
  connect(&autosave_timer_, &QTimer::timeout, this, &ParameterEditor::autosave);
  autosave_timer_.start(kAutosaveInterval_ms);
}

// --- Files

void ParameterEditor::set_robot(const sim_board::RobotDescription& robot) {
  const std::filesystem::path path = std::filesystem::absolute(robot.file).lexically_normal();
  if (path == robot_file_) return;
  robot_file_ = path;
  robot_ = robot;
  model_.reset();
  try {
    model_ = simulation::load_named_model(robot);
  } catch (const std::runtime_error& error) {
    Q_EMIT refused(QString::fromUtf8(error.what()));
  }
  // A copy of the robot that the model editor has changed links to the same parameters, which stay open.
  const std::filesystem::path parameters = path.parent_path() / "parameters.yaml";
  std::error_code ignored;
  const ParameterDocument* present = document(kRobot);
  if (present != nullptr && std::filesystem::equivalent(present->file(), parameters, ignored))
    Q_EMIT changed();
  else
    open(kRobot, parameters);
}

void ParameterEditor::set_gait(const std::filesystem::path& gait) {
  const ParameterDocument* present = document(kGait);
  if (present != nullptr && present->file() == std::filesystem::absolute(gait)) return;
  if (gait.empty() && is_modified(kGait)) return;  // a run without a gait takes no work away
  open(kGait, gait);
}

void ParameterEditor::open(File which, const std::filesystem::path& path) {
  // Unsaved changes of a file that another one replaces unasked are offered when it is opened again.
  if (is_modified(which) && !files_[which].is_discarded) {
    autosave();
    files_[which].autosave->keep();
  }
  files_[which].document.reset();
  files_[which].is_discarded = false;
  try {
    files_[which].autosave = std::make_unique<Autosave>(recovery_folder_of_parameters());
    if (std::filesystem::is_regular_file(path)) files_[which].document.emplace(path);
  } catch (const std::runtime_error& error) {
    Q_EMIT refused(QString::fromUtf8(error.what()));
  }
  if (!has(shown_)) shown_ = has(kRobot) || !has(kGait) ? kRobot : kGait;
  Q_EMIT opened();
}

void ParameterEditor::show(File which) {
  if (which == shown_) return;
  end_drag();
  shown_ = which;
  Q_EMIT opened();
}

bool ParameterEditor::is_modified() const {
  return std::ranges::any_of(files_,
                             [](const OpenFile& one) { return one.document && one.document->is_modified(); });
}

// --- Edits

std::vector<std::optional<double>> ParameterEditor::values() const {
  std::vector<std::optional<double>> values;
  for (std::size_t index = 0; index < document()->table().size(); ++index)
    values.push_back(document()->value(index));
  return values;
}

bool ParameterEditor::edit(const std::function<void(ParameterDocument&)>& change) {
  if (!file().document) return false;
  const std::vector<std::optional<double>> before = values();
  const std::uint64_t revision = document()->revision();
  try {
    change(*file().document);
  } catch (const std::runtime_error& error) {
    Q_EMIT changed();  // the panel shows the old value again
    Q_EMIT refused(QString::fromUtf8(error.what()));
    return false;
  }
  write_changes(before);
  Q_EMIT changed();
  if (document()->revision() == revision) return true;
  file().is_discarded = false;
  Q_EMIT edited();
  return true;
}

void ParameterEditor::write_changes(const std::vector<std::optional<double>>& before) {
  if (!is_live_ || !connected_) return;
  for (std::size_t index = 0; index < before.size(); ++index) {
    const auto now = document()->value(index);
    if (now && now != before[index]) file().live->write(index, *now);
  }
  Q_EMIT all_live_changed();
}

bool ParameterEditor::set(std::size_t index, double value, const QString& drag) {
  return edit([&](ParameterDocument& document) { document.set(index, value, drag.toStdString()); });
}

bool ParameterEditor::adopt(std::span<const ParameterValue> values, const QString& label) {
  return edit([&](ParameterDocument& document) { document.set_all(values, label.toStdString()); });
}

bool ParameterEditor::reset_to_file(std::size_t index) {
  return edit([&](ParameterDocument& document) { document.reset_to_file(index); });
}

bool ParameterEditor::reset_to_default(std::size_t index) {
  return edit([&](ParameterDocument& document) { document.reset_to_default(index); });
}

bool ParameterEditor::reset_all() {
  return edit([](ParameterDocument& document) { document.reset_all_to_file(); });
}

void ParameterEditor::end_drag() {
  if (file().document) file().document->end_drag();
}

bool ParameterEditor::undo() {
  return edit([](ParameterDocument& document) { document.undo(); });
}

bool ParameterEditor::redo() {
  return edit([](ParameterDocument& document) { document.redo(); });
}

bool ParameterEditor::save(bool forced) {
  if (!file().document) return false;
  if (!forced && file().document->changed_on_disk() == DiskChange::kChanged) {
    Q_EMIT refused(tr("Another program has changed %1: reload it, or save again to overwrite it")
                       .arg(QString::fromStdString(file().document->file().filename().string())));
    return false;
  }
  if (!edit([](ParameterDocument& document) { document.save(); })) return false;
  autosave();
  return true;
}

void ParameterEditor::autosave() {
  for (OpenFile& one : files_) {
    if (!one.document) continue;
    try {
      if (!one.document->is_modified()) one.autosave->match_file(one.document->file());
      one.autosave->write(*one.document, QDateTime::currentSecsSinceEpoch());
    } catch (const std::runtime_error& error) {
      Q_EMIT refused(QString::fromUtf8(error.what()));
    }
  }
}

void ParameterEditor::keep_recoveries() {
  autosave();
  for (const OpenFile& one : files_)
    if (one.document && one.document->is_modified()) one.autosave->keep();
}

std::optional<std::pair<ParameterEditor::File, Recovery>> ParameterEditor::recovery() const {
  for (Recovery& found : find_recoveries(recovery_folder_of_parameters()))
    for (const File which : {kRobot, kGait})
      if (has(which) && document(which)->file() == found.original) return std::pair(which, std::move(found));
  return std::nullopt;
}

void ParameterEditor::restore(File which, const Recovery& recovery) {
  show(which);
  if (edit([&](ParameterDocument& document) { document.replace_text(recovery.text); }))
    discard_recovery(recovery);
}

bool ParameterEditor::reload() {
  return edit([](ParameterDocument& document) { document.reload(); });
}

QString ParameterEditor::problem() const {
  if (document() == nullptr || !robot_ || !model_) return {};
  return QString::fromStdString(document()->problem(*robot_, *model_));
}

// --- The running controller

void ParameterEditor::run_closed() {
  connected_ = false;
  if (live_before_bus_) is_live_ = *std::exchange(live_before_bus_, std::nullopt);
  for (OpenFile& one : files_) one.live->reset();
  Q_EMIT all_live_changed();
}

void ParameterEditor::run_opened(const app::ControllerValues& values) {
  run_closed();
  connected_ = true;
  for (OpenFile& one : files_) one.live->set_known(values);
  Q_EMIT all_live_changed();
}

void ParameterEditor::run_attached() {
  run_closed();
  connected_ = true;
  live_before_bus_ = std::exchange(is_live_, false);
  Q_EMIT all_live_changed();
}

void ParameterEditor::run_rewound(std::uint64_t time_us) {
  for (OpenFile& one : files_) one.live->return_to(time_us);
  Q_EMIT all_live_changed();
}

void ParameterEditor::take_answer(const simulation::ObjectAnswer& answer) {
  for (OpenFile& one : files_) {
    const auto index = one.live->take_answer(answer);
    if (index && &one == &file()) Q_EMIT live_changed(*index);
  }
}

void ParameterEditor::set_live(bool live) { is_live_ = live; }

void ParameterEditor::apply_all() {
  if (!connected_ || !file().document) return;
  for (std::size_t index = 0; index < document()->table().size(); ++index) {
    const ParameterInfo& info = document()->table()[index];
    const auto wanted = document()->value(index);
    const LiveParameters::State& state = live().state(index);
    const bool is_there = state.in_force && wanted && info.steps(*state.in_force) == info.steps(*wanted);
    if (wanted && state.is_known && !is_there) file().live->write(index, *wanted);
  }
  Q_EMIT all_live_changed();
}

void ParameterEditor::read_all() {
  if (!connected_) return;
  for (OpenFile& one : files_)
    if (one.document) one.live->read_all();
}

std::function<void(simulation::Scenario&)> ParameterEditor::preparation() const {
  std::vector<ParameterDocument> documents;
  for (const OpenFile& one : files_)
    if (one.document && one.document->is_modified()) documents.push_back(*one.document);
  return [documents](simulation::Scenario& scenario) {
    for (const ParameterDocument& document : documents) document.apply_to(scenario);
  };
}

}  // namespace koboshi::studio
