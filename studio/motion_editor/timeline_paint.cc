#include <QItemSelection>
#include <QPaintEvent>
#include <QPainter>
#include <QPainterPath>
#include <algorithm>
#include <array>
#include <cmath>

#include "studio/motion_editor/timeline.h"
#include "studio/motion_editor/timeline_layout.h"

// The painting of the timeline.
namespace koboshi::studio {
namespace {

using PaintKind = simulation::StepSource::Kind;

void paint_head(QPainter& painter, QPointF tip, QPointF direction) {
  const QPointF across(-direction.y(), direction.x());
  QPolygonF head;
  head << tip << tip - 6 * direction + 3 * across << tip - 6 * direction - 3 * across;
  painter.save();
  painter.setBrush(painter.pen().color());
  painter.setPen(Qt::NoPen);
  painter.drawPolygon(head);
  painter.restore();
}

QFont small(const QFont& font) {
  QFont other = font;
  other.setPointSizeF(font.pointSizeF() * 0.85);
  return other;
}

// A step of the ruler: 1, 2 or 5 times a power of ten.
double ruler_step_s(double px_per_s) {
  constexpr double kLeastDistance_px = 70.0;
  double step_s = 0.01;
  for (int i = 0; step_s * px_per_s < kLeastDistance_px; ++i) step_s *= i % 3 == 1 ? 2.5 : 2.0;
  return step_s;
}

}  // namespace

void Timeline::paintEvent(QPaintEvent* event) {
  QPainter painter(viewport());
  const Colours colours = colours_of(palette());
  painter.fillRect(event->rect(), palette().color(QPalette::Base));
  if (!editor_.is_open() || section_ >= editor_.rows().sections.size()) return;
  painter.setFont(small(font()));
  painter.setRenderHint(QPainter::Antialiasing);
  paint_ruler(painter, colours);
  painter.setClipRect(QRect(kLeft - 8, 0, viewport()->width() - kLeft + 8, viewport()->height()));
  paint_margin(painter, colours);
  paint_curves(painter, colours);
  paint_arrows(painter, colours);
  paint_steps(painter, colours);
  paint_scrub(painter, colours);
  if (mode_ == Mode::kBox) {
    painter.setPen(colours.key);
    QColor fill = colours.key;
    fill.setAlpha(40);
    painter.setBrush(fill);
    painter.drawRect(QRectF(QPointF(press_.x(), kRuler), QPointF(pointer_.x(), lanes().margin)).normalized());
  }
}

void Timeline::paint_ruler(QPainter& painter, const Colours& colours) const {
  const Lanes lane = lanes();
  const int width = viewport()->width();
  painter.fillRect(0, 0, width, kRuler, palette().color(QPalette::AlternateBase));
  painter.fillRect(kLeft, lane.steps, width, kSteps, colours.lane);
  const double step_s = ruler_step_s(px_per_s_);
  for (double time_s = std::max(0.0, std::ceil(time_at(kLeft) / step_s) * step_s); x_of(time_s) < width;
       time_s += step_s) {
    const double x = std::round(x_of(time_s)) + 0.5;
    painter.setPen(colours.grid);
    painter.drawLine(QPointF(x, kRuler), QPointF(x, viewport()->height()));
    painter.setPen(colours.dim);
    const QString text = QString::number(time_s, 'f', step_s < 0.1 ? 2 : step_s < 1.0 ? 1 : 0);
    painter.drawText(QRectF(x + 3, 0, 70, kRuler), Qt::AlignVCenter, text + tr(" s"));
  }
  painter.setPen(colours.dim);
  const std::string& name = editor_.rows().sections[section_].name;
  if (!name.empty())
    painter.drawText(QRectF(0, 0, width - 6, kRuler), Qt::AlignRight | Qt::AlignVCenter,
                     tr("routine %1").arg(QString::fromStdString(name)));
  const auto title = [&](const QString& text, int y, int height) {
    painter.drawText(QRectF(4, y, kLeft - 8, height), Qt::AlignLeft | Qt::AlignVCenter, text);
  };
  title(tr("steps"), lane.steps, kSteps);
  painter.setPen(colours.grid);
  for (const int y : {lane.margin, lane.curves})
    painter.drawLine(QPointF(0, y + 0.5), QPointF(width, y + 0.5));
}

// --- Steps

void Timeline::paint_steps(QPainter& painter, const Colours& colours) const {
  const MotionSection& section = editor_.rows().sections[section_];
  std::vector<bool> is_selected(editor_.rows().rows.size(), false);
  for (const QItemSelectionRange& range : selection_.selection()) {
    for (int row = range.top(); row <= range.bottom(); ++row)
      if (static_cast<std::size_t>(row) < is_selected.size())
        is_selected[static_cast<std::size_t>(row)] = true;
  }
  const std::size_t end = section.first_row + section.row_count;
  const int width = viewport()->width();
  for (const bool pass : {false, true}) {  // selected steps above the others
    for (std::size_t row = section.first_row; row < end; ++row) {
      const MotionRow& step = editor_.rows().rows[row];
      if (is_selected[row] != pass || x_of(step.start_s) > width + 10 ||
          x_of(step.start_s + step.duration_s) < 0)
        continue;
      paint_step(painter, colours, row, pass);
    }
  }
  if (mode_ != Mode::kScale) return;
  // Where the selected steps would end.
  const auto rows = selected();
  const double begin_s = editor_.rows().rows[rows.front()].start_s;
  painter.setPen(QPen(colours.key, 1.2, Qt::DashLine));
  for (const std::size_t row : rows) {
    const MotionRow& step = editor_.rows().rows[row];
    const double x = x_of(begin_s + (step.start_s + step.duration_s - begin_s) * drag_factor_);
    painter.drawLine(QPointF(x, lanes().arrows), QPointF(x, lanes().margin));
  }
}

void Timeline::paint_step(QPainter& painter, const Colours& colours, std::size_t row,
                          bool is_selected) const {
  const MotionRow& step = editor_.rows().rows[row];
  const QRectF bar = bar_of(step);
  const QColor highlight = palette().color(QPalette::Highlight);
  int worst = step.has_error ? 0 : 3;
  for (const RowFinding* const finding : editor_.findings_of(row))
    worst = std::min(worst, static_cast<int>(finding->severity));
  const QColor marked = worst < 2 ? colours.of(static_cast<simulation::Severity>(worst)) : QColor();
  if (step.kind == PaintKind::kLoop || step.kind == PaintKind::kIf) return;
  if (step.kind == PaintKind::kLabel || bar.width() < 0.5) {
    const bool is_flag = step.kind == PaintKind::kLabel;
    painter.setPen(QPen(is_selected ? highlight : colours.jump, is_selected ? 2.5 : 1.2));
    painter.drawLine(QPointF(bar.x(), bar.top() - (is_flag ? 8 : 0)), bar.bottomLeft());
    if (is_flag) {
      painter.setBrush(painter.pen().color());
      painter.drawPolygon(
          QPolygonF({{bar.x(), bar.top() - 8}, {bar.x() + 8, bar.top() - 5}, {bar.x(), bar.top() - 2}}));
    }
    if (is_flag) painter.drawText(QPointF(bar.x() + 11, bar.top() - 3), QString::fromStdString(step.label));
    if (!is_flag && marked.isValid()) {
      painter.setBrush(marked);
      painter.drawEllipse(QPointF(bar.x(), bar.center().y()), 3, 3);
    }
    return;
  }
  const bool is_move = step.kind == PaintKind::kMove;
  QColor fill = is_move ? colours.key : colours.wait;
  if (marked.isValid()) fill = marked;
  fill.setAlpha(is_selected ? 130 : 55);
  const double pause_px = step.pause_s * px_per_s_;
  const double gap_px = bar.width() > 4.0 ? 0.5 : 0.0;
  painter.setPen(is_selected ? QPen(highlight, 1.5) : QPen(Qt::NoPen));
  painter.setBrush(is_move ? QBrush(fill) : QBrush(fill, Qt::BDiagPattern));
  painter.drawRoundedRect(bar.adjusted(gap_px, 0, -gap_px - pause_px, 0), 3, 3);
  const QPointF key = key_point(row);
  const double text_px = bar.width() - pause_px - 16;
  if (text_px > 22) {
    painter.setPen(palette().color(QPalette::Text));
    const QString text = painter.fontMetrics().elidedText(QString::fromStdString(step.text), Qt::ElideRight,
                                                          static_cast<int>(text_px));
    painter.drawText(bar.adjusted(8, 0, 0, 0), Qt::AlignVCenter | Qt::AlignLeft, text);
  }
  if (!is_move || (bar.width() < 4 && !is_selected)) return;
  const double size = bar.width() < 12 ? 3.5 : 5.5;
  painter.setBrush(marked.isValid() ? marked : is_selected ? highlight : colours.key);
  painter.setPen(QPen(palette().color(QPalette::Base), 1));
  painter.drawPolygon(QPolygonF({key + QPointF(0, -size - 1), key + QPointF(size, 0),
                                 key + QPointF(0, size + 1), key + QPointF(-size, 0)}));
}

// --- Arrows

void Timeline::paint_loop(QPainter& painter, const Colours& colours, const MotionRow& row) const {
  const Lanes lane = lanes();
  const double begin = x_of(row.start_s);
  const double end = x_of(row.start_s + row.duration_s);
  const double y = lane.steps - 3.5;
  const double top = std::min(y - 6, lane.arrows + 9.0 + 5.0 * row.depth);
  const double round_px = (end - begin) / std::max(1, row.times.value_or(1));
  QColor fill = colours.arrow;
  fill.setAlpha(45);
  painter.fillRect(QRectF(QPointF(begin + round_px, lane.steps + 4), QPointF(end, lane.steps + kSteps - 4)),
                   QBrush(fill, Qt::DiagCrossPattern));
  painter.setPen(QPen(colours.arrow, 1.3));
  painter.setBrush(Qt::NoBrush);
  QPainterPath path(QPointF(end, y));
  const double radius = std::clamp((end - begin) / 2, 0.0, 6.0);
  path.lineTo(end, top + radius);
  path.quadTo(end, top, end - radius, top);
  path.lineTo(begin + radius, top);
  path.quadTo(begin, top, begin, top + radius);
  path.lineTo(begin, y);
  painter.drawPath(path);
  paint_head(painter, {begin, y}, {0, 1});
  const QString text = row.times ? tr("× %1").arg(*row.times) : QString::fromStdString(row.text);
  const QRectF area(begin, top - 9, end - begin, 18);
  const QString shown =
      painter.fontMetrics().elidedText(text, Qt::ElideRight, static_cast<int>(area.width()) - 16);
  if (area.width() < 30) return;
  const double half = painter.fontMetrics().horizontalAdvance(shown) / 2.0 + 4;
  painter.fillRect(QRectF(area.center().x() - half, top - 6, 2 * half, 12), palette().color(QPalette::Base));
  painter.drawText(area, Qt::AlignCenter, shown);
}

void Timeline::paint_arrows(QPainter& painter, const Colours& colours) const {
  const Lanes lane = lanes();
  const auto& rows = editor_.rows().rows;
  const MotionSection& section = editor_.rows().sections[section_];
  for (std::size_t i = section.first_row; i < section.first_row + section.row_count; ++i) {
    const MotionRow& row = rows[i];
    const double x = x_of(row.start_s);
    if (row.kind == PaintKind::kLoop) paint_loop(painter, colours, row);
    if (row.kind == PaintKind::kIf) {
      const int depth = else_depth(editor_.rows(), row);
      const int from = lane.middle_of(depth);
      painter.setPen(QPen(colours.arrow, 1.3));
      if (depth == 0) {
        painter.drawText(QPointF(x + 4, lane.steps - 5), QString::fromStdString(row.text));
        painter.drawLine(QPointF(x, lane.steps - 14), QPointF(x, from));
      }
      const bool has_else = std::ranges::any_of(
          rows, [&](const MotionRow& other) { return other.parent == i && other.in_else; });
      if (has_else && depth < kMostOtherwise) {
        const double to = lane.middle_of(depth + 1);
        painter.drawLine(QPointF(x - 6, from), QPointF(x, from));
        painter.drawLine(QPointF(x - 6, from), QPointF(x - 6, to));
        painter.drawLine(QPointF(x - 6, to), QPointF(x - 2, to));
        paint_head(painter, {x, to}, {1, 0});
      }
    }
    const bool leads = row.kind == PaintKind::kJump || row.kind == PaintKind::kAwait;
    if (!leads || !row.target || rows[*row.target].section != row.section) continue;
    const double to = x_of(rows[*row.target].start_s);
    painter.setPen(QPen(colours.jump, 1.3, Qt::DashLine));
    painter.setBrush(Qt::NoBrush);
    QPainterPath path(QPointF(x, lane.steps));
    const double top = lane.arrows - 4.0;
    if (std::abs(to - x) < 12) {
      path.cubicTo(x - 10, top, to + 14, top, to, lane.steps - 4);
    } else {
      path.cubicTo(x, top, to, top, to, lane.steps - 4);
    }
    painter.drawPath(path);
    painter.setPen(colours.jump);
    paint_head(painter, {to, lane.steps - 3.0}, {0, 1});
  }
}

void Timeline::paint_scrub(QPainter& painter, const Colours&) const {
  if (!scrub_s_) return;
  const double x = x_of(*scrub_s_);
  painter.setPen(QPen(palette().color(QPalette::Highlight), 1.5));
  painter.drawLine(QPointF(x, 0), QPointF(x, viewport()->height()));
}

}  // namespace koboshi::studio
