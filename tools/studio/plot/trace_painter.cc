#include "tools/studio/plot/trace_painter.h"

#include <QPolygonF>
#include <algorithm>
#include <cmath>
#include <vector>

namespace koboshi::studio {
namespace {

constexpr double kLineWidth = 1.6;
constexpr double kDashPeriod_px = 9.0;  // the dashes stay at their times when the range moves
constexpr double kDashLength_px = 6.0;
constexpr double kMaxLineDensity = 0.6;  // samples per pixel that are still drawn one by one
constexpr double kMaxDotDensity = 0.08;  // samples per pixel that are still drawn as dots, too
constexpr double kDotRadius_px = 2.2;

// Draws the parts of a line that lie in dashes, which begin at x = phase + n * kDashPeriod_px.
void draw_dashes(QPainter& painter, const QPolygonF& line, double phase) {
  QPolygonF dash;
  const auto flush = [&] {
    if (dash.size() > 1) painter.drawPolyline(dash);
    dash.clear();
  };
  for (qsizetype i = 0; i + 1 < line.size(); ++i) {
    const QPointF a = line[i];
    const QPointF b = line[i + 1];
    double x = a.x();
    while (true) {
      const double place = x - phase - kDashPeriod_px * std::floor((x - phase) / kDashPeriod_px);
      const bool is_dash = place < kDashLength_px;
      const double next = std::max(x + 1e-6, x - place + (is_dash ? kDashLength_px : kDashPeriod_px));
      const auto at = [&](double px) {
        return b.x() > a.x() ? a + (px - a.x()) / (b.x() - a.x()) * (b - a) : b;
      };
      if (is_dash) {
        if (dash.isEmpty()) dash << at(x);
        dash << (next < b.x() ? at(next) : b);
      }
      if (next >= b.x()) break;
      if (is_dash) flush();
      x = next;
    }
  }
  flush();
}

class TracePainter {
 public:
  TracePainter(QPainter& painter, const Trace& trace, const PlotArea& area, const QColor& colour)
      : painter_(painter), trace_(trace), area_(area), colour_(colour) {
    const double px_per_us = area.rect.width() / (area.to_us - area.from_us);
    phase_ = area.rect.left() - std::fmod(area.from_us * px_per_us, kDashPeriod_px);
  }

  void draw() {
    std::size_t nodes = 0;
    const Timeline& times = *trace_.times;
    const std::size_t size = std::min(times.size(), trace_.values->size());
    const std::size_t begin = times.count_before(area_.from_us, 0, nodes);
    const std::size_t end = times.count_before(area_.to_us, begin, nodes);
    if (static_cast<double>(end - begin) <= kMaxLineDensity * area_.rect.width()) {
      draw_lines(begin == 0 ? 0 : begin - 1, std::min(size, end + 1));
      if (static_cast<double>(end - begin) <= kMaxDotDensity * area_.rect.width()) draw_dots(begin, end);
    } else {
      draw_columns();
    }
  }

 private:
  // The samples from first to before last as lines; gaps interrupt them.
  void draw_lines(std::size_t first, std::size_t last) {
    QPolygonF line;
    const auto flush = [&] {
      painter_.setPen(QPen(colour_, kLineWidth, Qt::SolidLine, Qt::FlatCap, Qt::BevelJoin));
      if (line.size() == 1) {
        painter_.setPen(QPen(colour_, 2.0 * kLineWidth, Qt::SolidLine, Qt::RoundCap));
        painter_.drawPoint(line.front());
      } else if (line.size() > 1 && trace_.dashed) {
        draw_dashes(painter_, line, phase_);
      } else if (line.size() > 1) {
        painter_.drawPolyline(line);
      }
      line.clear();
    };
    const bool is_stepped = !trace_.signal.names.empty();
    for (std::size_t i = first; i < last; ++i) {
      const float value = (*trace_.values)[i];
      if (!std::isfinite(value)) {
        flush();
        continue;
      }
      const QPointF point(area_.x(static_cast<double>((*trace_.times)[i])),
                          area_.y(static_cast<double>(value)));
      if (is_stepped && !line.isEmpty()) line << QPointF(point.x(), line.back().y());
      line << point;
    }
    flush();
  }

  void draw_dots(std::size_t first, std::size_t last) {
    painter_.setPen(Qt::NoPen);
    painter_.setBrush(colour_);
    for (std::size_t i = first; i < last; ++i) {
      const float value = (*trace_.values)[i];
      if (!std::isfinite(value)) continue;
      const QPointF centre(area_.x(static_cast<double>((*trace_.times)[i])),
                           area_.y(static_cast<double>(value)));
      painter_.drawEllipse(centre, kDotRadius_px, kDotRadius_px);
    }
  }

  // The envelope of the samples of each column. Columns begin at multiples of their duration, so that a range
  // that moves shows the same columns.
  void draw_columns() {
    const double scale = painter_.device()->devicePixelRatioF();
    const auto count = static_cast<std::size_t>(std::ceil(area_.rect.width() * scale)) + 2;
    const double duration_us = (area_.to_us - area_.from_us) / (area_.rect.width() * scale);
    const double number = std::floor(area_.from_us / duration_us);
    const double begin_us = number * duration_us;
    std::vector<Column> columns(count);
    summarise(*trace_.times, *trace_.values, begin_us, begin_us + static_cast<double>(count) * duration_us,
              columns);

    painter_.setPen(Qt::NoPen);
    painter_.setBrush(colour_);
    float before = std::numeric_limits<float>::quiet_NaN();
    for (std::size_t i = 0; i < count; ++i) {
      Column& column = columns[i];
      if (column.samples == 0) continue;
      if (!std::isfinite(before) || !std::isfinite(column.first)) flush();
      const double x = area_.x(begin_us + (static_cast<double>(i) + 0.5) * duration_us);
      if (std::isfinite(before) && std::isfinite(column.first)) column.extent.add({before, before});
      before = column.last;
      if (column.extent.empty()) continue;
      const double place = std::fmod(x - phase_ + kDashPeriod_px, kDashPeriod_px);
      if (trace_.dashed && place >= kDashLength_px) {
        flush();
        continue;
      }
      upper_ << QPointF(x, area_.y(static_cast<double>(column.extent.high)) - 0.5 * kLineWidth);
      lower_ << QPointF(x, area_.y(static_cast<double>(column.extent.low)) + 0.5 * kLineWidth);
    }
    flush();
  }

  void flush() {
    if (upper_.isEmpty()) return;
    if (upper_.size() == 1) {  // a single column keeps a width
      upper_ = {upper_[0] - QPointF(0.5, 0.0), upper_[0] + QPointF(0.5, 0.0)};
      lower_ = {lower_[0] - QPointF(0.5, 0.0), lower_[0] + QPointF(0.5, 0.0)};
    }
    std::ranges::reverse(lower_);
    upper_ += lower_;
    painter_.drawPolygon(upper_);
    upper_.clear();
    lower_.clear();
  }

  QPainter& painter_;
  const Trace& trace_;
  const PlotArea& area_;
  QColor colour_;
  double phase_ = 0.0;
  QPolygonF upper_{};
  QPolygonF lower_{};
};

}  // namespace

void draw_trace(QPainter& painter, const Trace& trace, const PlotArea& area, const QColor& colour) {
  if (trace.times->empty()) return;
  TracePainter(painter, trace, area, colour).draw();
}

}  // namespace koboshi::studio
