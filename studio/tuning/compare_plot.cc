#include "studio/tuning/compare_plot.h"

#include <QComboBox>
#include <QVBoxLayout>
#include <algorithm>
#include <utility>

#include "studio/plot/plot_widget.h"
#include "studio/plot/time_view.h"

namespace koboshi::studio {
namespace {

struct TrunkSignal {
  const char* name;
  const char* unit;
  TrunkQuantity quantity;
};
constexpr TrunkSignal kTrunkSignals[]{
    {QT_TRANSLATE_NOOP("koboshi::studio::ComparePlot", "Speed, mean of a second"), "m/s",
     TrunkQuantity::kSpeed},
    {QT_TRANSLATE_NOOP("koboshi::studio::ComparePlot", "Distance forward"), "m", TrunkQuantity::kDistance},
    {QT_TRANSLATE_NOOP("koboshi::studio::ComparePlot", "Drift to the left"), "m", TrunkQuantity::kDrift},
    {QT_TRANSLATE_NOOP("koboshi::studio::ComparePlot", "Lean of the trunk"), "rad", TrunkQuantity::kLean}};

}  // namespace

ComparePlot::ComparePlot(QWidget* parent)
    : QWidget(parent),
      quantity_(new QComboBox),
      time_(new TimeView(this)),
      plot_(new PlotWidget(*time_, this)) {
  quantity_->setToolTip(tr("Quantity that is plotted"));
  quantity_->setAccessibleName(tr("Plotted quantity"));
  connect(quantity_, qOverload<int>(&QComboBox::activated), this, &ComparePlot::choose);
  time_->set_follow(true);
  plot_->set_marks(&samples_.marks());
  connect(time_, &TimeView::cursor_moved, this, &ComparePlot::cursor_moved);
  auto* column = new QVBoxLayout(this);
  column->setContentsMargins(0, 0, 0, 0);
  column->addWidget(quantity_);
  column->addWidget(plot_, 1);
}

void ComparePlot::set_comparison(const Comparison& comparison) {
  comparison_ = &comparison;
  const QString chosen = quantity_->currentText();
  quantity_->clear();
  for (const TrunkSignal& signal : kTrunkSignals) quantity_->addItem(tr(signal.name));
  for (const view::Signal& signal : comparison_->recording(0).signals)
    quantity_->addItem(QString::fromStdString(signal.name));
  quantity_->setCurrentIndex(std::max(0, quantity_->findText(chosen)));
  time_->forget_cursor();
  time_->set_follow(true);
  choose();
}

void ComparePlot::grow() {
  append_samples();
  const std::size_t common = comparison_->common_samples();
  if (common == 0) return;
  time_->set_extent(0.0, static_cast<double>(comparison_->recording(0).samples[common - 1].time_us));
  plot_->refresh();
}

bool ComparePlot::follows() const { return time_->follows() || !time_->cursor_us(); }

void ComparePlot::set_cursor(std::uint64_t time_us) { time_->set_cursor(time_us); }

double ComparePlot::quantity(std::size_t run, std::size_t sample) const {
  const auto index = static_cast<std::size_t>(quantity_->currentIndex());
  const view::Recording& recording = comparison_->recording(run);
  if (index < std::size(kTrunkSignals))
    return trunk_quantity(recording, sample, kTrunkSignals[index].quantity);
  return static_cast<double>(recording.samples[sample].values[index - std::size(kTrunkSignals)]);
}

void ComparePlot::choose() {
  if (!comparison_ || quantity_->currentIndex() < 0) return;
  const auto index = static_cast<std::size_t>(quantity_->currentIndex());
  const std::string unit = index < std::size(kTrunkSignals)
                               ? kTrunkSignals[index].unit
                               : comparison_->recording(0).signals[index - std::size(kTrunkSignals)].unit;
  const view::Signal signals[]{{"A", unit, {}}, {"B", unit, {}}, {"B − A", unit, {}}};
  samples_.set_signals(signals);
  sampled_ = 0;
  append_samples();
  std::vector<Trace> traces;
  for (std::size_t i = 0; i < std::size(signals); ++i)
    traces.push_back({.signal = signals[i],
                      .times = samples_.times(),
                      .values = samples_.values(i),
                      .colour = static_cast<int>(i),
                      .dashed = i == 2});
  plot_->set_traces(std::move(traces));
  plot_->refresh();
}

void ComparePlot::append_samples() {
  for (const std::size_t common = comparison_->common_samples(); sampled_ < common; ++sampled_) {
    const auto a = static_cast<float>(quantity(0, sampled_));
    const auto b = static_cast<float>(quantity(1, sampled_));
    const float values[]{a, b, b - a};
    samples_.append(comparison_->recording(0).samples[sampled_].time_us, values);
  }
}

}  // namespace koboshi::studio
