#pragma once

#include <QComboBox>
#include <QDockWidget>
#include <QDoubleSpinBox>
#include <QLineEdit>
#include <QPlainTextEdit>
#include <QProcess>
#include <QPushButton>
#include <QSlider>
#include <QTableView>
#include <QTreeView>
#include <vector>

#include "studio/controls/transport_bar.h"
#include "studio/motion_editor/joint_panel.h"
#include "studio/plot/plot_widget.h"
#include "studio/widgets/command_search.h"
#include "tests/studio/window/view_fixture.h"

namespace koboshi::studio {

// The studio's window with real keys and clicks: xdotool sends them, and a window manager and the X server
// bring them to the window.
class KeyboardFixture : public ViewFixture {
 protected:
  // Runs xdotool and lets the window take what it sends.
  static bool xdotool(const QStringList& arguments) {
    QProcess process;
    process.start(QStringLiteral("xdotool"), arguments);
    const bool ended =
        QTest::qWaitFor([&] { return process.state() == QProcess::NotRunning; }, test::kPatience_ms);
    return ended && process.exitCode() == 0;
  }
  // Presses keys one after the other, each as "ctrl+z".
  static bool press(const QStringList& keys) {
    const bool worked = xdotool(QStringList{QStringLiteral("key")} + keys);
    QTest::qWait(20);
    return worked;
  }
  static bool press(const char* key) { return press(QStringList{QLatin1String(key)}); }
  static bool click(const QWidget& widget, const QPoint& place) {
    const QPoint at = widget.mapToGlobal(place);
    const bool worked =
        xdotool({QStringLiteral("mousemove"), QStringLiteral("--sync"), QString::number(at.x()),
                 QString::number(at.y()), QStringLiteral("click"), QStringLiteral("1")});
    QTest::qWait(20);
    return worked;
  }
  void raise(const char* dock) const {
    auto* one = window_->findChild<QDockWidget*>(QLatin1String(dock));
    one->show();
    one->raise();
    QTest::qWait(10);
  }
  template <typename T>
  T* in_dock(const char* dock, const char* name = "") const {
    return window_->findChild<QDockWidget*>(QLatin1String(dock))->findChild<T*>(QString::fromLatin1(name));
  }
  // Widgets that can have the keyboard, one of each kind in each panel, with the panel that shows them.
  struct Place {
    const char* name;
    const char* dock;
    QWidget* widget;
  };
  std::vector<Place> places() const {
    MotionPanel& motion = window_->motion();
    const std::size_t knee = 0;
    return {
        {"view", "", &window_->view()},
        {"time slider", "", window_->findChild<TransportBar*>()->findChild<QSlider*>()},
        {"speed", "", window_->findChild<TransportBar*>()->findChild<QComboBox*>()},
        {"search for commands", "", window_->findChild<CommandSearch*>()},
        {"operator's button", "operator", in_dock<QPushButton>("operator", "enable")},
        {"operator's number", "operator", in_dock<QDoubleSpinBox>("operator")},
        {"plot", "plots", in_dock<PlotWidget>("plots")},
        {"search for signals", "plots", in_dock<QLineEdit>("plots")},
        {"list of signals", "plots", in_dock<QTreeView>("plots")},
        {"events", "events", in_dock<QAbstractItemView>("events")},
        {"filter of frames", "can", in_dock<QLineEdit>("can")},
        {"frames", "can", in_dock<QTableView>("can", "frames")},
        {"filter of objects", "objects", in_dock<QLineEdit>("objects")},
        {"objects", "objects", in_dock<QTableView>("objects")},
        {"log", "messages", in_dock<QPlainTextEdit>("messages", "log")},
        {"steps", "motion", motion.findChild<QTableView*>(QStringLiteral("steps"))},
        {"joint's number", "motion", motion.findChild<JointPanel*>()->spin_box(knee)},
        {"joint's slider", "motion", motion.findChild<JointPanel*>()->findChild<QSlider*>()},
        {"name of the motion", "motion", motion.findChild<QLineEdit*>(QStringLiteral("motion_name"))},
    };
  }
  bool focus(const Place& place) const {
    if (*place.dock != '\0') raise(place.dock);
    place.widget->setFocus(Qt::OtherFocusReason);
    return QTest::qWaitFor([&] { return place.widget->hasFocus(); }, 1000);
  }
};

}  // namespace koboshi::studio
