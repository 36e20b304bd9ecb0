#pragma once

#include <QHBoxLayout>
#include <QLabel>
#include <QScrollArea>
#include <QSplitter>
#include <QString>
#include <QToolButton>
#include <QVariant>
#include <QWidget>
#include <cstdint>
#include <span>
#include <vector>

#include "studio/plot/event_strip.h"
#include "studio/plot/plot_row.h"
#include "studio/plot/plot_rows.h"
#include "studio/plot/run_samples.h"
#include "studio/plot/signal_list.h"
#include "studio/plot/time_view.h"

namespace koboshi::studio {

// Rows of plots of a run that is recorded or grows, over a common time axis, with the run's states and
// events, and the list of its signals. Times are simulated microseconds. To be used in the thread of the
// window only.
//
// All samples of all signals are kept: 4.7 bytes per value and 8 bytes per sample, so 420 MB for an hour of
// 250 signals at 100 Hz. Samples may come at any rate: the panel repaints at most once per turn of the event
// loop.
class PlotPanel final : public QWidget {
  Q_OBJECT

 public:
  explicit PlotPanel(QWidget* parent = nullptr);

  // Begins a run with these signals: forgets all samples and events. Rows with signals of the same names
  // stay.
  void set_signals(std::span<const view::Signal> signals);
  // Appends a sample: one value per signal, later than the last sample. NaN: no value.
  void append(std::uint64_t time_us, std::span<const float> values);
  // An event that is there already is not added again.
  void add_event(std::uint64_t time_us, const QString& text);
  // Forgets every sample and event later than this: a rewind.
  void truncate_after(std::uint64_t time_us);
  // Places the cursor. Emits nothing.
  void set_cursor(std::uint64_t time_us);
  // In follow mode the newest sample is at the right. Off: the range stays where it is, or shows everything.
  void set_follow(bool follow);
  bool follows() const { return view_->follows(); }

  // Returns the rows and their signals, for QSettings.
  QVariant layout_state() const;
  // Returns false and changes nothing if the state holds no rows.
  bool restore_layout(const QVariant& state);

  const PlotRows& rows() const { return rows_; }
  // Adds signals to a row, or below it as new rows where their unit differs.
  void add_to_row(std::size_t row, const QStringList& names);
  // Adds each signal to the last row of its unit with room, or as a new row.
  void add(const QStringList& names);
  void remove(std::size_t row, const QString& name);
  void remove_row(std::size_t row);

  PlotWidget& plot(std::size_t row) { return row_widgets_[row]->plot(); }
  TimeView& time_view() { return *view_; }
  const RunSamples& samples() const { return samples_; }

 Q_SIGNALS:
  // By the user.
  void cursor_moved(std::uint64_t time_us);
  void follow_changed(bool follow);
  void layout_changed();

 private:
  void make_toolbar(QHBoxLayout& layout);
  void schedule_refresh();
  void refresh();
  void show_range();
  PlotRow* make_row();
  // One widget per row, with the row's traces; hidden where the run has none of its signals.
  void update_rows();
  void insert_row(std::size_t row, const QString& name);
  void erase_row(std::size_t row);
  std::size_t index_of(const PlotRow* widget) const;
  void users_rows_changed();
  void place_signal(std::size_t row, const QString& name);
  std::string unit_of(const QStringList& names) const;

  RunSamples samples_{};
  PlotRows rows_{};
  bool has_users_rows_ = false;  // they were chosen or restored, not made by default
  bool is_refresh_scheduled_ = false;

  TimeView* view_;
  SignalList* list_;
  EventStrip* strip_;
  QSplitter* row_box_;
  QToolButton* follow_;
  QLabel* range_;
  std::vector<PlotRow*> row_widgets_{};  // by row; children of row_box_
};

}  // namespace koboshi::studio
