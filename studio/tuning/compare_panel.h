#pragma once

#include <QElapsedTimer>
#include <QString>
#include <QTimer>
#include <QWidget>
#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <vector>

#include "studio/parameters/comparison.h"

class QComboBox;
class QDoubleSpinBox;
class QHBoxLayout;
class QPushButton;
class QTableWidget;

namespace koboshi::studio {

class ComparePlot;
class ComparedRobots;
class RobotView;

// Two sets of parameters that walk beside each other: both robots in one view, a quantity of both and its
// difference over time, and the results in a table.
class ComparePanel final : public QWidget {
  Q_OBJECT

 public:
  // Gives a scenario the values of a set. Usable in any thread.
  using Set = std::function<void(simulation::Scenario&)>;

  explicit ComparePanel(QWidget* parent = nullptr);
  ~ComparePanel() override;

  // The set that the user edits, as it is when a comparison starts.
  void set_edited(std::function<Set()> edited) { edited_ = std::move(edited); }
  // The scenario of the next comparison; without one, none can start.
  void set_scenario(const std::filesystem::path& scenario, std::uint64_t seed);
  // Keeps the edited set under a name, as a choice.
  void keep();
  // Reads the scenario and lets the two sets walk.
  void start();
  void set_playing(bool playing);
  // Null before the first comparison.
  Comparison* comparison() { return comparison_.get(); }
  RobotView& view();
  QTableWidget& table() { return *table_; }

 Q_SIGNALS:
  void started();
  void failed(const QString& message);

 private:
  static constexpr std::size_t kRuns = Comparison::kRuns;

  QHBoxLayout* make_sets();
  QHBoxLayout* make_commands();
  QWidget* make_results();
  Set set_of(const QComboBox& choice) const;
  void show_started(std::unique_ptr<Comparison> comparison);
  void walk();
  void tick();
  void show_grown();
  void show_time(std::uint64_t time_us);
  void show_results();

  std::function<Set()> edited_;
  std::filesystem::path scenario_;
  std::uint64_t seed_ = 1;
  std::vector<Set> kept_;
  std::unique_ptr<Comparison> comparison_;
  std::uint64_t request_ = 0;  // the last start: an earlier one that comes late is dropped
  bool playing_ = false;

  std::array<QComboBox*, kRuns> choices_{};
  QPushButton* start_;
  QPushButton* play_;
  QComboBox* speed_;
  QDoubleSpinBox* forward_;
  QDoubleSpinBox* left_;
  QDoubleSpinBox* turn_;
  ComparedRobots* robots_;
  QTableWidget* table_;
  ComparePlot* plot_;
  QTimer timer_;
  QElapsedTimer wall_;
  QElapsedTimer results_age_;
};

}  // namespace koboshi::studio
