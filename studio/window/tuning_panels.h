#pragma once

#include <QObject>
#include <cstddef>
#include <filesystem>

#include "studio/parameters/study_runs.h"
#include "studio/widgets/message_kind.h"

namespace koboshi::studio {

class ComparePanel;
class ParameterPanel;
class RunController;
class StudyPanel;

// The panels of parameters, comparisons and studies, connected with the run and with each other.
class TuningPanels final : public QObject {
  Q_OBJECT

 public:
  // The run must outlive this object. The panels get their parents where they are shown.
  explicit TuningPanels(RunController& run, QObject* parent = nullptr);

  ParameterPanel& parameters() { return *parameters_; }
  ComparePanel& comparison() { return *comparison_; }
  StudyPanel& studies() { return *studies_; }

  // Shows the parameters and studies of this robot while no run is open.
  void set_robot(const sim_board::RobotDescription& robot);
  // Whether the parameters beside this robot's file, and this gait, are those that are open.
  bool shows_parameters_of(const std::filesystem::path& robot) const;
  bool shows_gait(const std::filesystem::path& gait) const;

 Q_SIGNALS:
  // One line for the user.
  void told(const QString& message, koboshi::studio::MessageKind kind);
  // The user wants the scenario to start again.
  void restart_wanted();

 private:
  void connect_run();
  void connect_panels();
  void show_opened();
  void adopt(const StudyRun& run, const StudyEvaluation& evaluation);

  RunController& run_;
  ParameterPanel* const parameters_;
  ComparePanel* const comparison_;
  StudyPanel* const studies_;
};

}  // namespace koboshi::studio
