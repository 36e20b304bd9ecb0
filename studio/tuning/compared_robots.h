#pragma once

#include <QColor>
#include <QString>
#include <QWidget>
#include <array>
#include <cstddef>
#include <cstdint>

#include "studio/parameters/comparison.h"

class QLabel;

namespace koboshi::studio {

class RobotView;

// The colour of a run in pictures, tables and plots.
QColor colour_of_run(std::size_t run);

// Both robots of a comparison in one view, beside each other, tinted, with their names above them.
class ComparedRobots final : public QWidget {
  Q_OBJECT

 public:
  explicit ComparedRobots(QWidget* parent = nullptr);

  RobotView& view() { return *view_; }
  void set_scenes(const Comparison& comparison, const std::array<QString, Comparison::kRuns>& names);
  // Shows the robots at this time.
  void show_time(const Comparison& comparison, std::uint64_t time_us);

 protected:
  bool eventFilter(QObject* watched, QEvent* event) override;

 private:
  void place_names();

  RobotView* const view_;
  std::array<QLabel*, Comparison::kRuns> names_{};
};

}  // namespace koboshi::studio
