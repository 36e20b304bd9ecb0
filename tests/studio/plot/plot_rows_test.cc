#include <QDropEvent>
#include <QFile>
#include <QLineEdit>
#include <QMimeData>
#include <QRegularExpression>
#include <QSignalSpy>
#include <QTreeView>

#include "tests/studio/plot/plot_fixture.h"

// Rows of the plot panel, their signals, colours and units.
namespace koboshi::studio {

class PlotRowsTest final : public QObject {
  Q_OBJECT

 private Q_SLOTS:
  void steps_of_an_axis_are_nice();
  void numbers_have_units();
  void colours_are_those_of_the_replay_page();
  void a_new_user_sees_leg_trunk_and_zmp();
  void commanded_values_share_the_colour_of_true_ones();
  void zmp_and_sides_have_the_colours_of_their_marks();
  void angles_have_no_jumps();
  void rows_stay_for_the_next_run();
  void layout_is_restored();
  void layout_rejects_anything_else();
  void other_units_make_rows_of_their_own();
  void signals_are_dropped_into_a_row();
  void signals_are_removed();
  void signals_are_searched();
};

static const test::AddQtTest<PlotRowsTest> kPlotRowsTest;

void PlotRowsTest::steps_of_an_axis_are_nice() {
  QCOMPARE(nice_step(10.0, 5.0), 2.0);
  QCOMPARE(nice_step(10.0, 4.0), 5.0);
  QCOMPARE(nice_step(0.3, 3.0), 0.1);
  QCOMPARE(nice_step(60.0, 10.0), 10.0);
  QCOMPARE(decimals_of(0.1), 1);
  QCOMPARE(decimals_of(0.05), 2);
  QCOMPARE(decimals_of(20.0), 0);
}

void PlotRowsTest::numbers_have_units() {
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

void PlotRowsTest::colours_are_those_of_the_replay_page() {
  QFile file(QStringLiteral(KOBOSHI_SOURCE_DIR "/view/replay/page/format.js"));
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

void PlotRowsTest::a_new_user_sees_leg_trunk_and_zmp() {
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

void PlotRowsTest::commanded_values_share_the_colour_of_true_ones() {
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

// The replay page has the same rule: tests/gui/replay_test.py has these examples, too.
void PlotRowsTest::zmp_and_sides_have_the_colours_of_their_marks() {
  const auto colours = [](const QStringList& names) {
    RunSamples samples;
    std::vector<view::Signal> signals;
    for (const QString& name : names) signals.push_back({.name = name.toStdString(), .unit = "m"});
    samples.set_signals(signals);
    std::vector<int> found;
    for (const Trace& trace : traces_of(samples, names)) found.push_back(trace.colour);
    return found;
  };
  const auto text = [](const char* names) { return QString::fromLatin1(names).split(QLatin1Char(' ')); };
  QCOMPARE(colours(text("planned_zmp_y zmp_y true_zmp_y")), (std::vector{1, 0, 7}));
  QCOMPARE(colours(text("true_left_load true_right_load")), (std::vector{2, 3}));
  QCOMPARE(colours(text("right_load left_load")), (std::vector{3, 2}));
  QCOMPARE(colours(text("left_load right_knee")), (std::vector{0, 1}));
  QCOMPARE(colours(text("left_zmp_y right_zmp_y")), (std::vector{2, 3}));
}

// A heading that passes 180 degrees, also after a rewind to the other side of it.
void PlotRowsTest::angles_have_no_jumps() {
  RunSamples samples;
  const std::vector<view::Signal> signals{{.name = "true_yaw", .unit = "rad"}, {.name = "load", .unit = "N"}};
  samples.set_signals(signals);
  const float turn = 6.2831853F;
  const auto append = [&](std::uint64_t tick, float value) {
    const std::vector<float> values{value, value};
    samples.append(tick * kTick_us, values);
  };
  append(1, 3.1F);
  append(2, 3.2F - turn);
  append(3, std::nanf(""));
  append(4, 3.3F - turn);
  QVERIFY(is_near(static_cast<double>((*samples.values(0))[1]), 3.2, 1e-5));
  QVERIFY(is_near(static_cast<double>((*samples.values(0))[3]), 3.3, 1e-5));
  QVERIFY(is_near(static_cast<double>((*samples.values(1))[1]), 3.2 - 6.2831853, 1e-5));
  samples.truncate_after(3 * kTick_us);
  append(5, 3.3F - turn);
  QVERIFY(is_near(static_cast<double>((*samples.values(0))[3]), 3.3, 1e-5));
  append(6, 0.5F);  // no turn: a real step
  QVERIFY(is_near(static_cast<double>((*samples.values(0))[4]), 0.5, 1e-5));
}

void PlotRowsTest::rows_stay_for_the_next_run() {
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

void PlotRowsTest::layout_is_restored() {
  PlotPanel one;
  one.set_signals(robot_signals());
  one.add({QStringLiteral("left_load"), QStringLiteral("emergencies")});
  PlotPanel other;
  QVERIFY(other.restore_layout(one.layout_state()));  // before there is a run
  other.set_signals(robot_signals());
  QCOMPARE(other.rows(), one.rows());
}

void PlotRowsTest::layout_rejects_anything_else() {
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

void PlotRowsTest::other_units_make_rows_of_their_own() {
  PlotPanel panel;
  panel.set_signals(robot_signals());
  panel.add_to_row(0, {QStringLiteral("left_load"), QStringLiteral("true_roll"), QStringLiteral("unknown")});
  QCOMPARE(panel.rows()[0].size(), 3);
  QCOMPARE(panel.rows()[1], QStringList{QStringLiteral("left_load")});
  panel.add({QStringLiteral("state_name"), QStringLiteral("emergencies")});
  QCOMPARE(panel.rows().size(), 6U);  // names of values are no numbers
}

void PlotRowsTest::signals_are_dropped_into_a_row() {
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

void PlotRowsTest::signals_are_removed() {
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

void PlotRowsTest::signals_are_searched() {
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

}  // namespace koboshi::studio

int main(int argc, char** argv) {
  QApplication application(argc, argv);
  return koboshi::test::run_qt_tests(argc, argv);
}

#include "plot_rows_test.moc"
