#include "studio/plot/trace_painter.h"

#include <QPainter>
#include <QPolygonF>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace koboshi::studio {
namespace {

constexpr double kLineWidth = 1.6;
constexpr double kColumnLineWidth = 1.5;   // of a line in columns, horizontally
constexpr double kColumnLineHeight = 1.5;  // and vertically
constexpr double kDashPeriod_px = 9.0;     // the dashes stay at their times when the range moves
constexpr double kDashLength_px = 6.0;
constexpr double kMaxLineDensity = 1.0;  // samples per pixel that are still drawn one by one
constexpr double kMaxDotDensity = 0.08;  // samples per pixel that are still drawn as dots, too
constexpr double kDotRadius_px = 2.2;
// Qt's time for a polyline grows with the square of the number of points in a row of pixels.
constexpr qsizetype kPiece = 12;

// Draws a line in pieces, which have a segment in common, so that their joints are filled.
void draw_pieces(QPainter& painter, const QPolygonF& line) {
  for (qsizetype first = 0; first + 1 < line.size(); first += kPiece - 2)
    painter.drawPolyline(line.constData() + first, static_cast<int>(std::min(kPiece, line.size() - first)));
}

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
      if (!is_dash) flush();  // a dash may have ended at the end of a segment
      if (is_dash) {
        if (dash.isEmpty()) dash << at(x);
        dash << (next < b.x() ? at(next) : b);
      }
      if (next >= b.x()) break;
      x = next;
    }
  }
  flush();
}

constexpr std::size_t kHalves = 2;

// The part of a column of pixels that a line covers, in pixels; top >= bottom: nothing.
struct Reach {
  double top = std::numeric_limits<double>::infinity();
  double bottom = 0.0;

  double share_of(int y) const {
    return std::clamp(std::min(bottom, y + 1.0) - std::max(top, static_cast<double>(y)), 0.0, 1.0);
  }
};

class TracePainter {
 public:
  TracePainter(QImage& picture, const Trace& trace, const PlotArea& area, const QColor& colour)
      : picture_(picture), trace_(trace), area_(area), colour_(colour) {
    const double px_per_us = area.rect.width() / (area.to_us - area.from_us);
    phase_ = area.rect.left() - std::fmod(area.from_us * px_per_us, kDashPeriod_px);
  }

  void draw() {
    std::size_t nodes = 0;
    const SampleTimes& times = *trace_.times;
    const std::size_t size = std::min(times.size(), trace_.values->size());
    const std::size_t begin = times.count_before(area_.from_us, 0, nodes);
    const std::size_t end = std::min(size, times.count_before(area_.to_us, begin, nodes));
    const double density = static_cast<double>(end - begin) / area_.rect.width();
    if (density > kMaxLineDensity) return draw_columns();
    QPainter painter(&picture_);
    painter.setClipRect(area_.rect);
    painter.setRenderHint(QPainter::Antialiasing);
    draw_lines(painter, begin == 0 ? 0 : begin - 1, std::min(size, end + 1));
    if (density <= kMaxDotDensity) draw_dots(painter, begin, end);
  }

 private:
  // The samples from first to before last as lines; gaps interrupt them.
  void draw_lines(QPainter& painter, std::size_t first, std::size_t last) {
    QPolygonF line;
    const auto flush = [&] {
      painter.setPen(QPen(colour_, kLineWidth, Qt::SolidLine, Qt::FlatCap, Qt::BevelJoin));
      if (line.size() == 1) {
        painter.setPen(QPen(colour_, 2.0 * kLineWidth, Qt::SolidLine, Qt::RoundCap));
        painter.drawPoint(line.front());
      } else if (line.size() > 1 && trace_.dashed) {
        draw_dashes(painter, line, phase_);
      } else if (line.size() > 1) {
        draw_pieces(painter, line);
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

  void draw_dots(QPainter& painter, std::size_t first, std::size_t last) {
    painter.setPen(Qt::NoPen);
    painter.setBrush(colour_);
    for (std::size_t i = first; i < last; ++i) {
      const float value = (*trace_.values)[i];
      if (!std::isfinite(value)) continue;
      const QPointF centre(area_.x(static_cast<double>((*trace_.times)[i])),
                           area_.y(static_cast<double>(value)));
      painter.drawEllipse(centre, kDotRadius_px, kDotRadius_px);
    }
  }

  // The extent of the line within each half of a pixel column, which the line's width joins with its
  // neighbours'. Halves begin at multiples of their duration, so that a range that moves shows the same ones.
  void draw_columns() {
    const double scale = picture_.devicePixelRatio();
    const double duration_us = (area_.to_us - area_.from_us) / (area_.rect.width() * scale * kHalves);
    const double begin_us =
        (std::floor(area_.from_us / (duration_us * kHalves)) - 1.0) * duration_us * kHalves;
    const auto pixels = static_cast<std::size_t>(std::ceil(area_.rect.width() * scale)) + 3;
    std::vector<Column> halves(kHalves * pixels);
    summarise(*trace_.times, *trace_.values, begin_us,
              begin_us + static_cast<double>(halves.size()) * duration_us, halves);
    connect(halves);
    const double left = area_.x(begin_us) * scale;
    const auto reach = static_cast<std::size_t>(kColumnLineWidth * scale - 0.5);  // halves on each side
    for (std::size_t i = 1; i + 1 < pixels; ++i) {
      const double x = left + static_cast<double>(i);
      const double place =
          x / scale - phase_ - kDashPeriod_px * std::floor((x / scale - phase_) / kDashPeriod_px);
      if (trace_.dashed && place >= kDashLength_px) continue;
      std::array<Reach, kHalves> reaches;
      for (std::size_t half = 0; half < kHalves; ++half) {
        const std::size_t middle = kHalves * i + half;
        Extent extent;
        for (std::size_t k = middle - std::min(reach, middle); k <= middle + reach && k < halves.size(); ++k)
          extent.add(halves[k].extent);
        reaches[half] = reach_of(extent);
      }
      fill_column(static_cast<int>(std::lround(x)), reaches);
    }
  }

  // The part of a column of device pixels that the line covers.
  Reach reach_of(const Extent& extent) const {
    if (extent.empty()) return {};
    const double scale = picture_.devicePixelRatio();
    const double top = area_.y(static_cast<double>(extent.high)) - 0.5 * kColumnLineHeight;
    const double bottom = area_.y(static_cast<double>(extent.low)) + 0.5 * kColumnLineHeight;
    return {std::max(top, area_.rect.top()) * scale, std::min(bottom, area_.rect.bottom()) * scale};
  }

  // Adds to the extents what the straight lines between the columns' samples cover. Gaps are not connected.
  static void connect(std::span<Column> columns) {
    const auto with_samples = [&](std::size_t i) {
      while (i < columns.size() && columns[i].samples == 0) ++i;
      return i;
    };
    std::size_t from = with_samples(0);
    while (from < columns.size()) {
      const std::size_t to = with_samples(from + 1);
      if (to == columns.size()) return;
      const float start = columns[from].last;
      const float end = columns[to].first;
      if (std::isfinite(start) && std::isfinite(end)) {
        const float slope = (end - start) / static_cast<float>(to - from);
        float edge = start + 0.5F * slope;  // at the right edge of a column
        columns[from].extent.add({edge, edge});
        for (std::size_t i = from + 1; i < to; ++i, edge += slope)
          columns[i].extent.add({std::min(edge, edge + slope), std::max(edge, edge + slope)});
        columns[to].extent.add({edge, edge});
      }
      from = to;
    }
  }

  // Fills a column of device pixels; pixels that are covered in part are blended.
  void fill_column(int x, std::span<const Reach, kHalves> reaches) {
    const double scale = picture_.devicePixelRatio();
    if (x < std::lround(area_.rect.left() * scale) || x >= std::lround(area_.rect.right() * scale)) return;
    const double top = std::min(reaches[0].top, reaches[1].top);
    const double bottom = std::max(reaches[0].bottom, reaches[1].bottom);
    const int first = std::max(0, static_cast<int>(std::floor(std::min(top, 1e6))));
    const int last = std::min(picture_.height() - 1, static_cast<int>(std::ceil(bottom)) - 1);
    if (first > last) return;
    const qsizetype stride = picture_.bytesPerLine() / static_cast<qsizetype>(sizeof(QRgb));
    QRgb* pixel = reinterpret_cast<QRgb*>(picture_.scanLine(first)) + x;
    const double whole_top = std::max(reaches[0].top, reaches[1].top);
    const double whole_bottom = std::min(reaches[0].bottom, reaches[1].bottom);
    const QRgb colour = colour_.rgb();
    for (int y = first; y <= last; ++y, pixel += stride) {
      const bool is_whole = y >= whole_top && y + 1 <= whole_bottom;
      *pixel = is_whole ? colour : blended(*pixel, 0.5 * (reaches[0].share_of(y) + reaches[1].share_of(y)));
    }
  }

  QRgb blended(QRgb below, double share) const {
    const auto mix = [share](int a, int b) { return a + static_cast<int>(share * (b - a)); };
    return qRgb(mix(qRed(below), colour_.red()), mix(qGreen(below), colour_.green()),
                mix(qBlue(below), colour_.blue()));
  }

  QImage& picture_;
  const Trace& trace_;
  const PlotArea& area_;
  QColor colour_;
  double phase_ = 0.0;
};

}  // namespace

void draw_trace(QImage& picture, const Trace& trace, const PlotArea& area, const QColor& colour) {
  if (trace.times->empty() || picture.isNull()) return;
  TracePainter(picture, trace, area, colour).draw();
}

}  // namespace koboshi::studio
