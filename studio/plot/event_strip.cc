#include "studio/plot/event_strip.h"

#include <QHelpEvent>
#include <QPainter>
#include <QToolTip>
#include <algorithm>
#include <cmath>

#include "studio/plot/plot_style.h"

namespace koboshi::studio {
namespace {

constexpr double kTop = 2.0;
constexpr double kEventReach_px = 5.0;
constexpr double kMinText_px = 40.0;  // room for less than a whole text

}  // namespace

EventStrip::EventStrip(TimeView& view, const RunSamples& samples, QWidget* parent)
    : TimeAxisWidget(view, parent), samples_(samples) {
  setAccessibleName(tr("States and events"));
  setSizePolicy(QSizePolicy::Expanding, QSizePolicy::Fixed);
  connect(&view, &TimeView::range_changed, this, qOverload<>(&QWidget::update));
}

double EventStrip::state_height() const { return QFontMetricsF(font()).height() + 2.0; }

QSize EventStrip::sizeHint() const {
  return {240, static_cast<int>(std::ceil(kTop + 2.0 * state_height() + 4.0))};
}

std::optional<std::uint64_t> EventStrip::neighbour_us(std::uint64_t time_us, bool forward) const {
  const std::vector<Mark>& marks = samples_.marks();
  const auto bound = forward ? std::ranges::upper_bound(marks, time_us, {}, &Mark::time_us)
                             : std::ranges::lower_bound(marks, time_us, {}, &Mark::time_us);
  if (bound == (forward ? marks.end() : marks.begin())) return std::nullopt;
  return forward ? bound->time_us : std::prev(bound)->time_us;
}

void EventStrip::draw_states(QPainter& painter) const {
  const std::vector<StateSpan>& states = samples_.states();
  for (std::size_t i = 0; i < states.size(); ++i) {
    const double end_us =
        i + 1 < states.size() ? static_cast<double>(states[i + 1].start_us) : view().end_us();
    const double left = std::max<double>(kAxisWidth, x_of(static_cast<double>(states[i].start_us)));
    const double right = std::min<double>(width() - kRightMargin, x_of(end_us));
    if (right <= left) continue;
    const QString name = samples_.state_name(states[i].state);
    const QColor colour = state_colour(name, static_cast<int>(states[i].state));
    const QRectF rect(left, kTop, right - left, state_height());
    painter.fillRect(rect, colour);
    painter.setPen(ink_on(colour));
    const QRectF inner = rect.adjusted(4.0, 0.0, -2.0, 0.0);
    const double whole = QFontMetricsF(painter.font()).horizontalAdvance(name);
    if (inner.width() < std::min(whole, kMinText_px)) continue;
    painter.drawText(
        inner, Qt::AlignLeft | Qt::AlignVCenter,
        painter.fontMetrics().elidedText(name, Qt::ElideRight, static_cast<int>(std::ceil(inner.width()))));
  }
}

void EventStrip::draw_events(QPainter& painter) const {
  const PlotStyle style(palette());
  const std::vector<Mark>& marks = samples_.marks();
  const double top = kTop + state_height() + 2.0;
  for (auto mark = marks.begin(); mark != marks.end(); ++mark) {
    const double x = std::round(x_of(static_cast<double>(mark->time_us)));
    if (x < kAxisWidth || x > width() - kRightMargin) continue;
    painter.setPen(QPen(style.ink, 1.0));
    painter.drawLine(QPointF(x, top), QPointF(x, height()));
    const double next =
        std::next(mark) == marks.end() ? width() : x_of(static_cast<double>(std::next(mark)->time_us));
    const double right = std::min<double>(next - 3.0, width() - kRightMargin);
    const QRectF text(x + 4.0, top, right - x - 4.0, state_height());
    const double whole = QFontMetricsF(painter.font()).horizontalAdvance(mark->text);
    if (text.width() < std::min(whole, kMinText_px)) continue;
    painter.setPen(style.dim);
    painter.drawText(text, Qt::AlignLeft | Qt::AlignVCenter,
                     painter.fontMetrics().elidedText(mark->text, Qt::ElideRight,
                                                      static_cast<int>(std::ceil(text.width()))));
  }
}

void EventStrip::paintEvent(QPaintEvent*) {
  QPainter painter(this);
  const PlotStyle style(palette());
  painter.fillRect(rect(), style.background);
  painter.setPen(style.dim);
  const QRectF label(0.0, kTop, kAxisWidth - 6.0, state_height());
  const auto fitting = [&](const QString& text) {
    return painter.fontMetrics().elidedText(text, Qt::ElideRight, static_cast<int>(label.width()));
  };
  painter.drawText(label, Qt::AlignRight | Qt::AlignVCenter, fitting(tr("State")));
  painter.drawText(label.translated(0.0, state_height() + 2.0), Qt::AlignRight | Qt::AlignVCenter,
                   fitting(tr("Events")));
  draw_states(painter);
  draw_events(painter);
  draw_selection(painter, 0.0, height());
  draw_cursor(painter, 0.0, height());
}

QString EventStrip::text_at(const QPointF& place) const {
  const double time_us = time_at(place.x());
  QStringList lines;
  if (place.y() <= kTop + state_height() && time_us <= view().end_us()) {
    const std::vector<StateSpan>& states = samples_.states();
    const auto after = std::ranges::upper_bound(
        states, time_us, {}, [](const StateSpan& span) { return static_cast<double>(span.start_us); });
    if (after != states.begin()) lines << samples_.state_name(std::prev(after)->state);
  }
  const double reach_us = time_at(place.x() + kEventReach_px) - time_us;
  for (const Mark& mark : samples_.marks())
    if (std::abs(static_cast<double>(mark.time_us) - time_us) <= reach_us)
      lines << tr("%1 s: %2").arg(number_text(1e-6 * static_cast<double>(mark.time_us), 3), mark.text);
  return lines.join(QLatin1Char('\n'));
}

bool EventStrip::event(QEvent* event) {
  if (event->type() != QEvent::ToolTip) return TimeAxisWidget::event(event);
  const auto* help = static_cast<QHelpEvent*>(event);
  QToolTip::showText(help->globalPos(), text_at(help->pos()), this);
  return true;
}

}  // namespace koboshi::studio
