#pragma once

#include <QApplication>
#include <QMouseEvent>
#include <QTest>
#include <QWheelEvent>
#include <algorithm>
#include <cmath>
#include <memory>
#include <span>
#include <vector>

#include "studio/plot/plot_panel.h"
#include "studio/plot/plot_style.h"
#include "tests/support/qt_tests.h"

// A plot panel with samples, and real events of the mouse.
namespace koboshi::studio {

inline constexpr std::uint64_t kTick_us = 10'000;
inline constexpr std::uint64_t kSecond_us = 1'000'000;

// The names of a robot's recording that the default rows use, and some more.
inline std::vector<view::Signal> robot_signals() {
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

inline std::vector<float> robot_values(std::uint64_t tick) {
  const float phase = 0.03F * static_cast<float>(tick);
  const float s = std::sin(phase);
  return {tick < 100 ? 0.0F : 1.0F, 0.0F, 0.1F * s, 0.2F * s, 0.03F * s, 0.02F * s, s, 0.9F * s, 10.0F * s};
}

// A panel with 10 s of a run: samples at 10 ms, 20 ms ... 10 s.
inline std::unique_ptr<PlotPanel> panel_of_ten_seconds() {
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

inline PlotWidget* first_plot(PlotPanel& panel) { return &panel.plot(0); }

inline QPoint place_of(const PlotWidget& plot, double time_us) {
  return {static_cast<int>(std::lround(plot.x_of(time_us))), plot.height() / 2};
}

inline void drag(QWidget& widget, QPoint from, QPoint to, Qt::KeyboardModifiers modifiers = {}) {
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

inline void wheel(QWidget& widget, QPoint place, int notches) {
  QWheelEvent event(place, widget.mapToGlobal(place), {}, {0, 120 * notches}, Qt::NoButton, Qt::NoModifier,
                    Qt::NoScrollPhase, false);
  QApplication::sendEvent(&widget, &event);
}

inline bool is_near(double a, double b, double tolerance) { return std::abs(a - b) <= tolerance; }

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

}  // namespace koboshi::studio
