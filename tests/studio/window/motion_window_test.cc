// Motions in the window: made, checked, previewed and played in physics.

#include <QAbstractScrollArea>
#include <QAction>
#include <QComboBox>
#include <QDockWidget>
#include <QDoubleSpinBox>
#include <QSignalSpy>
#include <QTemporaryDir>
#include <QTest>
#include <algorithm>
#include <filesystem>
#include <optional>

#include "studio/motion_editor/joint_panel.h"
#include "studio/motion_editor/motion_panel.h"
#include "studio/motion_editor/step_model.h"
#include "studio/widgets/message_bar.h"
#include "tests/studio/window/view_fixture.h"

namespace koboshi::studio {

using test::kPatience_ms;
using test::kRoot;

class MotionWindowTest final : public ViewFixture {
  Q_OBJECT

 private Q_SLOTS:
  void init() { show_window(); }
  void cleanup() { window_.reset(); }

  void plays_a_motion_as_preview_and_in_physics() {
    window_->open(kRoot / "robots/koboshi/motions/squat.yaml");
    QTRY_VERIFY(window_->view().link_at(
        QPointF(0.5 * window_->view().width(), 0.5 * window_->view().height())));  // the pose
    for (const bool physics : {false, true}) {
      QSignalSpy opened(&window_->run(), &RunController::opened);
      Q_EMIT window_->motion().play_requested(physics, 0);
      QVERIFY(opened.wait(kPatience_ms));
      QVERIFY2(window_->messages().text().isEmpty(), qPrintable(window_->messages().text()));
      QCOMPARE(window_->run().session() != nullptr, physics);
      QTRY_VERIFY_WITH_TIMEOUT(window_->run().cursor_us() > 200'000, kPatience_ms);
    }
  }

  // The pose of a recorded run or a preview becomes a step with the same angles.
  void inserts_the_pose_of_the_run() {
    window_->open(kRoot / "robots/koboshi/motions/squat.yaml");
    MotionPanel& motion = window_->motion();
    QSignalSpy opened(&window_->run(), &RunController::opened);
    Q_EMIT motion.play_requested(false, 0);
    QVERIFY(opened.wait(kPatience_ms));
    // At the end of the second step, the preview has the angles of its pose.
    const auto& rows = motion.editor().rows().rows;
    std::size_t move = 0;
    while (rows[move].kind != simulation::StepSource::Kind::kMove) ++move;
    const double end_s = rows[move].start_s + rows[move].duration_s;
    const std::vector<double> wanted = rows[move].angles_rad;
    QTRY_VERIFY_WITH_TIMEOUT(window_->run().playing(), kPatience_ms);
    window_->run().set_playing(false);
    window_->run().set_cursor(static_cast<std::uint64_t>(1e6 * end_s));
    const std::size_t count = rows.size();
    motion.show_row(move);
    action("Insert the run's pose")->trigger();
    QCOMPARE(motion.editor().rows().rows.size(), count + 1);
    QCOMPARE(motion.current_row(), std::optional(move + 1));
    const std::vector<double> captured = motion.editable_pose();
    for (std::size_t i = 0; i < wanted.size(); ++i)
      QVERIFY2(std::abs(captured[i] - wanted[i]) < 0.003,
               qPrintable(QString::number(captured[i] - wanted[i])));
  }

  // A motion goes to the robot of the simulation, is in the operator's list, and is played.
  void uploads_a_motion_to_the_simulation_and_plays_it() {
    QTemporaryDir folder;
    const std::filesystem::path file = std::filesystem::path(folder.path().toStdString()) / "my_bow.yaml";
    window_->open(kRoot / "robots/koboshi/motions/bow.yaml");
    QVERIFY(window_->motion().save_as(file));
    open_scenario("go.yaml");
    auto* motions = window_->findChild<QComboBox*>(QStringLiteral("motions"));
    const int before = motions->count();
    QVERIFY(before > 0);
    run_to(1'500'000);  // limp: a robot that starts stores nothing
    action("Upload the motion to a robot")->trigger();
    QCOMPARE(window_->messages().kind(), MessageKind::kInformation);  // it pauses
    QVERIFY(window_->messages().text().contains(QStringLiteral("pauses")));
    run_to(3'800'000);
    QTRY_COMPARE_WITH_TIMEOUT(motions->count(), before + 1, kPatience_ms);
    QCOMPARE(motions->currentText(), QStringLiteral("my_bow"));
    QCOMPARE(window_->messages().kind(), MessageKind::kSuccess);
    QVERIFY2(window_->messages().text().startsWith(QStringLiteral("my_bow is motion %1").arg(before)),
             qPrintable(window_->messages().text()));
    QCOMPARE(window_->run().status().said.state, behaviour::State::kStanding);
    QVERIFY(test::click(*window_, "play_motion"));
    run_to(3'950'000);
    QCOMPARE(window_->run().status().said.state, behaviour::State::kMotion);
    save_picture("uploaded");
    // A rewind takes the upload back.
    window_->run().set_cursor(1'400'000);
    window_->run().rewind_to_cursor();
    QTRY_COMPARE_WITH_TIMEOUT(motions->count(), before, kPatience_ms);
  }

  void plays_from_the_current_step() {
    window_->open(kRoot / "robots/koboshi/motions/squat.yaml");
    MotionPanel& motion = window_->motion();
    const std::size_t last = motion.editor().rows().sections.front().row_count - 1;
    QVERIFY(motion.start_us(last) > 500'000);
    {
      QSignalSpy opened(&window_->run(), &RunController::opened);
      Q_EMIT motion.play_requested(false, static_cast<int>(last));
      QVERIFY(opened.wait(kPatience_ms));
      QTRY_VERIFY_WITH_TIMEOUT(window_->run().cursor_us() >= motion.start_us(last), kPatience_ms);
      // At its end, a loop begins there again.
      action("Loop the playback")->setChecked(true);
      window_->run().set_cursor(window_->run().end_us() - 1000);
      QTRY_VERIFY_WITH_TIMEOUT(window_->run().cursor_us() < window_->run().end_us() - 1000, kPatience_ms);
      QVERIFY(window_->run().cursor_us() >= motion.start_us(last));
      QVERIFY(window_->run().playing());
      action("Loop the playback")->setChecked(false);
    }
    // A click on the ruler of the timeline is another place to begin.
    QTRY_VERIFY_WITH_TIMEOUT(motion.editor().checked() != nullptr, kPatience_ms);
    const auto areas = motion.findChildren<QAbstractScrollArea*>();
    const auto found = std::ranges::find_if(
        areas, [](const QObject* area) { return area->inherits("koboshi::studio::Timeline"); });
    QVERIFY(found != areas.end());
    QWidget* const timeline = (*found)->viewport();
    QTest::mouseClick(timeline, Qt::LeftButton, {}, QPoint(timeline->width() / 3, 8));
    QVERIFY(motion.preview_start_us(last) != motion.start_us(last));
    QVERIFY(motion.preview_start_us(last) % 10'000 == 0 && motion.preview_start_us(last) > 0);
    motion.show_row(0);
    motion.show_row(last);
    QCOMPARE(motion.preview_start_us(last), motion.start_us(last));
    const std::string rest = motion.text_from(last);
    QVERIFY(rest.find("start") != std::string::npos);
    QSignalSpy opened(&window_->run(), &RunController::opened);
    Q_EMIT motion.play_requested(true, static_cast<int>(last));
    QVERIFY(opened.wait(kPatience_ms));
    QVERIFY2(window_->messages().text().isEmpty(), qPrintable(window_->messages().text()));
    QVERIFY(window_->run().session() != nullptr);
  }

  // A user's whole way: a motion of three poses, mirrored, scaled, refused by the check, mended, undone and
  // done again, saved, read again and played.
  void makes_a_motion() {
    QTemporaryDir folder;
    const std::filesystem::path file = std::filesystem::path(folder.path().toStdString()) / "wave_both.yaml";
    MotionPanel& motion = window_->motion();
    auto* editor = motion.findChild<MotionEditor*>();
    const auto trigger = [&](const char* name) {
      motion.findChild<QAction*>(QLatin1String(name))->trigger();
    };
    const auto undo_count = [&] { return editor->document().history().undo_count(); };
    const auto set_joint = [&](const char* joint, double degrees) {
      const auto& names = editor->document().robot().model.joint_names;
      const auto index = static_cast<std::size_t>(std::ranges::find(names, joint) - names.begin());
      auto* box = motion.findChild<JointPanel*>()->spin_box(index);
      box->setFocus();
      box->selectAll();
      QTest::keyClicks(box, QString::number(degrees));
      QTest::keyClick(box, Qt::Key_Return);
    };
    const auto set_time = [&](int row, double seconds) {
      auto* model = motion.findChild<StepModel*>();
      QVERIFY(model->setData(model->index(row, StepModel::kTime), seconds, Qt::EditRole));
    };
    const auto finding_starts = [&](QChar kind) {
      for (const RowFinding& finding : editor->findings())
        if (finding.code.startsWith(kind) && finding.severity == simulation::Severity::kError) return true;
      return false;
    };
    const auto wait_for_check = [&] { QTRY_VERIFY_WITH_TIMEOUT(!editor->is_checking(), kPatience_ms); };
    const auto picture = [&](const char* name) {
      const QString pictures = qEnvironmentVariable("KOBOSHI_PICTURES");
      if (pictures.isEmpty()) return;
      QTest::qWait(500);
      window_->grab().save(pictures + QStringLiteral("/make-") + QLatin1String(name) +
                           QStringLiteral(".png"));
    };
    window_->findChild<QDockWidget*>(QStringLiteral("motion"))->raise();

    action("New motion")->trigger();
    QVERIFY(editor->is_open());
    // Three dragged poses: both hands and the trunk.
    for (const auto& [link, by] :
         {std::pair("left_forearm", QPoint(30, -30)), std::pair("right_forearm", QPoint(-20, -30)),
          std::pair("trunk", QPoint(0, 12))}) {
      trigger("insert_pose");
      QTRY_VERIFY2(place_of(link), link);
      const std::string text = motion.text();
      drag(*place_of(link), by);
      QVERIFY2(motion.text() != text, link);
    }
    // Poses by numbers: the arm up, bent, and down again by the mirror.
    trigger("insert_pose");
    set_joint("right_shoulder_roll", -80.0);
    trigger("insert_pose");
    set_joint("right_elbow", -70.0);
    trigger("insert_pose");
    set_joint("right_elbow", -20.0);
    trigger("mirror");
    const std::size_t rows = editor->rows().rows.size();
    for (std::size_t row = 0; row < rows; ++row) set_time(static_cast<int>(row), 0.5);
    wait_for_check();
    picture("poses");

    // Too fast: the compiler or the check says which step.
    set_time(1, 0.02);
    QTRY_VERIFY_WITH_TIMEOUT(finding_starts(u'M') || finding_starts(u'C'), kPatience_ms);
    picture("refused");
    set_time(1, 1.0);
    wait_for_check();
    QTRY_VERIFY_WITH_TIMEOUT(!finding_starts(u'M') && !finding_starts(u'C'), kPatience_ms);

    const std::string made = motion.text();
    QVERIFY2(undo_count() >= 10, qPrintable(QString::number(undo_count())));
    for (int i = 0; i < 10; ++i) trigger("undo");
    QVERIFY(motion.text() != made);
    for (int i = 0; i < 10; ++i) trigger("redo");
    QCOMPARE(motion.text(), made);

    QVERIFY(motion.save_as(file));
    QVERIFY(!motion.modified());
    std::string saved = made;  // but for the name, which follows the file
    const std::string name = "name: untitled";
    saved.replace(saved.find(name), name.size(), "name: wave_both");
    QCOMPARE(motion.text(), saved);
    window_->open(file);
    QCOMPARE(motion.text(), saved);
    QSignalSpy opened(&window_->run(), &RunController::opened);
    trigger("play_physics");
    QVERIFY(opened.wait(kPatience_ms));
    QVERIFY2(window_->messages().text().isEmpty(), qPrintable(window_->messages().text()));
    window_->run().set_playing(false);
    run_to(8'000'000);
    QVERIFY(window_->run().status().state != SessionStatus::State::kFailed);
    bool played = false;
    for (const view::Event& event : window_->run().recording().events) {
      played = played || event.text.find("wave_both") != std::string::npos ||
               event.text.find("untitled") != std::string::npos;
      QVERIFY2(event.text.find("fall") == std::string::npos, event.text.c_str());
    }
    QVERIFY(played);
    picture("played");
  }
};

}  // namespace koboshi::studio

int main(int argc, char** argv) {
  return koboshi::studio::test::run_window_test<koboshi::studio::MotionWindowTest>(argc, argv);
}

#include "motion_window_test.moc"
