#include <QDropEvent>
#include <QFile>
#include <QLineEdit>
#include <QMimeData>
#include <QRegularExpression>
#include <QSignalSpy>
#include <QTest>
#include <QTreeView>
#include <QWheelEvent>
#include <algorithm>
#include <cmath>
#include <memory>

#include "tests/support/walking_recording.h"
#include "tools/studio/plot/plot_panel.h"
#include "tools/studio/plot/plot_style.h"

namespace koboshi::studio {
namespace {

constexpr std::uint64_t kTick_us = 10'000;
constexpr std::uint64_t kSecond_us = 1'000'000;

// The names of a robot's recording that the default rows use, and some more.
std::vector<view::Signal> robot_signals() {
  return {{.name = "state_name", .names = {{0, "boot"}, {1, "standing"}, {2, "soft_start"}}},
          {.name = "emergencies"},
          {.name = "true_roll", .unit = "rad"},
          {.name = "true_pitch", .unit = "rad"},
          {.name = "true_zmp_y", .unit = "m"},
          {.name = "planned_zmp_y", .unit = "m"},
          {.name = "left_knee_target", .unit = "rad"},
          {.name = "left_knee_true", .unit = "rad"},
          {.name = "left_load", .unit = "N"}};
}

std::vector<float> robot_values(std::uint64_t tick) {
  const float phase = 0.03F * static_cast<float>(tick);
  const float s = std::sin(phase);
  return {tick < 100 ? 0.0F : 1.0F, 0.0F, 0.1F * s, 0.2F * s, 0.03F * s, 0.02F * s, s, 0.9F * s, 10.0F * s};
}

// A panel with 10 s of a run: samples at 10 ms, 20 ms ... 10 s.
std::unique_ptr<PlotPanel> panel_of_ten_seconds() {
  auto panel = std::make_unique<PlotPanel>();
  panel->resize(900, 600);
  const std::vector<view::Signal> signals = robot_signals();
  panel->set_signals(signals);
  for (std::uint64_t tick = 1; tick <= 1000; ++tick) panel->append(tick * kTick_us, robot_values(tick));
  panel->add_event(2 * kSecond_us, QStringLiteral("Stands."));
  panel->show();
  if (!QTest::qWaitForWindowExposed(panel.get())) qFatal("the panel is not shown");
  return panel;
}

PlotWidget* first_plot(PlotPanel& panel) { return &panel.plot(0); }

QPoint place_of(const PlotWidget& plot, double time_us) {
  return {static_cast<int>(std::lround(plot.x_of(time_us))), plot.height() / 2};
}

void drag(QWidget& widget, QPoint from, QPoint to, Qt::KeyboardModifiers modifiers = {}) {
  QTest::mousePress(&widget, Qt::LeftButton, modifiers, from);
  const auto move = [&](QPoint place) {
    QMouseEvent event(QEvent::MouseMove, place, widget.mapToGlobal(place), Qt::NoButton, Qt::LeftButton,
                      modifiers);
    QApplication::sendEvent(&widget, &event);
  };
  move((from + to) / 2);
  move(to);
  QTest::mouseRelease(&widget, Qt::LeftButton, modifiers, to);
}

void wheel(QWidget& widget, QPoint place, int notches) {
  QWheelEvent event(place, widget.mapToGlobal(place), {}, {0, 120 * notches}, Qt::NoButton, Qt::NoModifier,
                    Qt::NoScrollPhase, false);
  QApplication::sendEvent(&widget, &event);
}

bool is_near(double a, double b, double tolerance) { return std::abs(a - b) <= tolerance; }

// A plot of one signal, without a panel around it.
struct SinglePlot {
  std::shared_ptr<SampleTimes> times = std::make_shared<SampleTimes>();
  std::shared_ptr<Series> values = std::make_shared<Series>();
  TimeView view{};
  PlotWidget plot{view, nullptr};

  explicit SinglePlot(std::span<const float> samples) {
    for (std::size_t i = 0; i < samples.size(); ++i) {
      times->append((i + 1) * kTick_us);
      values->append(samples[i]);
    }
    plot.resize(700, 200);
    set_dashed(false);
    view.set_extent(static_cast<double>(kTick_us), static_cast<double>(samples.size() * kTick_us));
  }
  void set_dashed(bool dashed = true) {
    plot.set_traces(
        {{.signal = {.name = "x", .unit = "N"}, .times = times, .values = values, .dashed = dashed}});
  }
  // Whether a pixel of a column has about the trace's colour.
  bool is_drawn_at(const QImage& image, int x, int top, int bottom) const {
    const QColor colour = PlotStyle(plot.palette()).trace(0);
    for (int y = top; y < bottom; ++y) {
      const QColor other = image.pixelColor(x, y);
      if (std::abs(colour.red() - other.red()) + std::abs(colour.green() - other.green()) +
              std::abs(colour.blue() - other.blue()) <
          150)
        return true;
    }
    return false;
  }
  // Whether the trace is drawn at a time between two heights (0: top of the widget, 1: bottom).
  bool is_drawn(double time_us, double top, double bottom) {
    const QImage image = plot.grab().toImage();
    const int x = static_cast<int>(plot.x_of(time_us));
    const auto y = [](double height) { return static_cast<int>(height * 200.0); };
    return is_drawn_at(image, x - 1, y(top), y(bottom)) || is_drawn_at(image, x, y(top), y(bottom)) ||
           is_drawn_at(image, x + 1, y(top), y(bottom));
  }
};

// Counts the repaints of a widget.
class PaintCounter final : public QObject {
 public:
  explicit PaintCounter(QWidget& widget) { widget.installEventFilter(this); }
  int count = 0;

 protected:
  bool eventFilter(QObject*, QEvent* event) override {
    if (event->type() == QEvent::Paint) ++count;
    return false;
  }
};

}  // namespace

class PlotTest final : public QObject {
  Q_OBJECT

 private Q_SLOTS:
  void steps_of_an_axis_are_nice();
  void numbers_have_units();
  void colours_are_those_of_the_replay_page();
  void a_new_user_sees_leg_trunk_and_zmp();
  void commanded_values_share_the_colour_of_true_ones();
  void rows_stay_for_the_next_run();
  void layout_is_restored();
  void layout_rejects_anything_else();
  void other_units_make_rows_of_their_own();
  void signals_are_dropped_into_a_row();
  void signals_are_removed();
  void signals_are_searched();
  void set_cursor_emits_nothing();
  void click_moves_the_cursor();
  void drag_shifts_the_range();
  void dragging_the_cursor_moves_it();
  void shift_drag_selects_a_range();
  void wheel_keeps_the_time_under_the_pointer();
  void double_click_shows_everything();
  void keys_move_the_cursor();
  void cursor_turns_the_page();
  void range_stays_where_the_user_looks();
  void follow_keeps_the_newest_sample_at_the_right();
  void looking_back_ends_follow_mode();
  void rewind_forgets_what_is_later();
  void states_and_events_have_texts();
  void legend_shows_values_at_the_cursor();
  void dashes_have_gaps_data();
  void dashes_have_gaps();
  void gaps_are_not_drawn_data();
  void gaps_are_not_drawn();
  void a_single_spike_in_an_hour_is_drawn();
  void values_fit_the_visible_range();
  void many_samples_are_one_repaint();
  void colours_follow_the_palette();
  void everything_has_an_accessible_name();
  void shows_any_recording();
};

void PlotTest::steps_of_an_axis_are_nice() {
  QCOMPARE(nice_step(10.0, 5.0), 2.0);
  QCOMPARE(nice_step(10.0, 4.0), 5.0);
  QCOMPARE(nice_step(0.3, 3.0), 0.1);
  QCOMPARE(nice_step(60.0, 10.0), 10.0);
  QCOMPARE(decimals_of(0.1), 1);
  QCOMPARE(decimals_of(0.05), 2);
  QCOMPARE(decimals_of(20.0), 0);
}

void PlotTest::numbers_have_units() {
  const view::Signal angle{.name = "a", .unit = "rad"};
  const view::Signal state{.name = "s", .names = {{2, "standing"}}};
  QCOMPARE(value_text(angle, -0.5F, shown_unit("rad", 1.0), 1), QStringLiteral("−28.6°"));
  QCOMPARE(value_text({.unit = "m"}, 0.0125F, shown_unit("m", 0.1), 1), QStringLiteral("12.5\u00a0mm"));
  QCOMPARE(value_text({.unit = "m"}, 1.25F, shown_unit("m", 2.0), 2), QStringLiteral("1.25\u00a0m"));
  QCOMPARE(value_text(angle, -1e-9F, shown_unit("rad", 1.0), 1), QStringLiteral("0.0°"));
  QCOMPARE(value_text(angle, std::nanf(""), shown_unit("rad", 1.0), 1), QStringLiteral("–"));
  QCOMPARE(value_text(state, 2.0F, {}, 0), QStringLiteral("standing"));
  QCOMPARE(value_text(state, 3.0F, {}, 0), QStringLiteral("3"));
}

void PlotTest::colours_are_those_of_the_replay_page() {
  QFile file(QStringLiteral(KOBOSHI_SOURCE_DIR "/tools/view/replay/page/format.js"));
  QVERIFY(file.open(QIODevice::ReadOnly));
  const QString page = QString::fromUtf8(file.readAll());
  const auto colours_of = [&page](const QString& key) {
    const QString list =
        QRegularExpression(key + QStringLiteral(": \\[([^\\]]*)\\]")).match(page).captured(1);
    QStringList colours;
    auto all = QRegularExpression(QStringLiteral("#[0-9a-f]{6}")).globalMatch(list);
    while (all.hasNext()) colours << all.next().captured(0);
    return colours;
  };
  for (const bool dark : {false, true}) {
    QStringList ours;
    for (const QRgb colour : trace_colours(dark)) ours << QColor(colour).name();
    QCOMPARE(ours, colours_of(dark ? QStringLiteral("dark") : QStringLiteral("light")));
  }
  const QString states = page.mid(page.indexOf(QStringLiteral("STATE_COLOURS = {")));
  const QString table = states.left(states.indexOf(QLatin1Char('}')));
  auto all = QRegularExpression(QStringLiteral("\"?([a-z ]+)\"?: \"(#[0-9a-f]{6})\"")).globalMatch(table);
  int count = 0;
  for (; all.hasNext(); ++count) {
    const auto match = all.next();
    QCOMPARE(state_colour(match.captured(1).trimmed(), 0).name(), match.captured(2));
  }
  QVERIFY(count > 10);
}

void PlotTest::a_new_user_sees_leg_trunk_and_zmp() {
  PlotPanel panel;
  panel.set_signals(robot_signals());
  const PlotRows expected{{QStringLiteral("left_knee_target"), QStringLiteral("left_knee_true")},
                          {QStringLiteral("true_pitch"), QStringLiteral("true_roll")},
                          {QStringLiteral("planned_zmp_y"), QStringLiteral("true_zmp_y")}};
  QCOMPARE(panel.rows(), expected);
  const std::vector<view::Signal> foreign{{.name = "a"}, {.name = "b"}};
  panel.set_signals(foreign);
  QCOMPARE(panel.rows(), (PlotRows{{QStringLiteral("a")}, {QStringLiteral("b")}}));
}

void PlotTest::commanded_values_share_the_colour_of_true_ones() {
  RunSamples samples;
  samples.set_signals(robot_signals());
  const std::vector<Trace> traces =
      traces_of(samples, {QStringLiteral("true_roll"), QStringLiteral("left_knee_target"),
                          QStringLiteral("unknown"), QStringLiteral("left_knee_true")});
  QCOMPARE(traces.size(), 3U);
  QVERIFY(traces[0].colour != traces[1].colour);
  QCOMPARE(traces[1].colour, traces[2].colour);
  QVERIFY(traces[1].dashed && !traces[2].dashed);
}

void PlotTest::rows_stay_for_the_next_run() {
  PlotPanel panel;
  panel.set_signals(robot_signals());
  panel.add({QStringLiteral("left_load")});
  const PlotRows rows = panel.rows();
  QCOMPARE(rows.size(), 4U);
  panel.append(kTick_us, robot_values(1));
  panel.set_signals(robot_signals());
  QCOMPARE(panel.rows(), rows);
  QVERIFY(panel.samples().times()->empty());
  // A run that lacks some of them shows the others, and keeps all.
  const std::vector<view::Signal> fewer{{.name = "left_load", .unit = "N"}};
  panel.set_signals(fewer);
  QCOMPARE(panel.rows(), rows);
  int shown = 0;
  for (const PlotRow* row : panel.findChildren<PlotRow*>()) shown += row->isHidden() ? 0 : 1;
  QCOMPARE(shown, 1);
}

void PlotTest::layout_is_restored() {
  PlotPanel one;
  one.set_signals(robot_signals());
  one.add({QStringLiteral("left_load"), QStringLiteral("emergencies")});
  PlotPanel other;
  QVERIFY(other.restore_layout(one.layout_state()));  // before there is a run
  other.set_signals(robot_signals());
  QCOMPARE(other.rows(), one.rows());
}

void PlotTest::layout_rejects_anything_else() {
  PlotPanel panel;
  panel.set_signals(robot_signals());
  const PlotRows rows = panel.rows();
  for (const QVariant& state :
       {QVariant(), QVariant(7), QVariant(QStringLiteral("text")), QVariant(QVariantList{1, 2.0}),
        QVariant(QVariantList{QVariant(QStringList())})}) {
    const bool restored = panel.restore_layout(state);
    if (!restored) QCOMPARE(panel.rows(), rows);
  }
  QVERIFY(!panel.restore_layout(QVariant()));
  QVERIFY(!panel.restore_layout(QVariant(QVariantList{QVariant(QStringList())})));
}

void PlotTest::other_units_make_rows_of_their_own() {
  PlotPanel panel;
  panel.set_signals(robot_signals());
  panel.add_to_row(0, {QStringLiteral("left_load"), QStringLiteral("true_roll"), QStringLiteral("unknown")});
  QCOMPARE(panel.rows()[0].size(), 3);
  QCOMPARE(panel.rows()[1], QStringList{QStringLiteral("left_load")});
  panel.add({QStringLiteral("state_name"), QStringLiteral("emergencies")});
  QCOMPARE(panel.rows().size(), 6U);  // names of values are no numbers
}

void PlotTest::signals_are_dropped_into_a_row() {
  const auto panel = panel_of_ten_seconds();
  SignalModel model;
  model.set_signals(robot_signals());
  const QModelIndexList group = model.match(model.index(0, 0), Qt::DisplayRole, QStringLiteral("true"));
  QCOMPARE(group.size(), 1);
  const std::unique_ptr<QMimeData> data(model.mimeData(group));
  QWidget* row = panel->plot(0).parentWidget();
  QDragEnterEvent enter({100, 20}, Qt::CopyAction, data.get(), Qt::LeftButton, Qt::NoModifier);
  QApplication::sendEvent(row, &enter);
  QVERIFY(enter.isAccepted());
  QDropEvent drop(QPointF(100.0, 20.0), Qt::CopyAction, data.get(), Qt::LeftButton, Qt::NoModifier);
  QApplication::sendEvent(row, &drop);
  QVERIFY(panel->rows().front().contains(QStringLiteral("true_pitch")));
  QVERIFY(panel->rows().front().contains(QStringLiteral("true_roll")));
}

void PlotTest::signals_are_removed() {
  const auto panel = panel_of_ten_seconds();
  QSignalSpy changes(panel.get(), &PlotPanel::layout_changed);
  panel->remove(1, QStringLiteral("true_pitch"));
  QCOMPARE(panel->rows()[1], QStringList{QStringLiteral("true_roll")});
  panel->remove(1, QStringLiteral("true_roll"));
  QCOMPARE(panel->rows().size(), 2U);
  auto* close = panel->plot(0).parentWidget()->findChild<QToolButton*>();
  QTest::mouseClick(close, Qt::LeftButton);
  QCOMPARE(panel->rows().size(), 1U);
  QCOMPARE(changes.size(), 3);
  QTest::qWait(0);  // deletes the widgets
  QCOMPARE(panel->findChildren<PlotWidget*>().size(), 1);
}

void PlotTest::signals_are_searched() {
  const auto panel = panel_of_ten_seconds();
  auto* search = panel->findChild<QLineEdit*>();
  auto* tree = panel->findChild<QTreeView*>();
  QTest::keyClicks(search, QStringLiteral("KNEE_T"));
  QCOMPARE(tree->model()->rowCount(), 1);
  const QModelIndex group = tree->model()->index(0, 0);
  QCOMPARE(group.data().toString(), QStringLiteral("left_knee"));
  QCOMPARE(tree->model()->rowCount(group), 2);
  QTest::keyClick(search, Qt::Key_A, Qt::ControlModifier);
  QTest::keyClicks(search, QStringLiteral("load"));
  const QModelIndex load = tree->model()->index(0, 0);
  tree->setCurrentIndex(load);
  QTest::keyClick(tree, Qt::Key_Return);
  QCOMPARE(panel->rows().back(), QStringList{QStringLiteral("left_load")});
}

void PlotTest::set_cursor_emits_nothing() {
  const auto panel = panel_of_ten_seconds();
  QSignalSpy moves(panel.get(), &PlotPanel::cursor_moved);
  panel->set_cursor(3 * kSecond_us);
  panel->set_cursor(30 * kSecond_us);
  QCOMPARE(moves.size(), 0);
}

void PlotTest::click_moves_the_cursor() {
  const auto panel = panel_of_ten_seconds();
  PlotWidget* plot = first_plot(*panel);
  QSignalSpy moves(panel.get(), &PlotPanel::cursor_moved);
  QTest::mouseClick(plot, Qt::LeftButton, {}, place_of(*plot, 4e6));
  QCOMPARE(moves.size(), 1);
  QVERIFY(is_near(moves[0][0].toDouble(), 4e6, 20e3));
  QTest::mouseClick(plot, Qt::LeftButton, {}, {2, 50});  // before the first sample
  QCOMPARE(moves[1][0].value<std::uint64_t>(), kTick_us);
}

void PlotTest::drag_shifts_the_range() {
  const auto panel = panel_of_ten_seconds();
  PlotWidget* plot = first_plot(*panel);
  QSignalSpy moves(panel.get(), &PlotPanel::cursor_moved);
  TimeView& view = panel->time_view();
  view.set_range(4e6, 6e6);
  drag(*plot, place_of(*plot, 5e6), place_of(*plot, 4.5e6));
  QVERIFY(is_near(view.from_us(), 4.5e6, 20e3));
  QVERIFY(is_near(view.range_us(), 2e6, 1.0));
  drag(*plot, place_of(*plot, 5e6), place_of(*plot, 6.5e6));
  drag(*plot, place_of(*plot, 4e6), place_of(*plot, 6e6));
  drag(*plot, place_of(*plot, 2e6), place_of(*plot, 4e6));
  drag(*plot, place_of(*plot, 1e6), place_of(*plot, 3e6));
  QCOMPARE(view.from_us(), static_cast<double>(kTick_us));  // not beyond the data
  QCOMPARE(moves.size(), 0);
}

void PlotTest::dragging_the_cursor_moves_it() {
  const auto panel = panel_of_ten_seconds();
  PlotWidget* plot = first_plot(*panel);
  panel->set_cursor(5 * kSecond_us);
  QSignalSpy moves(panel.get(), &PlotPanel::cursor_moved);
  drag(*plot, place_of(*plot, 5e6), place_of(*plot, 7e6));
  QVERIFY(is_near(moves.back()[0].toDouble(), 7e6, 20e3));
  QCOMPARE(panel->time_view().from_us(), static_cast<double>(kTick_us));
}

void PlotTest::shift_drag_selects_a_range() {
  const auto panel = panel_of_ten_seconds();
  PlotWidget* plot = first_plot(*panel);
  drag(*plot, place_of(*plot, 6e6), place_of(*plot, 3e6), Qt::ShiftModifier);
  QVERIFY(is_near(panel->time_view().from_us(), 3e6, 30e3));
  QVERIFY(is_near(panel->time_view().to_us(), 6e6, 30e3));
}

void PlotTest::wheel_keeps_the_time_under_the_pointer() {
  const auto panel = panel_of_ten_seconds();
  PlotWidget* plot = first_plot(*panel);
  const QPoint place = place_of(*plot, 3e6);
  const double time_us = plot->time_at(place.x());
  wheel(*plot, place, 5);
  QVERIFY(panel->time_view().range_us() < 5e6);
  QVERIFY(is_near(plot->time_at(place.x()), time_us, 100.0));
  wheel(*plot, place, 100);
  QCOMPARE(panel->time_view().range_us(), TimeView::kMinRange_us);
  wheel(*plot, place, -200);
  QVERIFY(is_near(panel->time_view().range_us(), 9.99e6, 1.0));
}

void PlotTest::double_click_shows_everything() {
  const auto panel = panel_of_ten_seconds();
  panel->time_view().set_range(4e6, 5e6);
  QTest::mouseDClick(first_plot(*panel), Qt::LeftButton, {}, {300, 50});
  QVERIFY(is_near(panel->time_view().range_us(), 9.99e6, 1.0));
}

void PlotTest::keys_move_the_cursor() {
  const auto panel = panel_of_ten_seconds();
  PlotWidget* plot = first_plot(*panel);
  TimeView& view = panel->time_view();
  panel->set_cursor(5 * kSecond_us);
  const auto press = [plot](Qt::Key key, Qt::KeyboardModifiers modifiers = {}) {
    QTest::keyClick(plot, key, modifiers);
  };
  press(Qt::Key_Right);
  QCOMPARE(*view.cursor_us(), 5 * kSecond_us + kTick_us);
  press(Qt::Key_Left);
  press(Qt::Key_Left);
  QCOMPARE(*view.cursor_us(), 5 * kSecond_us - kTick_us);
  press(Qt::Key_Home);
  QCOMPARE(*view.cursor_us(), kTick_us);
  press(Qt::Key_Left);
  QCOMPARE(*view.cursor_us(), kTick_us);
  press(Qt::Key_End);
  QCOMPARE(*view.cursor_us(), 10 * kSecond_us);
  panel->set_cursor(5 * kSecond_us);
  press(Qt::Key_Plus);
  QVERIFY(is_near(view.range_us(), 9.99e6 / 1.25, 1.0));
  press(Qt::Key_Right, Qt::ControlModifier);
  QVERIFY(view.from_us() > 1.5e6);
  press(Qt::Key_Minus);
  press(Qt::Key_0);
  QVERIFY(is_near(view.range_us(), 9.99e6, 1.0));
  auto* strip = panel->findChild<EventStrip*>();
  panel->set_cursor(5 * kSecond_us);
  QTest::keyClick(strip, Qt::Key_Left);
  QCOMPARE(*view.cursor_us(), 2 * kSecond_us);  // the event before
}

void PlotTest::cursor_turns_the_page() {
  const auto panel = panel_of_ten_seconds();
  TimeView& view = panel->time_view();
  view.set_range(2e6, 4e6);
  panel->set_cursor(3 * kSecond_us);
  QCOMPARE(view.from_us(), 2e6);
  panel->set_cursor(5 * kSecond_us);
  QVERIFY(is_near(view.from_us(), 4.8e6, 1.0));
  QVERIFY(is_near(view.range_us(), 2e6, 1.0));
}

void PlotTest::range_stays_where_the_user_looks() {
  const auto panel = panel_of_ten_seconds();
  TimeView& view = panel->time_view();
  panel->set_cursor(8 * kSecond_us);
  view.set_range(2e6, 4e6);
  for (std::uint64_t tick = 801; tick < 850; ++tick) panel->set_cursor(tick * kTick_us);
  QCOMPARE(view.from_us(), 2e6);
  panel->set_cursor(1 * kSecond_us);  // a jump
  QVERIFY(view.from_us() < 1e6);
}

void PlotTest::follow_keeps_the_newest_sample_at_the_right() {
  const auto panel = panel_of_ten_seconds();
  TimeView& view = panel->time_view();
  QSignalSpy follows(panel.get(), &PlotPanel::follow_changed);
  view.set_range(1e6, 3e6);
  panel->set_follow(true);
  QCOMPARE(view.to_us(), 10e6);
  QVERIFY(is_near(view.range_us(), 2e6, 1.0));
  for (std::uint64_t tick = 1001; tick <= 1200; ++tick) panel->append(tick * kTick_us, robot_values(tick));
  QTest::qWait(0);
  QCOMPARE(view.to_us(), 12e6);
  wheel(*first_plot(*panel), {300, 50}, -2);
  QCOMPARE(view.to_us(), 12e6);  // zooms about the newest sample
  QVERIFY(panel->follows());
  QCOMPARE(follows.size(), 1);
}

void PlotTest::looking_back_ends_follow_mode() {
  const auto panel = panel_of_ten_seconds();
  PlotWidget* plot = first_plot(*panel);
  panel->set_follow(true);
  panel->time_view().zoom(0.2, 0.0);
  drag(*plot, place_of(*plot, 8.5e6), place_of(*plot, 9.5e6));
  QVERIFY(!panel->follows());
  const double from_us = panel->time_view().from_us();
  panel->append(1001 * kTick_us, robot_values(1001));
  QTest::qWait(0);
  QCOMPARE(panel->time_view().from_us(), from_us);
  panel->set_follow(true);
  QTest::mouseClick(plot, Qt::LeftButton, {}, place_of(*plot, 9.5e6));
  QVERIFY(!panel->follows());
}

void PlotTest::rewind_forgets_what_is_later() {
  const auto panel = panel_of_ten_seconds();
  panel->truncate_after(1'500'000);
  QTest::qWait(0);
  QCOMPARE(panel->samples().times()->size(), 150U);
  QCOMPARE(panel->samples().marks().size(), 0U);
  QCOMPARE(panel->samples().states().size(), 2U);
  QCOMPARE(panel->time_view().end_us(), 1.5e6);
  panel->append(151 * kTick_us, robot_values(151));  // the run goes on from there
  panel->truncate_after(0);
  QTest::qWait(0);
  QVERIFY(panel->samples().states().empty());
  panel->append(kTick_us, robot_values(1));
  QTest::qWait(0);
}

void PlotTest::states_and_events_have_texts() {
  const auto panel = panel_of_ten_seconds();
  const auto* strip = panel->findChild<EventStrip*>();
  QCOMPARE(strip->text_at({strip->x_of(0.5e6), 5.0}), QStringLiteral("boot"));
  QCOMPARE(strip->text_at({strip->x_of(5e6), 5.0}), QStringLiteral("standing"));
  QCOMPARE(strip->text_at({strip->x_of(2e6), 30.0}), QStringLiteral("2.000 s: Stands."));
  QCOMPARE(panel->samples().state_name(2), QStringLiteral("soft start"));
  panel->add_event(2 * kSecond_us, QStringLiteral("Stands."));  // the same once more
  panel->add_event(2 * kSecond_us, QStringLiteral("Is pushed."));
  panel->add_event(1 * kSecond_us, QStringLiteral("Boots."));
  QCOMPARE(panel->samples().marks().size(), 3U);
  QCOMPARE(panel->samples().marks().front().text, QStringLiteral("Boots."));
}

void PlotTest::legend_shows_values_at_the_cursor() {
  const auto panel = panel_of_ten_seconds();
  const PlotWidget* plot = first_plot(*panel);
  const QStringList lines = plot->values_text(1e6).split(QLatin1Char('\n'));
  QCOMPARE(lines.size(), 3);
  QCOMPARE(lines[0], QStringLiteral("1.000 s"));
  const double degrees = std::sin(3.0) * 57.2957795;
  QVERIFY2(lines[1].startsWith(QStringLiteral("left_knee_target: %1").arg(degrees, 0, 'f', 2)),
           qPrintable(lines[1]));
  QVERIFY(lines[1].endsWith(QStringLiteral("°")));
  QCOMPARE(plot->legend_at({80.0, 8.0}), QStringLiteral("left_knee_target"));
  QCOMPARE(plot->legend_at({80.0, 80.0}), QString());
}

void PlotTest::dashes_have_gaps_data() {
  QTest::addColumn<std::size_t>("samples");
  QTest::newRow("segments of many dashes") << std::size_t{5};
  QTest::newRow("a pixel between samples")
      << std::size_t{701 - TimeAxisWidget::kAxisWidth - TimeAxisWidget::kRightMargin};
  QTest::newRow("columns of samples") << std::size_t{20'000};
}

void PlotTest::dashes_have_gaps() {
  QFETCH(std::size_t, samples);
  SinglePlot single(std::vector<float>(samples, 1.0F));
  const auto share = [&single] {
    int drawn = 0;
    const QImage image = single.plot.grab().toImage();
    for (int x = TimeAxisWidget::kAxisWidth + 1; x < 700 - TimeAxisWidget::kRightMargin - 1; ++x)
      drawn += single.is_drawn_at(image, x, 40, 190) ? 1 : 0;
    return drawn / (700.0 - TimeAxisWidget::kAxisWidth - TimeAxisWidget::kRightMargin - 2.0);
  };
  QVERIFY(share() > 0.99);
  single.set_dashed();
  QVERIFY2(share() > 0.55 && share() < 0.8, qPrintable(QString::number(share())));
}

void PlotTest::gaps_are_not_drawn_data() {
  QTest::addColumn<std::size_t>("samples");
  QTest::newRow("samples as a line") << std::size_t{100};
  QTest::newRow("columns of samples") << std::size_t{20'000};
}

void PlotTest::gaps_are_not_drawn() {
  QFETCH(std::size_t, samples);
  std::vector<float> values(samples, 1.0F);
  std::fill(values.begin() + static_cast<std::ptrdiff_t>(samples * 2 / 5),
            values.begin() + static_cast<std::ptrdiff_t>(samples * 3 / 5), std::nanf(""));
  SinglePlot single(values);
  const double end_us = single.view.end_us();
  QVERIFY(single.is_drawn(0.2 * end_us, 0.2, 1.0));
  QVERIFY(!single.is_drawn(0.5 * end_us, 0.2, 1.0));
  QVERIFY(single.is_drawn(0.8 * end_us, 0.2, 1.0));
}

void PlotTest::a_single_spike_in_an_hour_is_drawn() {
  std::vector<float> values(360'000, 0.0F);
  values[123'457] = 1.0F;
  SinglePlot single(values);
  QVERIFY(single.is_drawn(1'234'580'000.0, 0.3, 0.7));
  QVERIFY(!single.is_drawn(1'300'000'000.0, 0.3, 0.7));
  QVERIFY(single.plot.limits().second >= 1.0);
}

void PlotTest::values_fit_the_visible_range() {
  std::vector<float> values(1000);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<float>(i);
  SinglePlot single(values);
  single.view.set_range(2e6, 3e6);
  const auto [low, high] = single.plot.limits();
  QVERIFY(low <= 199.0 && low > 150.0);
  QVERIFY(high >= 300.0 && high < 350.0);
  SinglePlot constant(std::vector<float>(10, 5.0F));
  const auto [below, above] = constant.plot.limits();
  QVERIFY(below < 5.0 && above > 5.0);
}

void PlotTest::many_samples_are_one_repaint() {
  const auto panel = panel_of_ten_seconds();
  panel->set_follow(true);
  QTest::qWait(20);
  PaintCounter plot(*first_plot(*panel));
  PaintCounter strip(*panel->findChild<EventStrip*>());
  for (std::uint64_t tick = 1001; tick <= 2000; ++tick) panel->append(tick * kTick_us, robot_values(tick));
  panel->set_cursor(2000 * kTick_us);
  QCoreApplication::processEvents();
  QCoreApplication::processEvents();
  QCOMPARE(plot.count, 1);
  QCOMPARE(strip.count, 1);
}

void PlotTest::colours_follow_the_palette() {
  const auto panel = panel_of_ten_seconds();
  QPalette palette = panel->palette();
  palette.setColor(QPalette::Base, QColor(0x10, 0x14, 0x1a));
  palette.setColor(QPalette::Text, QColor(0xe4, 0xe9, 0xf0));
  panel->setPalette(palette);
  const QImage image = first_plot(*panel)->grab().toImage();
  QCOMPARE(image.pixelColor(1, image.height() - 2), QColor(0x10, 0x14, 0x1a));
  QVERIFY(PlotStyle(palette).dark);
}

void PlotTest::everything_has_an_accessible_name() {
  const auto panel = panel_of_ten_seconds();
  for (const QWidget* widget : panel->findChildren<QWidget*>()) {
    if (widget->focusPolicy() == Qt::NoFocus || widget->isHidden()) continue;
    const auto* button = qobject_cast<const QToolButton*>(widget);
    const bool is_named = !widget->accessibleName().isEmpty() ||
                          (button != nullptr && button->text().size() > 1) ||
                          qobject_cast<const QAbstractScrollArea*>(widget->parentWidget()) != nullptr;
    QVERIFY2(is_named, widget->metaObject()->className());
  }
}

void PlotTest::shows_any_recording() {
  const view::Recording recording = view::walking_recording();
  PlotPanel panel;
  panel.set_signals(recording.signals);
  for (const view::Sample& sample : recording.samples) panel.append(sample.time_us, sample.values);
  for (const view::Event& event : recording.events)
    panel.add_event(event.time_us, QString::fromStdString(event.text));
  for (const view::Signal& signal : recording.signals) panel.add({QString::fromStdString(signal.name)});
  for (const double scale : {1.0, 0.3, 0.01}) {
    panel.time_view().zoom(scale, 1e6);
    QVERIFY(!panel.grab().isNull());
  }
}

}  // namespace koboshi::studio

QTEST_MAIN(koboshi::studio::PlotTest)
#include "plot_test.moc"
