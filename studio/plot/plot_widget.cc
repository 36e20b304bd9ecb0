#include "studio/plot/plot_widget.h"

#include <QAccessible>
#include <QHelpEvent>
#include <QPainter>
#include <QToolTip>
#include <algorithm>
#include <cmath>

namespace koboshi::studio {
namespace {

constexpr double kBottomMargin = 5.0;
constexpr double kMinValueRange = 1e-6;  // less is noise
constexpr double kValueMargin = 0.05;    // of the range, above and below
constexpr double kValueTick_px = 22.0;
constexpr double kNameTick_px = 14.0;
constexpr double kTimeTick_px = 90.0;

QFont small_font(const QWidget& widget) {
  QFont font = widget.font();
  font.setPointSizeF(std::max(7.0, 0.9 * font.pointSizeF()));
  return font;
}

double time_label_height(const QWidget& widget) { return QFontMetricsF(small_font(widget)).height() + 4.0; }

}  // namespace

PlotWidget::PlotWidget(TimeView& view, QWidget* parent) : TimeAxisWidget(view, parent) {
  connect(&view, &TimeView::range_changed, this, &PlotWidget::refresh);
  connect(&view, &TimeView::cursor_changed, this, &PlotWidget::update_accessible_text);
}

void PlotWidget::set_traces(std::vector<Trace> traces) {
  traces_ = std::move(traces);
  QStringList names;
  for (const Trace& trace : traces_) names << QString::fromStdString(trace.signal.name);
  setAccessibleName(names.isEmpty() ? tr("Empty plot")
                                    : tr("Plot of %1").arg(names.join(QStringLiteral(", "))));
  lay_out_legend();
  refresh();
}

void PlotWidget::set_bands(std::vector<ValueBand> bands) {
  bands_ = std::move(bands);
  refresh();
}

void PlotWidget::set_marks(const std::vector<Mark>* marks) {
  marks_ = marks;
  refresh();
}

void PlotWidget::set_time_labels(bool shown) {
  if (shown == time_labels_) return;
  time_labels_ = shown;
  refresh();
}

void PlotWidget::refresh() {
  if (have_values(traces_) != legend_.has_values()) lay_out_legend();
  is_stale_ = true;
  update();
}

std::pair<double, double> PlotWidget::limits() const {
  const PlotArea shown = area();
  return {shown.low, shown.high};
}

ShownUnit PlotWidget::unit() const {
  if (traces_.empty()) return {};
  std::size_t nodes = 0;
  Extent all;  // of all samples: the unit does not change with the range
  for (const Trace& trace : traces_) all.add(trace.values->extent(0, trace.values->size(), nodes));
  const double magnitude =
      all.empty() ? 0.0 : static_cast<double>(std::max(std::abs(all.low), std::abs(all.high)));
  return shown_unit(traces_.front().signal.unit, magnitude);
}

PlotArea PlotWidget::area() const {
  PlotArea area;
  const double top = PlotLegend::kTopMargin + legend_.height();
  const double bottom = height() - (time_labels_ ? time_label_height(*this) : kBottomMargin);
  area.rect =
      QRectF(kAxisWidth, top, std::max(1, width() - kAxisWidth - kRightMargin), std::max(1.0, bottom - top));
  area.from_us = view().from_us();
  area.to_us = view().to_us();

  std::size_t nodes = 0;
  Extent extent;
  for (const Trace& trace : traces_) {
    const std::size_t first = trace.times->count_before(area.from_us, 0, nodes);
    const std::size_t last = trace.times->count_before(area.to_us, first, nodes);
    extent.add(
        trace.values->extent(first == 0 ? 0 : first - 1, std::min(last + 1, trace.values->size()), nodes));
  }
  if (extent.empty()) extent = {0.0F, 1.0F};
  area.low = static_cast<double>(extent.low);
  area.high = static_cast<double>(extent.high);
  double margin = kValueMargin * (area.high - area.low);
  if (area.high - area.low < kMinValueRange) margin = area.low == 0.0 ? 1.0 : 0.1 * std::abs(area.low);
  area.low -= margin;
  area.high += margin;
  // Half ticks as limits: a live plot does not change its scale with each sample.
  const ShownUnit shown = unit();
  const double half = 0.5 * step_of(area, shown) / shown.factor;
  area.low = half * std::floor(area.low / half);
  area.high = half * std::ceil(area.high / half);
  return area;
}

double PlotWidget::step_of(const PlotArea& area, const ShownUnit& unit) const {
  const bool has_names = !traces_.empty() && !traces_.front().signal.names.empty();
  const double tick_px = has_names ? kNameTick_px : kValueTick_px;
  const double step = nice_step((area.high - area.low) * unit.factor, area.rect.height() / tick_px);
  return has_names ? std::max(1.0, step) : step;
}

std::optional<std::uint64_t> PlotWidget::neighbour_us(std::uint64_t time_us, bool forward) const {
  if (traces_.empty()) return TimeAxisWidget::neighbour_us(time_us, forward);
  const SampleTimes& times = *traces_.front().times;
  const std::size_t until = times.count_until(time_us);
  if (forward) return until < times.size() ? std::optional(times[until]) : std::nullopt;
  const bool is_at_sample = until > 0 && times[until - 1] == time_us;
  const std::size_t before = is_at_sample ? until - 1 : until;
  return before > 0 ? std::optional(times[before - 1]) : std::nullopt;
}

QString PlotWidget::value_at(const Trace& trace, double time_us, const ShownUnit& unit, int decimals) const {
  const auto time = static_cast<std::uint64_t>(std::max(0.0, time_us));
  const std::size_t count = std::min(trace.times->count_until(time), trace.values->size());
  if (count == 0) return QStringLiteral("–");
  return value_text(trace.signal, (*trace.values)[count - 1], unit, decimals);
}

QString PlotWidget::values_text(double time_us) const {
  const PlotArea shown_area = area();
  const ShownUnit shown = unit();
  const int decimals = decimals_of(step_of(shown_area, shown)) + 2;
  QStringList lines{tr("%1 s").arg(number_text(1e-6 * time_us, 3))};
  for (const Trace& trace : traces_)
    lines << tr("%1: %2").arg(QString::fromStdString(trace.signal.name),
                              value_at(trace, time_us, shown, decimals));
  return lines.join(QLatin1Char('\n'));
}

void PlotWidget::update_accessible_text() {
  if (QAccessible::isActive() && view().cursor_us())
    setAccessibleDescription(values_text(static_cast<double>(*view().cursor_us())));
}

void PlotWidget::lay_out_legend() { legend_ = PlotLegend(traces_, QFontMetricsF(small_font(*this)), size()); }

QString PlotWidget::legend_at(const QPointF& place) const {
  const PlotLegend::Item* const item = legend_.at(place);
  if (item == nullptr || item->trace < 0) return {};
  return QString::fromStdString(traces_[static_cast<std::size_t>(item->trace)].signal.name);
}

void PlotWidget::draw_bands(QPainter& painter, const PlotArea& area, const PlotStyle& style) const {
  QColor colour = style.warning;
  colour.setAlphaF(0.16F);
  for (const ValueBand& band : bands_) {
    const double top = area.y(std::min(band.high, area.high));
    const double bottom = area.y(std::max(band.low, area.low));
    if (top < bottom)
      painter.fillRect(QRectF(area.rect.left(), top, area.rect.width(), bottom - top), colour);
  }
}

void PlotWidget::draw_value_axis(QPainter& painter, const PlotArea& area, const PlotStyle& style) const {
  const ShownUnit shown = unit();
  const double step = step_of(area, shown);
  const int decimals = decimals_of(step);
  const QFontMetricsF metrics(painter.font());
  const double low = area.low * shown.factor;
  const double high = area.high * shown.factor;
  for (double i = std::ceil(low / step - 1e-9); i * step <= high + 1e-9 * step; ++i) {
    const double y = std::round(area.y(i * step / shown.factor));
    painter.setPen(i == 0.0 ? QPen(style.zero, 1.0) : QPen(style.rule, 1.0));
    painter.drawLine(QPointF(area.rect.left(), y), QPointF(area.rect.right(), y));
    if (y < area.rect.top() + 0.3 * metrics.height() || y > area.rect.bottom() - 0.2 * metrics.height())
      continue;
    const auto value = static_cast<float>(i * step / shown.factor);
    QString text = number_text(i * step, decimals);
    if (!traces_.empty() && !traces_.front().signal.names.empty())
      text = metrics.elidedText(value_text(traces_.front().signal, value, {}, 0), Qt::ElideRight,
                                kAxisWidth - 8.0);
    painter.setPen(style.dim);
    painter.drawText(QRectF(0.0, y - 20.0, kAxisWidth - 6.0, 40.0), Qt::AlignRight | Qt::AlignVCenter, text);
  }
  if (shown.text.isEmpty()) return;
  // The unit stands above the labels, beside the legend.
  painter.setPen(style.ink);
  painter.drawText(QRectF(0.0, PlotLegend::kTopMargin, kAxisWidth - 6.0, metrics.height() + 2.0),
                   Qt::AlignRight | Qt::AlignVCenter, QLatin1Char('[') + shown.text + QLatin1Char(']'));
}

void PlotWidget::draw_time_axis(QPainter& painter, const PlotArea& area, const PlotStyle& style) const {
  const double step = nice_step(1e-6 * (area.to_us - area.from_us), area.rect.width() / kTimeTick_px);
  const int decimals = decimals_of(step);
  for (double i = std::ceil(1e-6 * area.from_us / step - 1e-9); 1e6 * i * step <= area.to_us; ++i) {
    const double x = std::round(area.x(1e6 * i * step));
    painter.setPen(QPen(style.rule, 1.0));
    painter.drawLine(QPointF(x, area.rect.top()), QPointF(x, area.rect.bottom()));
    if (!time_labels_) continue;
    painter.setPen(style.dim);
    const QString text = tr("%1 s").arg(number_text(i * step, decimals));
    const double half = 0.5 * QFontMetricsF(painter.font()).horizontalAdvance(text);
    const double centre = std::min(x, width() - half - 3.0);
    painter.drawText(QRectF(centre - half - 1.0, area.rect.bottom() + 2.0, 2.0 * half + 2.0, height()),
                     Qt::AlignHCenter | Qt::AlignTop, text);
  }
}

void PlotWidget::draw_marks(QPainter& painter, const PlotArea& area, const PlotStyle& style) const {
  if (marks_ == nullptr) return;
  painter.setPen(QPen(style.zero, 1.0, Qt::DotLine));
  auto mark = std::ranges::lower_bound(*marks_, area.from_us, {},
                                       [](const Mark& one) { return static_cast<double>(one.time_us); });
  double last_x = -1.0;
  for (; mark != marks_->end() && static_cast<double>(mark->time_us) <= area.to_us; ++mark) {
    const double x = std::round(area.x(static_cast<double>(mark->time_us)));
    if (x == last_x) continue;
    painter.drawLine(QPointF(x, area.rect.top()), QPointF(x, area.rect.bottom()));
    last_x = x;
  }
}

void PlotWidget::draw_all() {
  const PlotStyle style(palette());
  const PlotArea shown = area();
  picture_.fill(style.background);
  {
    QPainter painter(&picture_);
    painter.setFont(small_font(*this));
    draw_bands(painter, shown, style);
    draw_time_axis(painter, shown, style);
    draw_value_axis(painter, shown, style);
    draw_marks(painter, shown, style);
  }
  for (const Trace& trace : traces_) draw_trace(picture_, trace, shown, style.trace(trace.colour));
}

void PlotWidget::draw_legend(QPainter& painter) const {
  const PlotStyle style(palette());
  const ShownUnit shown = unit();
  const int decimals = decimals_of(step_of(area(), shown)) + 1;
  painter.setFont(small_font(*this));
  const QFontMetricsF metrics(painter.font());
  for (const PlotLegend::Item& item : legend_.items()) {
    painter.setPen(style.dim);
    if (item.trace < 0) {
      painter.drawText(item.rect, Qt::AlignLeft | Qt::AlignVCenter, item.text);
      continue;
    }
    const Trace& trace = traces_[static_cast<std::size_t>(item.trace)];
    const QRectF& rect = item.rect;
    QPen pen(style.trace(trace.colour), 2.5, Qt::SolidLine, Qt::FlatCap);
    if (trace.dashed) pen.setDashPattern({1.8, 1.2});
    painter.setPen(pen);
    painter.drawLine(QPointF(rect.left(), rect.center().y()), QPointF(rect.left() + 12.0, rect.center().y()));
    painter.setPen(style.dim);
    const QRectF text = rect.adjusted(PlotLegend::kSwatchWidth, 0.0, 0.0, 0.0);
    painter.drawText(text, Qt::AlignLeft | Qt::AlignVCenter, item.text);
    if (!item.value || !view().cursor_us()) continue;
    painter.setPen(style.ink);
    painter.drawText(text.adjusted(metrics.horizontalAdvance(item.text) + PlotLegend::kInset, 0.0, 0.0, 0.0),
                     Qt::AlignLeft | Qt::AlignVCenter,
                     value_at(trace, static_cast<double>(*view().cursor_us()), shown, decimals));
  }
  if (!legend_.items().empty()) return;
  painter.setPen(style.dim);
  painter.drawText(rect(), Qt::AlignCenter, tr("Drop signals here, or select them in the list"));
}

void PlotWidget::paintEvent(QPaintEvent*) {
  const double scale = devicePixelRatioF();
  const QSize pixels = (QSizeF(size()) * scale).toSize();
  if (is_stale_ || picture_.size() != pixels || picture_.devicePixelRatio() != scale) {
    if (picture_.size() != pixels) picture_ = QImage(pixels, QImage::Format_RGB32);
    picture_.setDevicePixelRatio(scale);
    draw_all();
    is_stale_ = false;
  }
  QPainter painter(this);
  painter.drawImage(0, 0, picture_);
  draw_legend(painter);
  const double top = PlotLegend::kTopMargin + legend_.height();
  const double bottom = height() - (time_labels_ ? time_label_height(*this) : kBottomMargin);
  draw_selection(painter, top, bottom);
  draw_cursor(painter, top, bottom);
}

void PlotWidget::resizeEvent(QResizeEvent* event) {
  TimeAxisWidget::resizeEvent(event);
  lay_out_legend();
  refresh();
}

void PlotWidget::changeEvent(QEvent* event) {
  TimeAxisWidget::changeEvent(event);
  if (event->type() == QEvent::FontChange) lay_out_legend();
  if (event->type() == QEvent::PaletteChange || event->type() == QEvent::FontChange) refresh();
}

bool PlotWidget::event(QEvent* event) {
  if (event->type() != QEvent::ToolTip) return TimeAxisWidget::event(event);
  const auto* help = static_cast<QHelpEvent*>(event);
  const PlotLegend::Item* const item = legend_.at(help->pos());
  if (item != nullptr && item->trace >= 0) {
    QToolTip::showText(help->globalPos(), legend_at(help->pos()), this);
  } else if (item != nullptr) {  // those that have no room
    QToolTip::showText(help->globalPos(), values_text(static_cast<double>(view().cursor_us().value_or(0))),
                       this);
  } else if (!traces_.empty() && help->pos().x() >= kAxisWidth) {
    QToolTip::showText(help->globalPos(), values_text(time_at(help->pos().x())), this);
  } else {
    QToolTip::hideText();
  }
  return true;
}

}  // namespace koboshi::studio
