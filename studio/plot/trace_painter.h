#pragma once

#include <QColor>
#include <QImage>
#include <QRectF>
#include <memory>

#include "studio/plot/series.h"
#include "view/recording/recording.h"

namespace koboshi::studio {

// A series of a plot, with its name, unit and names of values. The plot does not know where its samples come
// from.
struct Trace {
  view::Signal signal{};
  std::shared_ptr<const SampleTimes> times{};
  std::shared_ptr<const Series> values{};
  int colour = 0;       // index of PlotStyle::trace
  bool dashed = false;  // planned and commanded values
};

// The part of the plane that a plot shows, and where: times and values in the units of the samples.
struct PlotArea {
  QRectF rect{};
  double from_us = 0.0;
  double to_us = 1.0;
  double low = 0.0;
  double high = 1.0;

  double x(double time_us) const {
    return rect.left() + (time_us - from_us) / (to_us - from_us) * rect.width();
  }
  double y(double value) const { return rect.bottom() - (value - low) / (high - low) * rect.height(); }
};

// Draws a trace into a picture of Format_RGB32: where samples are rare, as a line from sample to sample; else
// pixel column by pixel column from the lowest to the highest value. Names of values are drawn as steps.
void draw_trace(QImage& picture, const Trace& trace, const PlotArea& area, const QColor& colour);

}  // namespace koboshi::studio
