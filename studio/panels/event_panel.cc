#include "studio/panels/event_panel.h"

#include <QStandardItemModel>

#include "studio/widgets/table_style.h"

namespace koboshi::studio {

EventPanel::EventPanel(QWidget* parent) : QTableView(parent), model_(new QStandardItemModel(0, 2, this)) {
  model_->setHorizontalHeaderLabels({tr("Time [s]"), tr("Event")});
  setModel(model_);
  style_table(*this, tr("Events"));
  setAlternatingRowColors(false);
  setEditTriggers(QAbstractItemView::NoEditTriggers);
  connect(this, &QTableView::clicked, this, [this](const QModelIndex& index) {
    Q_EMIT cursor_moved(times_us_[static_cast<std::size_t>(index.row())]);
  });
}

void EventPanel::forget() {
  model_->setRowCount(0);
  times_us_.clear();
}

// The text of an event can change for a second.
bool EventPanel::begins_as_shown(std::span<const view::Event> events) const {
  if (times_us_.size() > events.size()) return false;
  for (std::size_t row = 0; row < times_us_.size(); ++row)
    if (times_us_[row] != events[row].time_us ||
        model_->item(static_cast<int>(row), 1)->text() != QString::fromStdString(events[row].text))
      return false;
  return true;
}

void EventPanel::show_events(std::span<const view::Event> events) {
  if (!begins_as_shown(events)) forget();
  if (times_us_.size() == events.size()) return;
  for (const view::Event& event : events.subspan(times_us_.size())) {
    auto* time = new QStandardItem(QString::number(1e-6 * static_cast<double>(event.time_us), 'f', 3));
    time->setTextAlignment(Qt::AlignRight | Qt::AlignVCenter);
    auto* text = new QStandardItem(QString::fromStdString(event.text));
    text->setToolTip(text->text());
    model_->appendRow({time, text});
    times_us_.push_back(event.time_us);
    Q_EMIT added(event.time_us, text->text());
  }
  scrollToBottom();
}

}  // namespace koboshi::studio
