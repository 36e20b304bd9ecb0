#include "studio/plot/plot_legend.h"

#include <algorithm>
#include <cmath>

#include "studio/plot/time_axis_widget.h"

namespace koboshi::studio {
namespace {

constexpr double kGap = 14.0;               // between items
constexpr double kCloseButtonWidth = 22.0;  // of the row around the plot
constexpr double kMaxShare = 0.4;           // of the plot's height
constexpr double kAxisWidth = TimeAxisWidget::kAxisWidth;

double line_height(const QFontMetricsF& metrics) { return metrics.height() + 2.0; }

// Returns the part of a name that differs from the name before: "true" for "left_knee_true" after
// "left_knee_target".
QString short_name(const QString& name, const QString& before) {
  QStringList own = name.split(QLatin1Char('_'));
  QStringList other = before.split(QLatin1Char('_'));
  while (own.size() > 1 && !other.isEmpty() && own.front() == other.front()) {
    own.removeFirst();
    other.removeFirst();
  }
  while (own.size() > 1 && !other.isEmpty() && own.back() == other.back()) {
    own.removeLast();
    other.removeLast();
  }
  return own.join(QLatin1Char('_'));
}

}  // namespace

std::vector<bool> have_values(const std::vector<Trace>& traces) {
  std::vector<bool> have;
  std::size_t nodes = 0;
  for (const Trace& trace : traces)
    have.push_back(!trace.values->extent(0, trace.values->size(), nodes).empty());
  return have;
}

PlotLegend::PlotLegend(const std::vector<Trace>& traces, const QFontMetricsF& metrics, const QSizeF& plot)
    : has_values_(have_values(traces)) {
  const double right = plot.width() - TimeAxisWidget::kRightMargin - kCloseButtonWidth;
  const int most_lines = std::max(1, static_cast<int>(kMaxShare * plot.height() / line_height(metrics)));
  int lines = 0;
  for (const Detail detail : {Detail::kFull, Detail::kShortNames, Detail::kNamesOnly}) {
    lines = place(traces, metrics, right, detail);
    if (lines <= most_lines) break;
  }
  if (lines > most_lines) fold(metrics, right, most_lines);
  height_ = std::min(lines, most_lines) * line_height(metrics) + 2.0;
}

int PlotLegend::place(const std::vector<Trace>& traces, const QFontMetricsF& metrics, double right,
                      Detail detail) {
  items_.clear();
  // If there are no values at all, the legend names what the plot waits for.
  const bool waits = std::ranges::find(has_values_, true) == has_values_.end();
  const bool with_values = detail != Detail::kNamesOnly;
  const double value_width = with_values ? metrics.horizontalAdvance(QStringLiteral("−000.000 mm")) : 0.0;
  double x = kAxisWidth;
  double y = kTopMargin;
  for (std::size_t i = 0; i < traces.size(); ++i) {
    if (!waits && !has_values_[i]) continue;
    QString name = QString::fromStdString(traces[i].signal.name);
    if (detail != Detail::kFull && i > 0 && traces[i - 1].colour == traces[i].colour)
      name = short_name(name, QString::fromStdString(traces[i - 1].signal.name));
    const double max_name = std::max(20.0, right - kAxisWidth - kSwatchWidth - value_width - kInset);
    name = metrics.elidedText(name, Qt::ElideMiddle, max_name);
    double reserved = value_width;
    for (const auto& [value, text] : traces[i].signal.names)
      if (with_values) reserved = std::max(reserved, metrics.horizontalAdvance(QString::fromStdString(text)));
    if (with_values) reserved += kInset;
    const double item_width = kSwatchWidth + metrics.horizontalAdvance(name) + reserved;
    if (x > kAxisWidth && x + item_width > right) {
      x = kAxisWidth;
      y += line_height(metrics);
    }
    items_.push_back(
        {QRectF(x, y, item_width, line_height(metrics)), name, static_cast<int>(i), with_values});
    x += item_width + kGap;
  }
  return items_.empty() ? 1 : static_cast<int>(std::lround((y - kTopMargin) / line_height(metrics))) + 1;
}

// Leaves the first lines, and ends the last one with the number of the names that have no room.
void PlotLegend::fold(const QFontMetricsF& metrics, double right, int lines) {
  const double bottom = kTopMargin + lines * line_height(metrics);
  const auto text = [](int count) { return QStringLiteral("+%1").arg(count); };
  int hidden = 0;
  const auto has_room = [&] {
    if (items_.empty()) return true;
    const QRectF& last = items_.back().rect;
    if (last.bottom() > bottom + 0.5) return false;
    return last.right() + kGap + metrics.horizontalAdvance(text(hidden)) <= right || items_.size() == 1;
  };
  while (!has_room()) {
    items_.pop_back();
    ++hidden;
  }
  const double x = items_.empty() ? kAxisWidth : items_.back().rect.right() + kGap;
  const double y = items_.empty() ? kTopMargin : items_.back().rect.top();
  items_.push_back(
      {QRectF(x, y, metrics.horizontalAdvance(text(hidden)), line_height(metrics)), text(hidden)});
}

QStringList PlotLegend::texts() const {
  QStringList texts;
  for (const Item& item : items_) texts << item.text;
  return texts;
}

const PlotLegend::Item* PlotLegend::at(const QPointF& place) const {
  const auto found =
      std::ranges::find_if(items_, [&](const Item& item) { return item.rect.contains(place); });
  return found == items_.end() ? nullptr : &*found;
}

}  // namespace koboshi::studio
