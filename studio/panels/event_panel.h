#pragma once

#include <QTableView>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "view/recording/recording.h"

class QStandardItemModel;

namespace koboshi::studio {

// The events of a run in a table: time and sentence.
class EventPanel final : public QTableView {
  Q_OBJECT

 public:
  explicit EventPanel(QWidget* parent = nullptr);

  // Begins a run without events.
  void forget();
  // Shows the events of the run so far, in order of time.
  void show_events(std::span<const view::Event> events);

 Q_SIGNALS:
  void added(std::uint64_t time_us, const QString& text);
  // The user has chosen an event.
  void cursor_moved(std::uint64_t time_us);

 private:
  bool begins_as_shown(std::span<const view::Event> events) const;

  QStandardItemModel* const model_;
  std::vector<std::uint64_t> times_us_;  // by row
};

}  // namespace koboshi::studio
