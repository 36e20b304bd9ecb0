#pragma once

#include <QProcess>
#include <QString>
#include <QTimer>
#include <QWidget>
#include <filesystem>
#include <optional>
#include <vector>

#include "studio/parameters/study_runs.h"

class QComboBox;
class QFormLayout;
class QLabel;
class QLineEdit;
class QProgressBar;
class QPushButton;
class QSpinBox;
class QTableWidget;

namespace koboshi::studio {

class ScorePlot;

// The studies of a robot: starts `koboshi tune` as a process of its own, shows how far it is and what it has
// found, stops and resumes it, and offers a set of parameters for adoption. It also shows searches that were
// started elsewhere: everything is read from the folder of results.
class StudyPanel final : public QWidget {
  Q_OBJECT

 public:
  explicit StudyPanel(QWidget* parent = nullptr);
  // Stops the search; it can be resumed.
  ~StudyPanel() override;

  // Lists the studies of this folder.
  void set_folder(const std::filesystem::path& studies);
  StudySettings settings() const;
  void set_settings(const StudySettings& settings);

  // Starts the search with these settings, or resumes it.
  void start();
  void stop();
  bool is_running() const { return process_.state() != QProcess::NotRunning; }
  // The search whose folder of results is open.
  const std::optional<StudyRun>& run() const { return run_; }
  // Offers the evaluation that is selected in the table, or the best one.
  void adopt();

 Q_SIGNALS:
  void adopted(const koboshi::studio::StudyRun& run, const koboshi::studio::StudyEvaluation& evaluation);
  void failed(const QString& message);
  void finished();

 private:
  void add_settings(QFormLayout& form);
  void choose_study();
  void open_folder();
  void show_settings(const StudySettings& settings);
  void poll();
  void show_run();
  void show_table();
  void end(int status, QProcess::ExitStatus how);

  const std::filesystem::path program_;  // that searches: `koboshi` beside this one
  QComboBox* const study_;
  QSpinBox* const evaluations_;
  QSpinBox* const seeds_;
  QSpinBox* const first_seed_;
  QComboBox* const stepper_;
  QSpinBox* const jobs_;
  QLineEdit* const out_;
  QPushButton* const start_;
  QPushButton* const stop_;
  QPushButton* const adopt_;
  QProgressBar* const progress_;
  QLabel* const state_;
  ScorePlot* const plot_;
  QTableWidget* const table_;
  QProcess process_;
  bool stopping_ = false;
  QTimer timer_;
  std::optional<StudyRun> run_;
  StudySettings other_;              // those that have no field: population, spread, search
  std::vector<std::size_t> listed_;  // evaluations in the table
};

}  // namespace koboshi::studio
