#pragma once

#include <QWidget>
#include <cstddef>
#include <cstdint>

#include "studio/parameters/comparison.h"
#include "studio/plot/run_samples.h"

class QComboBox;

namespace koboshi::studio {

class PlotWidget;
class TimeView;

// One quantity of both runs of a comparison and its difference over time, chosen from a list.
class ComparePlot final : public QWidget {
  Q_OBJECT

 public:
  explicit ComparePlot(QWidget* parent = nullptr);

  // Shows another comparison, which must outlive the plot or the next call. Follows its end.
  void set_comparison(const Comparison& comparison);
  // Adds the samples that both have since.
  void grow();
  // Whether the newest sample is to be shown.
  bool follows() const;
  void set_cursor(std::uint64_t time_us);

 Q_SIGNALS:
  // The user looks at this moment.
  void cursor_moved(std::uint64_t time_us);

 private:
  void choose();
  void append_samples();
  double quantity(std::size_t run, std::size_t sample) const;

  const Comparison* comparison_ = nullptr;
  QComboBox* const quantity_;
  TimeView* const time_;
  PlotWidget* const plot_;
  RunSamples samples_;
  std::size_t sampled_ = 0;  // samples in the plot
};

}  // namespace koboshi::studio
