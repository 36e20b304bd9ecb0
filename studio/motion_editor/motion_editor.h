#pragma once

#include <QFileSystemWatcher>
#include <QObject>
#include <QString>
#include <QTimer>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "studio/document/motion_document.h"
#include "studio/motion_editor/background_check.h"

namespace koboshi::studio {

// A message of the compiler or the check about the present text.
struct RowFinding {
  std::optional<std::size_t> row = {};  // none: the file as a whole
  simulation::Severity severity = simulation::Severity::kError;
  QString code = {};
  QString text = {};
  QString hint = {};
};

// The document of the motion editor with signals, and what runs beside the edits: the check, autosave, and
// the watch over the file.
class MotionEditor final : public QObject {
  Q_OBJECT

 public:
  explicit MotionEditor(std::filesystem::path recovery_folder, QObject* parent = nullptr);
  ~MotionEditor() override;

  // Each returns an error of one line, or nothing.
  std::optional<QString> open(const std::filesystem::path& file, const std::filesystem::path& robot_file);
  // Sets the robot for which begin() begins.
  std::optional<QString> set_robot(std::shared_ptr<const sim_board::RobotDescription> robot);
  std::optional<QString> begin();  // a new motion of the present robot
  std::optional<QString> restore(const Recovery& recovery);
  // Empty: saves to the document's file.
  std::optional<QString> save(const std::filesystem::path& file = {});
  std::optional<QString> reload();

  bool has_robot() const { return robot_ != nullptr; }
  bool is_open() const { return document_ != nullptr; }
  const MotionDocument& document() const { return *document_; }
  const MotionRows& rows() const { return document_->rows(); }
  const std::filesystem::path& robot_file() const { return robot_->description->file; }

  // Edits the document. Returns false and emits `failed` if it does not fit.
  bool edit(const std::function<void(MotionDocument&)>& change);
  void end_drag();

  // The messages in the order of the rows. Those of the check are of an earlier text while it runs.
  const std::vector<RowFinding>& findings() const { return findings_; }
  std::vector<const RowFinding*> findings_of(std::size_t row) const;
  // The last result; nullptr: none yet.
  const CheckResult* checked() const { return checked_.get(); }
  // By tick of the result: where the timeline of the main program shows it.
  const std::vector<double>& shown_s() const { return shown_s_; }
  bool is_checking() const { return check_.is_running(); }

  // Recoveries that a crash has left: of the document's file, or without a document of any file, then of
  // motions that were never saved; the newest first.
  std::vector<Recovery> recoveries() const;
  // Writes the recovery of unsaved changes now, which stays after the end of the program.
  void keep_recovery();

 Q_SIGNALS:
  void opened();   // another document
  void edited();   // by the user, also by undo and redo
  void changed();  // the text, and the findings with it
  void saved();
  void findings_changed();  // of the same text
  void failed(const QString& error);
  void changed_on_disk(koboshi::studio::DiskChange change);

 private:
  std::optional<QString> take(const std::function<std::unique_ptr<MotionDocument>()>& make);
  void after_change();
  void take_result(const std::shared_ptr<const CheckResult>& result);
  void collect_findings();
  void align_result();
  void watch();
  void look_at_disk();
  bool autosave();

  std::filesystem::path recovery_folder_;
  std::shared_ptr<const MotionRobot> robot_;
  std::unique_ptr<MotionDocument> document_;
  std::uint64_t seen_revision_ = 0;
  std::size_t checked_rows_ = 0;  // number of rows of the checked text
  std::vector<RowFinding> check_findings_;
  std::vector<RowFinding> findings_;
  std::shared_ptr<const CheckResult> checked_;
  std::vector<double> shown_s_;
  QFileSystemWatcher watcher_;
  QTimer* autosave_timer_;
  BackgroundCheck check_;
};

}  // namespace koboshi::studio
