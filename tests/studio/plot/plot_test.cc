#include <QTest>

#include "tests/support/walking_recording.h"
#include "tools/studio/plot/plot_panel.h"

namespace koboshi::studio {

class PlotTest final : public QObject {
  Q_OBJECT

 private Q_SLOTS:
  void shows_a_recording();
};

void PlotTest::shows_a_recording() {
  const view::Recording recording = view::walking_recording();
  PlotPanel panel;
  panel.resize(1000, 600);
  panel.set_signals(recording.signals);
  for (const view::Sample& sample : recording.samples) panel.append(sample.time_us, sample.values);
  panel.show();
  QVERIFY(QTest::qWaitForWindowExposed(&panel));
  QVERIFY(!panel.rows().empty());
}

}  // namespace koboshi::studio

QTEST_MAIN(koboshi::studio::PlotTest)
#include "plot_test.moc"
