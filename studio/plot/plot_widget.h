#pragma once

#include <QImage>
#include <QStringList>
#include <vector>

#include "studio/plot/plot_legend.h"
#include "studio/plot/plot_style.h"
#include "studio/plot/run_samples.h"
#include "studio/plot/time_axis_widget.h"
#include "studio/plot/trace_painter.h"

namespace koboshi::studio {

// A range of values that means something, such as a limit; in the unit of the traces.
struct ValueBand {
  double low = 0.0;
  double high = 0.0;
};

// Traces of one unit over a common time axis, with a legend that shows the values at the cursor.
class PlotWidget final : public TimeAxisWidget {
  Q_OBJECT

 public:
  PlotWidget(TimeView& view, QWidget* parent);

  void set_traces(std::vector<Trace> traces);
  const std::vector<Trace>& traces() const { return traces_; }
  // Bands are drawn where they are visible; they do not extend the axis of values.
  void set_bands(std::vector<ValueBand> bands);
  // Vertical lines. The vector outlives the widget.
  void set_marks(const std::vector<Mark>* marks);
  // Whether the time axis has labels: that of the lowest of several plots.
  void set_time_labels(bool shown);
  // To be called after samples or marks have changed: repaints everything.
  void refresh();

  // The shown range of values, in the unit of the traces.
  std::pair<double, double> limits() const;
  // Height of the curves below the legend.
  double curve_height() const { return area().rect.height(); }
  // The texts of the legend, without the values.
  QStringList legend_texts() const { return legend_.texts(); }
  // The name of the trace at a place of the legend; empty if there is none.
  QString legend_at(const QPointF& place) const;
  // The values of all traces at a time, as text with units.
  QString values_text(double time_us) const;

  QSize sizeHint() const override { return {600, 150}; }
  QSize minimumSizeHint() const override { return {240, 84}; }

 protected:
  std::optional<std::uint64_t> neighbour_us(std::uint64_t time_us, bool forward) const override;
  bool event(QEvent* event) override;
  void changeEvent(QEvent* event) override;
  void paintEvent(QPaintEvent* event) override;
  void resizeEvent(QResizeEvent* event) override;

 private:
  void lay_out_legend();
  void update_accessible_text();
  ShownUnit unit() const;
  double step_of(const PlotArea& area, const ShownUnit& unit) const;
  PlotArea area() const;
  void draw_all();
  void draw_bands(QPainter& painter, const PlotArea& area, const PlotStyle& style) const;
  void draw_value_axis(QPainter& painter, const PlotArea& area, const PlotStyle& style) const;
  void draw_time_axis(QPainter& painter, const PlotArea& area, const PlotStyle& style) const;
  void draw_marks(QPainter& painter, const PlotArea& area, const PlotStyle& style) const;
  void draw_legend(QPainter& painter) const;
  QString value_at(const Trace& trace, double time_us, const ShownUnit& unit, int decimals) const;

  std::vector<Trace> traces_{};
  std::vector<ValueBand> bands_{};
  const std::vector<Mark>* marks_ = nullptr;
  bool time_labels_ = true;
  PlotLegend legend_{};
  QImage picture_{};  // everything but legend, cursor and selection
  bool is_stale_ = true;
};

}  // namespace koboshi::studio
