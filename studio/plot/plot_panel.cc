#include "studio/plot/plot_panel.h"

#include <QTimer>
#include <QVBoxLayout>
#include <algorithm>
#include <limits>

namespace koboshi::studio {
namespace {

constexpr qsizetype kMaxTracesChosen = 6;  // of a row; more can be dragged into it

}  // namespace

PlotPanel::PlotPanel(QWidget* parent)
    : QWidget(parent),
      view_(new TimeView(this)),
      list_(new SignalList(this)),
      strip_(new EventStrip(*view_, samples_, this)),
      row_box_(new QSplitter(Qt::Vertical, this)),
      follow_(new QToolButton(this)),
      range_(new QLabel(this)) {
  auto* toolbar = new QHBoxLayout;
  make_toolbar(*toolbar);

  auto* scroll = new QScrollArea(this);
  scroll->setWidget(row_box_);
  scroll->setWidgetResizable(true);
  scroll->setFrameShape(QFrame::NoFrame);
  scroll->setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
  scroll->setFocusPolicy(Qt::NoFocus);
  row_box_->setChildrenCollapsible(false);
  row_box_->setHandleWidth(3);

  auto* plots = new QWidget(this);
  auto* plots_layout = new QVBoxLayout(plots);
  plots_layout->setContentsMargins(0, 0, 0, 0);
  plots_layout->setSpacing(0);
  plots_layout->addWidget(strip_);
  plots_layout->addWidget(scroll, 1);

  auto* sides = new QSplitter(Qt::Horizontal, this);
  sides->addWidget(list_);
  sides->addWidget(plots);
  sides->setStretchFactor(1, 1);
  sides->setSizes({200, 700});

  auto* layout = new QVBoxLayout(this);
  layout->setContentsMargins(0, 0, 0, 0);
  layout->setSpacing(2);
  layout->addLayout(toolbar);
  layout->addWidget(sides, 1);

  connect(view_, &TimeView::cursor_moved, this, &PlotPanel::cursor_moved);
  connect(view_, &TimeView::follow_changed, this, &PlotPanel::follow_changed);
  connect(view_, &TimeView::follow_changed, follow_, &QToolButton::setChecked);
  connect(view_, &TimeView::range_changed, this, &PlotPanel::show_range);
  connect(list_, &SignalList::chosen, this, &PlotPanel::add);
  show_range();
}

void PlotPanel::make_toolbar(QHBoxLayout& layout) {
  const auto add_button = [&](QToolButton* button, const QString& text, const QString& tip) {
    button->setText(text);
    button->setToolTip(tip);
    layout.addWidget(button);
    return button;
  };
  layout.setContentsMargins(4, 2, 4, 0);
  QToolButton* signal_list =
      add_button(new QToolButton(this), tr("Signals"), tr("Show or hide the list of signals"));
  signal_list->setCheckable(true);
  list_->hide();  // plots first: the panel is narrow at the side of a window
  connect(signal_list, &QToolButton::toggled, list_, &QWidget::setVisible);
  add_button(follow_, tr("Follow"), tr("Keep the newest sample at the right"));
  follow_->setCheckable(true);
  connect(follow_, &QToolButton::toggled, this, &PlotPanel::set_follow);
  QToolButton* all =
      add_button(new QToolButton(this), tr("Whole run"), tr("Show the whole run (double click, 0)"));
  connect(all, &QToolButton::clicked, view_, &TimeView::show_all);
  layout.addStretch(1);
  layout.addWidget(range_);
}

void PlotPanel::set_signals(std::span<const view::Signal> signals) {
  samples_.set_signals(signals);
  view_->set_extent(0.0, 0.0);
  view_->forget_cursor();
  list_->set_signals(samples_.signals());
  const bool has_known = std::ranges::any_of(rows_, [this](const QStringList& row) {
    return std::ranges::any_of(row, [this](const QString& name) { return samples_.has(name); });
  });
  if (!has_users_rows_ || (!has_known && !rows_.empty())) {
    rows_ = default_rows(samples_);
    has_users_rows_ = false;
  }
  update_rows();
}

void PlotPanel::append(std::uint64_t time_us, std::span<const float> values) {
  samples_.append(time_us, values);
  schedule_refresh();
}

void PlotPanel::add_event(std::uint64_t time_us, const QString& text) {
  samples_.add_event(time_us, text);
  schedule_refresh();
}

void PlotPanel::truncate_after(std::uint64_t time_us) {
  samples_.truncate_after(time_us);
  schedule_refresh();
}

void PlotPanel::set_cursor(std::uint64_t time_us) {
  if (is_refresh_scheduled_) refresh();  // the range follows before the cursor could turn its page
  view_->set_cursor(time_us);
}

void PlotPanel::set_follow(bool follow) {
  if (is_refresh_scheduled_) refresh();
  view_->set_follow(follow);
}

void PlotPanel::schedule_refresh() {
  if (is_refresh_scheduled_) return;
  is_refresh_scheduled_ = true;
  QTimer::singleShot(0, this, [this] {
    if (is_refresh_scheduled_) refresh();
  });
}

void PlotPanel::refresh() {
  is_refresh_scheduled_ = false;
  const SampleTimes& times = *samples_.times();
  if (times.empty()) {
    view_->set_extent(0.0, 0.0);
  } else {
    view_->set_extent(static_cast<double>(times[0]), static_cast<double>(times[times.size() - 1]));
  }
  strip_->update();
  for (PlotRow* row : row_widgets_) row->plot().refresh();
}

void PlotPanel::show_range() {
  range_->setText(
      tr("%1 – %2 s").arg(number_text(1e-6 * view_->from_us(), 2), number_text(1e-6 * view_->to_us(), 2)));
}

QVariant PlotPanel::layout_state() const { return rows_to_variant(rows_); }

bool PlotPanel::restore_layout(const QVariant& state) {
  PlotRows rows = rows_of_variant(state);
  if (rows.empty()) return false;
  rows_ = std::move(rows);
  has_users_rows_ = true;
  update_rows();
  return true;
}

PlotRow* PlotPanel::make_row() {
  auto* row = new PlotRow(*view_, row_box_);
  row->plot().set_marks(&samples_.marks());
  connect(row, &PlotRow::dropped, this,
          [this, row](const QStringList& names) { add_to_row(index_of(row), names); });
  connect(row, &PlotRow::remove_requested, this,
          [this, row](const QString& name) { remove(index_of(row), name); });
  connect(row, &PlotRow::close_requested, this, [this, row] { remove_row(index_of(row)); });
  return row;
}

std::size_t PlotPanel::index_of(const PlotRow* widget) const {
  return static_cast<std::size_t>(std::ranges::find(row_widgets_, widget) - row_widgets_.begin());
}

void PlotPanel::update_rows() {
  while (row_widgets_.size() > rows_.size()) {
    PlotRow* row = row_widgets_.back();
    row_widgets_.pop_back();
    row->hide();
    row->setParent(nullptr);
    row->deleteLater();
  }
  while (row_widgets_.size() < rows_.size()) {
    row_widgets_.push_back(make_row());
    row_box_->addWidget(row_widgets_.back());
  }
  PlotRow* last = nullptr;
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    std::vector<Trace> traces = traces_of(samples_, rows_[i]);
    PlotRow& row = *row_widgets_[i];
    row.setVisible(!traces.empty());
    if (!traces.empty()) last = &row;
    // The stability margin: below zero the ZMP is outside of the support polygon.
    std::vector<ValueBand> bands;
    if (traces.size() == 1 && traces.front().signal.name == "true_zmp_margin")
      bands.push_back({.low = -std::numeric_limits<double>::infinity(), .high = 0.0});
    row.plot().set_bands(std::move(bands));
    row.plot().set_traces(std::move(traces));
  }
  for (PlotRow* row : row_widgets_) row->plot().set_time_labels(row == last);
}

void PlotPanel::insert_row(std::size_t row, const QString& name) {
  const auto at = static_cast<std::ptrdiff_t>(row);
  rows_.insert(rows_.begin() + at, QStringList{name});
  row_widgets_.insert(row_widgets_.begin() + at, make_row());
  row_box_->insertWidget(static_cast<int>(row), row_widgets_[row]);
}

// The widget may be the one whose signal is being handled.
void PlotPanel::erase_row(std::size_t row) {
  const auto at = static_cast<std::ptrdiff_t>(row);
  row_widgets_[row]->hide();
  row_widgets_[row]->setParent(nullptr);
  row_widgets_[row]->deleteLater();
  row_widgets_.erase(row_widgets_.begin() + at);
  rows_.erase(rows_.begin() + at);
}

void PlotPanel::users_rows_changed() {
  has_users_rows_ = true;
  update_rows();
  Q_EMIT layout_changed();
}

std::string PlotPanel::unit_of(const QStringList& names) const {
  for (const QString& name : names)
    if (const auto index = samples_.index_of(name.toStdString())) {
      const view::Signal& signal = samples_.signals()[*index];
      // The names of values make an axis of their own.
      return signal.names.empty() ? signal.unit : "names of " + signal.name;
    }
  return {};
}

void PlotPanel::place_signal(std::size_t row, const QString& name) {
  if (rows_[row].contains(name)) return;
  if (unit_of(rows_[row]) == unit_of({name})) {
    rows_[row] << name;
  } else {
    insert_row(row + 1, name);
  }
}

void PlotPanel::add_to_row(std::size_t row, const QStringList& names) {
  for (const QString& name : names)
    if (samples_.has(name)) place_signal(row, name);
  users_rows_changed();
}

void PlotPanel::add(const QStringList& names) {
  for (const QString& name : names) {
    if (!samples_.has(name)) continue;
    if (std::ranges::any_of(rows_, [&](const QStringList& row) { return row.contains(name); })) continue;
    const auto room = std::ranges::find_if(rows_.rbegin(), rows_.rend(), [&](const QStringList& row) {
      return row.size() < kMaxTracesChosen && unit_of(row) == unit_of({name});
    });
    if (room != rows_.rend()) {
      *room << name;
    } else {
      insert_row(rows_.size(), name);
    }
  }
  users_rows_changed();
}

void PlotPanel::remove(std::size_t row, const QString& name) {
  rows_[row].removeAll(name);
  if (rows_[row].isEmpty()) erase_row(row);
  users_rows_changed();
}

void PlotPanel::remove_row(std::size_t row) {
  erase_row(row);
  users_rows_changed();
}

}  // namespace koboshi::studio
