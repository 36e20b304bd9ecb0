#pragma once

#include <QFontMetricsF>
#include <QPointF>
#include <QRectF>
#include <QSizeF>
#include <QString>
#include <QStringList>
#include <vector>

#include "studio/plot/trace_painter.h"

namespace koboshi::studio {

// Returns which of the traces have a value.
std::vector<bool> have_values(const std::vector<Trace>& traces);

// The names of a plot's traces in lines above its curves, each with room for its value at the cursor, so that
// nothing moves when values change. The legend leaves at least 60 % of the height to the curves: where it
// would need more, it shortens the second name of a pair such as target and true, then drops the values, and
// at last folds names into "+3". Traces without any value are not in it, unless there are none with values.
// Lengths and places are in pixels of the plot.
class PlotLegend {
 public:
  static constexpr double kTopMargin = 4.0;
  static constexpr double kSwatchWidth = 16.0;  // in front of each name
  static constexpr double kInset = 6.0;         // between name and value

  struct Item {
    QRectF rect{};
    QString text{};      // a name, shortened or elided; "+3" for three that have no room
    int trace = -1;      // none: those that have no room
    bool value = false;  // whether the value at the cursor stands behind it
  };

  PlotLegend() = default;
  PlotLegend(const std::vector<Trace>& traces, const QFontMetricsF& metrics, const QSizeF& plot);

  const std::vector<Item>& items() const { return items_; }
  const std::vector<bool>& has_values() const { return has_values_; }  // by trace
  double height() const { return height_; }
  QStringList texts() const;
  // The item at a place; null if there is none.
  const Item* at(const QPointF& place) const;

 private:
  enum class Detail { kFull, kShortNames, kNamesOnly };

  // Returns the number of lines.
  int place(const std::vector<Trace>& traces, const QFontMetricsF& metrics, double right, Detail detail);
  void fold(const QFontMetricsF& metrics, double right, int lines);

  std::vector<bool> has_values_;
  std::vector<Item> items_;
  double height_ = 0.0;
};

}  // namespace koboshi::studio
