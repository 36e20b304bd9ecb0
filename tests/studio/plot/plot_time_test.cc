#include <QSignalSpy>

#include "tests/studio/plot/plot_fixture.h"

// Cursor and range of the plots, by mouse, keys and the run.
namespace koboshi::studio {

class PlotTimeTest final : public QObject {
  Q_OBJECT

 private Q_SLOTS:
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
};

static const test::AddQtTest<PlotTimeTest> kPlotTimeTest;

void PlotTimeTest::set_cursor_emits_nothing() {
  const auto panel = panel_of_ten_seconds();
  QSignalSpy moves(panel.get(), &PlotPanel::cursor_moved);
  panel->set_cursor(3 * kSecond_us);
  panel->set_cursor(30 * kSecond_us);
  QCOMPARE(moves.size(), 0);
}

void PlotTimeTest::click_moves_the_cursor() {
  const auto panel = panel_of_ten_seconds();
  PlotWidget* plot = first_plot(*panel);
  QSignalSpy moves(panel.get(), &PlotPanel::cursor_moved);
  QTest::mouseClick(plot, Qt::LeftButton, {}, place_of(*plot, 4e6));
  QCOMPARE(moves.size(), 1);
  QVERIFY(is_near(moves[0][0].toDouble(), 4e6, 20e3));
  QTest::mouseClick(plot, Qt::LeftButton, {}, {2, 50});  // before the first sample
  QCOMPARE(moves[1][0].value<std::uint64_t>(), kTick_us);
}

void PlotTimeTest::drag_shifts_the_range() {
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

void PlotTimeTest::dragging_the_cursor_moves_it() {
  const auto panel = panel_of_ten_seconds();
  PlotWidget* plot = first_plot(*panel);
  panel->set_cursor(5 * kSecond_us);
  QSignalSpy moves(panel.get(), &PlotPanel::cursor_moved);
  drag(*plot, place_of(*plot, 5e6), place_of(*plot, 7e6));
  QVERIFY(is_near(moves.back()[0].toDouble(), 7e6, 20e3));
  QCOMPARE(panel->time_view().from_us(), static_cast<double>(kTick_us));
}

void PlotTimeTest::shift_drag_selects_a_range() {
  const auto panel = panel_of_ten_seconds();
  PlotWidget* plot = first_plot(*panel);
  drag(*plot, place_of(*plot, 6e6), place_of(*plot, 3e6), Qt::ShiftModifier);
  QVERIFY(is_near(panel->time_view().from_us(), 3e6, 30e3));
  QVERIFY(is_near(panel->time_view().to_us(), 6e6, 30e3));
}

void PlotTimeTest::wheel_keeps_the_time_under_the_pointer() {
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

void PlotTimeTest::double_click_shows_everything() {
  const auto panel = panel_of_ten_seconds();
  panel->time_view().set_range(4e6, 5e6);
  QTest::mouseDClick(first_plot(*panel), Qt::LeftButton, {}, {300, 50});
  QVERIFY(is_near(panel->time_view().range_us(), 9.99e6, 1.0));
}

void PlotTimeTest::keys_move_the_cursor() {
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

void PlotTimeTest::cursor_turns_the_page() {
  const auto panel = panel_of_ten_seconds();
  TimeView& view = panel->time_view();
  view.set_range(2e6, 4e6);
  panel->set_cursor(3 * kSecond_us);
  QCOMPARE(view.from_us(), 2e6);
  panel->set_cursor(5 * kSecond_us);
  QVERIFY(is_near(view.from_us(), 4.8e6, 1.0));
  QVERIFY(is_near(view.range_us(), 2e6, 1.0));
}

void PlotTimeTest::range_stays_where_the_user_looks() {
  const auto panel = panel_of_ten_seconds();
  TimeView& view = panel->time_view();
  panel->set_cursor(8 * kSecond_us);
  view.set_range(2e6, 4e6);
  for (std::uint64_t tick = 801; tick < 850; ++tick) panel->set_cursor(tick * kTick_us);
  QCOMPARE(view.from_us(), 2e6);
  panel->set_cursor(1 * kSecond_us);  // a jump
  QVERIFY(view.from_us() < 1e6);
}

void PlotTimeTest::follow_keeps_the_newest_sample_at_the_right() {
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

void PlotTimeTest::looking_back_ends_follow_mode() {
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

void PlotTimeTest::rewind_forgets_what_is_later() {
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

}  // namespace koboshi::studio

#include "plot_time_test.moc"
