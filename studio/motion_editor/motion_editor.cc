#include "studio/motion_editor/motion_editor.h"

#include <QDateTime>
#include <algorithm>
#include <utility>

#include "base/text/error.h"
#include "tools/motion_check/trajectory.h"

namespace koboshi::studio {
namespace {

constexpr int kAutosaveInterval_ms = 5000;

RowFinding finding_of(const simulation::Diagnostic& diagnostic, const MotionRows& rows) {
  return {.row = diagnostic.place.line > 0 ? rows.find_line(diagnostic.place.line) : std::nullopt,
          .severity = diagnostic.severity,
          .code = QString::fromStdString(diagnostic.code),
          .text = QString::fromStdString("found " + diagnostic.found + ", expected " + diagnostic.expected),
          .hint = QString::fromStdString(diagnostic.hint)};
}

bool is_in_endless_loop(const MotionRows& rows, std::size_t row) {
  std::optional<std::size_t> at = rows.rows[row].parent;
  for (; at; at = rows.rows[*at].parent) {
    const MotionRow& around = rows.rows[*at];
    if (around.kind == simulation::StepSource::Kind::kLoop && !around.times) return true;
  }
  return false;
}

}  // namespace

MotionEditor::MotionEditor(std::filesystem::path recovery_folder, QObject* parent)
    : QObject(parent), recovery_folder_(std::move(recovery_folder)), autosave_timer_(new QTimer(this)) {
  connect(&check_, &BackgroundCheck::finished, this, &MotionEditor::take_result);
  connect(&watcher_, &QFileSystemWatcher::fileChanged, this, &MotionEditor::look_at_disk);
  connect(&watcher_, &QFileSystemWatcher::directoryChanged, this, &MotionEditor::look_at_disk);
  connect(autosave_timer_, &QTimer::timeout, this, &MotionEditor::autosave);
  autosave_timer_->setInterval(kAutosaveInterval_ms);
}

MotionEditor::~MotionEditor() = default;

std::optional<QString> MotionEditor::take(const std::function<std::unique_ptr<MotionDocument>()>& make) {
  try {
    document_ = make();
  } catch (const std::exception& error) {
    return QString::fromStdString(error.what());
  }
  seen_revision_ = 0;
  checked_rows_ = 0;
  checked_.reset();
  check_findings_.clear();
  shown_s_.clear();
  findings_.clear();
  watch();
  autosave_timer_->start();
  Q_EMIT opened();
  after_change();
  return std::nullopt;
}

std::optional<QString> MotionEditor::open(const std::filesystem::path& file,
                                          const std::filesystem::path& robot_file) {
  return take([&] {
    const bool is_same = robot_ != nullptr && std::filesystem::absolute(robot_file) ==
                                                  std::filesystem::absolute(this->robot_file());
    auto robot = is_same ? robot_ : load_motion_robot(robot_file);
    auto document = std::make_unique<MotionDocument>(robot, file, recovery_folder_);
    robot_ = std::move(robot);
    return document;
  });
}

std::optional<QString> MotionEditor::set_robot(std::shared_ptr<const sim_board::RobotDescription> robot) {
  try {
    robot_ = load_motion_robot(std::move(robot));
  } catch (const std::exception& error) {
    return QString::fromStdString(error.what());
  }
  return std::nullopt;
}

std::optional<QString> MotionEditor::begin() {
  return take([&] { return MotionDocument::begin(robot_, MotionDocument::kNewName, recovery_folder_); });
}

std::optional<QString> MotionEditor::restore(const Recovery& recovery) {
  auto error = take([&] { return MotionDocument::restore(robot_, recovery, recovery_folder_); });
  if (error) return error;
  if (autosave()) discard_recovery(recovery);
  return std::nullopt;
}

std::optional<QString> MotionEditor::save(const std::filesystem::path& file) {
  try {
    if (file.empty()) {
      document_->save();
    } else {
      document_->save_as(file);
    }
  } catch (const std::exception& error) {
    return QString::fromStdString(error.what());
  }
  watch();
  after_change();
  Q_EMIT saved();
  return std::nullopt;
}

std::optional<QString> MotionEditor::reload() {
  try {
    document_->reload();
  } catch (const std::exception& error) {
    return QString::fromStdString(error.what());
  }
  after_change();
  Q_EMIT saved();
  return std::nullopt;
}

bool MotionEditor::edit(const std::function<void(MotionDocument&)>& change) {
  if (document_ == nullptr) return false;
  const std::uint64_t revision = document_->revision();
  try {
    change(*document_);
  } catch (const std::exception& error) {
    after_change();
    Q_EMIT failed(QString::fromStdString(error.what()));
    return false;
  }
  after_change();
  if (document_->revision() != revision) Q_EMIT edited();
  return true;
}

void MotionEditor::end_drag() {
  if (document_ != nullptr) document_->end_drag();
}

void MotionEditor::after_change() {
  if (document_->revision() == seen_revision_) return;
  seen_revision_ = document_->revision();
  if (rows().rows.size() != checked_rows_) check_findings_.clear();
  collect_findings();
  if (document_->compiled() != nullptr) {
    check_.request(
        {robot_file(), document_->file().empty() ? "untitled.yaml" : document_->file(), document_->text()});
  } else {
    check_.cancel();
    check_findings_.clear();
    collect_findings();
  }
  Q_EMIT changed();
}

void MotionEditor::take_result(const std::shared_ptr<const CheckResult>& result) {
  checked_ = result;
  check_findings_.clear();
  checked_rows_ = rows().rows.size();
  if (!result->error.empty()) check_findings_.push_back({.text = QString::fromStdString(result->error)});
  for (const simulation::Diagnostic& diagnostic : result->diagnostics)
    check_findings_.push_back(finding_of(diagnostic, rows()));
  align_result();
  collect_findings();
  Q_EMIT findings_changed();
}

void MotionEditor::collect_findings() {
  findings_.clear();
  for (const simulation::Diagnostic& diagnostic : document_->diagnostics())
    findings_.push_back(finding_of(diagnostic, rows()));
  findings_.insert(findings_.end(), check_findings_.begin(), check_findings_.end());
  std::ranges::stable_sort(findings_, {}, [](const RowFinding& finding) { return finding.row; });
}

std::vector<const RowFinding*> MotionEditor::findings_of(std::size_t row) const {
  std::vector<const RowFinding*> found;
  const auto range = std::ranges::equal_range(findings_, std::optional(row), {}, &RowFinding::row);
  for (const RowFinding& finding : range) found.push_back(&finding);
  return found;
}

// The check plays the motion with neutral sensors, the rows are those of the nominal path: where a step is
// reached for the first time, both times are aligned. Further rounds of an endless loop, which the rows do
// not have, take no time.
void MotionEditor::align_result() {
  shown_s_.assign(checked_->ticks.size(), 0.0);
  std::vector<bool> reached(rows().rows.size(), false);
  double offset_s = 0.0;
  bool is_again = false;  // in a further round of an endless loop
  int line = -1;
  for (std::size_t i = 0; i < shown_s_.size(); ++i) {
    const double time_s = static_cast<double>(i) * tools::kTick_s;
    if (checked_->ticks[i].line != line) {
      line = checked_->ticks[i].line;
      const auto row = rows().find_line(line);
      if (row && rows().rows[*row].section == 0 && !reached[*row]) {
        reached[*row] = true;
        const double aligned_s = rows().rows[*row].start_s - time_s;
        if (i == 0 || aligned_s + time_s >= shown_s_[i - 1]) offset_s = aligned_s;
        is_again = false;
      } else if (row) {
        is_again = is_in_endless_loop(rows(), *row);
      }
    }
    shown_s_[i] = is_again && i > 0 ? shown_s_[i - 1] : time_s + offset_s;
    if (is_again) offset_s = shown_s_[i] - time_s;
  }
}

std::vector<Recovery> MotionEditor::recoveries() const {
  std::vector<Recovery> found;
  if (recovery_folder_.empty()) return found;
  for (Recovery& recovery : find_recoveries(recovery_folder_)) {
    if (recovery.original.empty() || document_ == nullptr || recovery.original == document_->file())
      found.push_back(std::move(recovery));
  }
  std::ranges::stable_sort(found, [](const Recovery& one, const Recovery& other) {
    return std::pair(one.original.empty(), other.time_unix_s) <
           std::pair(other.original.empty(), one.time_unix_s);
  });
  return found;
}

void MotionEditor::keep_recovery() {
  if (document_ == nullptr || !document_->is_modified()) return;
  autosave();
  document_->keep_recovery();
}

// A program that replaces the file takes it away from the watch: the folder is watched as well.
void MotionEditor::watch() {
  if (!watcher_.files().isEmpty()) watcher_.removePaths(watcher_.files());
  if (!watcher_.directories().isEmpty()) watcher_.removePaths(watcher_.directories());
  if (document_->file().empty()) return;
  const std::filesystem::path& file = document_->file();
  if (std::filesystem::exists(file)) watcher_.addPath(QString::fromStdString(file.string()));
  watcher_.addPath(QString::fromStdString(file.parent_path().string()));
}

void MotionEditor::look_at_disk() {
  if (document_ == nullptr) return;
  const DiskChange change = document_->changed_on_disk();
  if (!document_->file().empty() && watcher_.files().isEmpty()) watch();
  Q_EMIT changed_on_disk(change);
}

// Returns false after an error.
bool MotionEditor::autosave() {
  if (document_ == nullptr) return true;
  try {
    document_->autosave(QDateTime::currentSecsSinceEpoch());
  } catch (const std::exception& error) {
    Q_EMIT failed(QString::fromStdString(error.what()));
    return false;
  }
  return true;
}

}  // namespace koboshi::studio
