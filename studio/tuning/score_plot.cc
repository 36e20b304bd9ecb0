#include "studio/tuning/score_plot.h"

#include <QPainter>
#include <algorithm>
#include <cmath>
#include <utility>

#include "studio/plot/plot_style.h"

namespace koboshi::studio {
namespace {

constexpr int kLines = 4;  // of the grid
constexpr double kPoint_px = 2.5;

}  // namespace

ScorePlot::ScorePlot(QWidget* parent) : QWidget(parent) {
  setAccessibleName(tr("Score of each evaluation"));
  setToolTip(tr("Points: score of each evaluation; line: the best so far"));
}

void ScorePlot::set_scores(std::vector<std::optional<double>> scores, std::size_t total) {
  if (scores == scores_ && total == total_) return;
  scores_ = std::move(scores);
  total_ = std::max(total, scores_.size());
  setAccessibleDescription(text());
  update();
}

QString ScorePlot::text() const {
  std::optional<double> best;
  for (const auto& score : scores_) best = std::max(best, score);
  if (!best) return tr("No evaluation yet");
  return tr("%1 of %2 candidates, best score %3").arg(scores_.size()).arg(total_).arg(*best, 0, 'f', 4);
}

ScorePlot::Range ScorePlot::range() const {
  std::optional<Range> found;
  for (const auto& score : scores_) {
    if (!score) continue;
    if (!found) found = Range{*score, *score};
    found = Range{std::min(found->low, *score), std::max(found->high, *score)};
  }
  if (!found) return {};
  const double margin = std::max(0.02, 0.08 * (found->high - found->low));
  return {found->low - margin, found->high + margin};
}

void ScorePlot::draw_axes(QPainter& painter, const QRectF& area, const Range& range) const {
  QColor grid = palette().color(QPalette::Text);
  grid.setAlphaF(0.18F);
  for (int i = 0; i <= kLines; ++i) {
    const double value = range.low + (range.high - range.low) * i / kLines;
    const double y = area.bottom() - area.height() * i / kLines;
    painter.setPen(grid);
    painter.drawLine(QPointF(area.left(), y), QPointF(area.right(), y));
    painter.setPen(palette().color(QPalette::Text));
    painter.drawText(QRectF(0.0, y - 8.0, area.left() - 4.0, 16.0), Qt::AlignRight | Qt::AlignVCenter,
                     QString::number(value, 'f', 2));
  }
  painter.drawText(QRectF(area.left(), area.bottom() + 2.0, area.width(), 16.0), Qt::AlignLeft,
                   QStringLiteral("1"));
  painter.drawText(QRectF(area.left(), area.bottom() + 2.0, area.width(), 16.0), Qt::AlignRight,
                   QString::number(total_));
  painter.drawText(QRectF(area.left(), area.bottom() + 2.0, area.width(), 16.0), Qt::AlignHCenter,
                   tr("evaluation"));
}

void ScorePlot::paintEvent(QPaintEvent* /*event*/) {
  QPainter painter(this);
  painter.setRenderHint(QPainter::Antialiasing);
  painter.fillRect(rect(), palette().color(QPalette::Base));
  const double left = fontMetrics().horizontalAdvance(QStringLiteral("-00.00")) + 6.0;
  const QRectF area(left, 8.0, std::max(1.0, width() - left - 8.0), std::max(1.0, height() - 30.0));
  const Range shown = range();
  draw_axes(painter, area, shown);
  const bool dark = palette().color(QPalette::Base).lightness() < 128;
  const auto colours = trace_colours(dark);
  const auto place = [&](std::size_t index, double score) {
    const double last = std::max<double>(1.0, static_cast<double>(total_) - 1.0);
    return QPointF(area.left() + area.width() * static_cast<double>(index) / last,
                   area.bottom() - area.height() * (score - shown.low) / (shown.high - shown.low));
  };
  std::optional<double> best;
  QPolygonF line;
  painter.setPen(Qt::NoPen);
  painter.setBrush(QColor::fromRgb(colours[0]));
  for (std::size_t i = 0; i < scores_.size(); ++i) {
    if (scores_[i]) painter.drawEllipse(place(i, *scores_[i]), kPoint_px, kPoint_px);
    if (best) line << place(i, *best);
    best = std::max(best, scores_[i]);
    if (best) line << place(i, *best);
  }
  painter.setPen(QPen(QColor::fromRgb(colours[1]), 1.5));
  painter.setBrush(Qt::NoBrush);
  painter.drawPolyline(line);
}

}  // namespace koboshi::studio
