#pragma once

#include "studio/plot/run_samples.h"
#include "studio/plot/time_axis_widget.h"

namespace koboshi::studio {

// The robot's states as coloured spans, and the events with as much of their text as has room, over the
// common time axis.
class EventStrip final : public TimeAxisWidget {
  Q_OBJECT

 public:
  // The view and the samples outlive the widget.
  EventStrip(TimeView& view, const RunSamples& samples, QWidget* parent);

  // The state and the events at a place, as text.
  QString text_at(const QPointF& place) const;

  QSize sizeHint() const override;
  QSize minimumSizeHint() const override { return sizeHint(); }

 protected:
  std::optional<std::uint64_t> neighbour_us(std::uint64_t time_us, bool forward) const override;
  bool event(QEvent* event) override;
  void paintEvent(QPaintEvent* event) override;

 private:
  void draw_states(QPainter& painter) const;
  void draw_events(QPainter& painter) const;
  double state_height() const;

  const RunSamples& samples_;
};

}  // namespace koboshi::studio
