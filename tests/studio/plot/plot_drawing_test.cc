#include "tests/studio/plot/plot_fixture.h"
#include "tests/support/walking_recording.h"

// Plots: their pixels, legends and accessible texts.
namespace koboshi::studio {

class PlotDrawingTest final : public QObject {
  Q_OBJECT

 private Q_SLOTS:
  void states_and_events_have_texts();
  void legend_shows_values_at_the_cursor();
  void the_legend_leaves_room_for_the_curves();
  void a_signal_without_values_is_not_in_the_legend();
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

static const test::AddQtTest<PlotDrawingTest> kPlotDrawingTest;

void PlotDrawingTest::states_and_events_have_texts() {
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

void PlotDrawingTest::legend_shows_values_at_the_cursor() {
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

void PlotDrawingTest::the_legend_leaves_room_for_the_curves() {
  std::vector<Trace> traces;
  const auto times = std::make_shared<SampleTimes>();
  times->append(kTick_us);
  int colour = 0;
  for (const char* joint : {"left_hip_pitch", "left_knee", "left_ankle_pitch"}) {
    for (const char* role : {"_target", "_true"}) {
      auto values = std::make_shared<Series>();
      values->append(0.1F);
      traces.push_back({.signal = {.name = std::string(joint) + role, .unit = "rad"},
                        .times = times,
                        .values = values,
                        .colour = colour,
                        .dashed = role == std::string("_target")});
    }
    ++colour;
  }
  TimeView view;
  PlotWidget plot(view, nullptr);
  plot.set_traces(traces);
  for (const QSize size :
       {QSize(900, 300), QSize(430, 150), QSize(430, 120), QSize(240, 84), QSize(300, 500)}) {
    plot.resize(size);
    plot.grab();
    const double room = plot.curve_height() / size.height();
    QVERIFY2(room >= 0.37,
             qPrintable(QStringLiteral("%1x%2: %3").arg(size.width()).arg(size.height()).arg(room)));
  }
  plot.resize(1300, 300);
  plot.grab();
  QVERIFY(plot.legend_texts().contains(QStringLiteral("left_knee_true")));
  plot.resize(430, 150);
  plot.grab();
  QVERIFY(plot.legend_texts().contains(QStringLiteral("true")));
  plot.resize(240, 84);
  plot.grab();
  QVERIFY2(plot.legend_texts().back().startsWith(QLatin1Char('+')),
           qPrintable(plot.legend_texts().join(u' ')));
}

void PlotDrawingTest::a_signal_without_values_is_not_in_the_legend() {
  PlotPanel panel;
  const std::vector<view::Signal> signals{{.name = "planned_zmp_y", .unit = "m"},
                                          {.name = "zmp_y", .unit = "m"}};
  panel.set_signals(signals);
  const auto append = [&](std::uint64_t tick, float planned) {
    const std::vector<float> values{planned, 0.01F};
    panel.append(tick * kTick_us, values);
    panel.set_cursor(tick * kTick_us);
  };
  const QString planned = QStringLiteral("planned_zmp_y");
  append(1, std::nanf(""));
  panel.resize(900, 600);
  panel.grab();  // lays it out
  QCOMPARE(panel.plot(0).legend_texts(), QStringList{QStringLiteral("zmp_y")});
  QVERIFY(!panel.plot(0).legend_texts().contains(planned));
  append(2, 0.02F);
  QVERIFY(panel.plot(0).legend_texts().contains(planned));
}

void PlotDrawingTest::dashes_have_gaps_data() {
  QTest::addColumn<std::size_t>("samples");
  QTest::newRow("segments of many dashes") << std::size_t{5};
  QTest::newRow("a pixel between samples")
      << std::size_t{701 - TimeAxisWidget::kAxisWidth - TimeAxisWidget::kRightMargin};
  QTest::newRow("columns of samples") << std::size_t{20'000};
}

void PlotDrawingTest::dashes_have_gaps() {
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

void PlotDrawingTest::gaps_are_not_drawn_data() {
  QTest::addColumn<std::size_t>("samples");
  QTest::newRow("samples as a line") << std::size_t{100};
  QTest::newRow("columns of samples") << std::size_t{20'000};
}

void PlotDrawingTest::gaps_are_not_drawn() {
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

void PlotDrawingTest::a_single_spike_in_an_hour_is_drawn() {
  std::vector<float> values(360'000, 0.0F);
  values[123'457] = 1.0F;
  SinglePlot single(values);
  QVERIFY(single.is_drawn(1'234'580'000.0, 0.3, 0.7));
  QVERIFY(!single.is_drawn(1'300'000'000.0, 0.3, 0.7));
  QVERIFY(single.plot.limits().second >= 1.0);
}

void PlotDrawingTest::values_fit_the_visible_range() {
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

void PlotDrawingTest::many_samples_are_one_repaint() {
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

void PlotDrawingTest::colours_follow_the_palette() {
  const auto panel = panel_of_ten_seconds();
  QPalette palette = panel->palette();
  palette.setColor(QPalette::Base, QColor(0x10, 0x14, 0x1a));
  palette.setColor(QPalette::Text, QColor(0xe4, 0xe9, 0xf0));
  panel->setPalette(palette);
  const QImage image = first_plot(*panel)->grab().toImage();
  QCOMPARE(image.pixelColor(1, image.height() - 2), QColor(0x10, 0x14, 0x1a));
  QVERIFY(PlotStyle(palette).dark);
}

void PlotDrawingTest::everything_has_an_accessible_name() {
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

void PlotDrawingTest::shows_any_recording() {
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

#include "plot_drawing_test.moc"
