// Times of the window: printed, since machines differ. `tests/support/with_display.sh PROGRAM`.

#include <QApplication>
#include <QDoubleSpinBox>
#include <QElapsedTimer>
#include <QTemporaryDir>
#include <QTest>
#include <filesystem>
#include <fstream>
#include <functional>

#include "studio/motion_editor/joint_panel.h"
#include "studio/motion_editor/motion_panel.h"
#include "studio/plot/plot_panel.h"
#include "tests/studio/window/view_fixture.h"
#include "tests/support/large_motion.h"

namespace koboshi::studio {

using test::kPatience_ms;
using test::kRoot;

class StudioBench final : public ViewFixture {
  Q_OBJECT

 private Q_SLOTS:
  void init() { show_window(); }
  void cleanup() { window_.reset(); }

  // KOBOSHI_RECORDING names a recording, which `recording_bench repeat` makes.
  void long_recording() {
    const QString file = qEnvironmentVariable("KOBOSHI_RECORDING");
    if (file.isEmpty()) QSKIP("KOBOSHI_RECORDING names no recording");
    auto* plots = window_->findChild<PlotPanel*>();
    const std::uint64_t frames = window_->view().frames();
    QElapsedTimer timer;
    timer.start();
    window_->open(file.toStdString());
    QVERIFY(QTest::qWaitFor([&] { return window_->view().frames() > frames; }, kPatience_ms));
    qInfo("first picture after %lld ms", static_cast<long long>(timer.elapsed()));
    const auto complete = [&] {
      const SampleTimes& times = *plots->samples().times();
      return !times.empty() && times[times.size() - 1] + 20'000 > window_->run().end_us();
    };
    QVERIFY(QTest::qWaitFor(complete, 10 * kPatience_ms));
    qInfo("plots complete after %lld ms: %zu samples", static_cast<long long>(timer.elapsed()),
          plots->samples().times()->size());
    constexpr int kSteps = 100;
    const auto measure = [&](const char* what, const std::function<void(int)>& each) {
      timer.restart();
      for (int i = 0; i < kSteps; ++i) {
        each(i);
        QApplication::processEvents();
      }
      qInfo("%s: %.1f ms a step", what, static_cast<double>(timer.elapsed()) / kSteps);
    };
    const auto end_us = window_->run().end_us();
    measure("scrolling ten minutes of plots through the run", [&](int i) {
      const double from_us = static_cast<double>(end_us) * 0.8 * i / kSteps;
      plots->time_view().set_range(from_us, from_us + 600e6);
    });
    measure("jumps of the cursor", [&](int i) {
      window_->run().set_cursor(end_us / kSteps * static_cast<std::uint64_t>(37 * i % kSteps));
    });
  }

  // Edits of an angle in a motion of 1,000 steps, each followed by what it changes in the picture of the
  // window.
  void long_motion() {
    QTemporaryDir folder;
    const std::filesystem::path file = std::filesystem::path(folder.path().toStdString()) / "long.yaml";
    std::ofstream(file) << koboshi::test::large_motion(1000, koboshi::test::bent_legs);
    window_->open(file);
    MotionPanel& motion = window_->motion();
    QCOMPARE(motion.editor().rows().rows.size(), std::size_t{1000});
    QTRY_VERIFY_WITH_TIMEOUT(motion.editor().checked() != nullptr, kPatience_ms);
    motion.show_row(500);
    auto* box = motion.findChild<JointPanel*>()->spin_box(joint("left_shoulder_pitch"));
    constexpr int kEdits = 100;
    const std::uint64_t before = window_->view().frames();
    QElapsedTimer timer;
    timer.start();
    for (int i = 0; i < kEdits; ++i) {
      box->setValue(10.0 + 0.5 * i);
      QApplication::processEvents();
    }
    const double seconds = 1e-3 * static_cast<double>(timer.elapsed());
    qInfo("edits of a motion of 1,000 steps: %.1f a second, %.1f frames/s of the view", kEdits / seconds,
          static_cast<double>(window_->view().frames() - before) / seconds);
  }

  // Frames per second of the view.
  void frame_rate() {
    open(kRoot / "scenarios/walk.yaml");
    run_to(4'000'000);
    const auto measure = [&](const char* what, const std::function<void(int)>& each) {
      const std::uint64_t before = window_->view().frames();
      QElapsedTimer timer;
      timer.start();
      for (int i = 0; timer.elapsed() < 5000; ++i) {
        each(i);
        QApplication::processEvents(QEventLoop::AllEvents, 5);
      }
      qInfo("%s: %.1f frames/s at %dx%d", what,
            static_cast<double>(window_->view().frames() - before) /
                (1e-3 * static_cast<double>(timer.elapsed())),
            window_->width(), window_->height());
    };
    measure("paused, camera turning", [&](int i) { window_->view().look_from(0.01 * i, 0.2); });
    window_->run().set_playing(true);
    measure("running in real time", [](int) {});
    qInfo("pace %.2f", window_->run().pace());
  }
};

}  // namespace koboshi::studio

int main(int argc, char** argv) {
  return koboshi::studio::test::run_window_test<koboshi::studio::StudioBench>(argc, argv);
}

#include "studio_bench.moc"
