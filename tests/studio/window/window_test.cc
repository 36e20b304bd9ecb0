#include <QAbstractItemView>
#include <QAbstractScrollArea>
#include <QAction>
#include <QApplication>
#include <QComboBox>
#include <QCompleter>
#include <QDir>
#include <QDockWidget>
#include <QDoubleSpinBox>
#include <QDragEnterEvent>
#include <QDropEvent>
#include <QElapsedTimer>
#include <QLabel>
#include <QLineEdit>
#include <QMenuBar>
#include <QMimeData>
#include <QPushButton>
#include <QRegularExpression>
#include <QSettings>
#include <QSignalSpy>
#include <QSlider>
#include <QSpinBox>
#include <QStatusBar>
#include <QSurfaceFormat>
#include <QTableView>
#include <QTemporaryDir>
#include <QTest>
#include <QUrl>
#include <algorithm>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>

#include "sim_board/scenario/reader.h"
#include "tests/studio/window/view_fixture.h"
#include "tests/support/sample_recording.h"
#include "tools/studio/motion/joint_panel.h"
#include "tools/studio/motion/motion_panel.h"
#include "tools/studio/motion/step_model.h"
#include "tools/studio/plot/plot_panel.h"
#include "tools/studio/window/can_panel.h"
#include "tools/studio/window/command_search.h"
#include "tools/studio/window/main_window.h"
#include "tools/studio/window/message_bar.h"
#include "tools/studio/window/node_table.h"
#include "tools/studio/window/object_panel.h"
#include "tools/studio/window/scenario_settings.h"
#include "tools/studio/window/theme.h"
#include "tools/studio/window/transport_bar.h"
#include "tools/view/recording/recording_file.h"
#include "tools/view/render/camera.h"

namespace koboshi::studio {

using test::kPatience_ms;
using test::kRoot;

class WindowTest final : public ViewFixture {
  Q_OBJECT

 private Q_SLOTS:
  void init() { show_window(); }
  void cleanup() { window_.reset(); }

  void draws_the_robot() {
    open(kRoot / "scenarios/walk.yaml");
    QTRY_VERIFY_WITH_TIMEOUT(window_->view().frames() > 0, kPatience_ms);
    QVERIFY2(window_->view().error().isEmpty(), qPrintable(window_->view().error()));
    QTRY_VERIFY(trunk_place());  // the trunk is in the picture
    const QImage picture = window_->view().grabFramebuffer();
    const QPoint trunk = *trunk_place();
    const double ratio = window_->devicePixelRatioF();
    const QColor there = picture.pixelColor((QPointF(trunk) * ratio).toPoint());
    const QColor sky = picture.pixelColor(5, 5);
    QVERIFY2(there != sky, "the picture is empty where the trunk should be");
  }

  void space_starts_and_pauses() {
    open(kRoot / "scenarios/walk.yaml");
    QTest::keyClick(window_.get(), Qt::Key_Space);
    QTRY_VERIFY_WITH_TIMEOUT(window_->run().end_us() > 300'000, kPatience_ms);
    QVERIFY(window_->run().playing());
    QTest::keyClick(window_.get(), Qt::Key_Space);
    QTRY_VERIFY_WITH_TIMEOUT(!window_->run().playing(), kPatience_ms);
    QTRY_COMPARE(window_->run().cursor_us(), window_->run().end_us());
  }

  void pushes_with_the_mouse_and_rewinds() {
    open(kRoot / "scenarios/walk.yaml");
    run_to(3'300'000);
    QTRY_VERIFY(trunk_place());
    const QPoint start = *trunk_place();
    RobotView& view = window_->view();
    QTest::mousePress(&view, Qt::LeftButton, Qt::ControlModifier, start);
    for (int i = 1; i <= 10; ++i) {
      QMouseEvent move(QEvent::MouseMove, QPointF(start + QPoint(12 * i, 0)),
                       view.mapToGlobal(QPointF(start + QPoint(12 * i, 0))), Qt::NoButton, Qt::LeftButton,
                       Qt::ControlModifier);
      QApplication::sendEvent(&view, &move);
    }
    QTest::mouseRelease(&view, Qt::LeftButton, Qt::ControlModifier, start + QPoint(120, 0));
    run_to(4'000'000);
    QTRY_COMPARE(window_->run().recording().pushes.size(), std::size_t{1});
    const std::uint64_t pushed = window_->run().session()->state_hash();

    // Back with the slider and a key: the push is gone.
    auto* slider = window_->findChild<TransportBar*>()->findChild<QSlider*>();
    slider->setValue(330);
    QCOMPARE(window_->run().cursor_us(), std::uint64_t{3'300'000});
    QTest::keyClick(window_.get(), Qt::Key_Backspace);
    QTRY_COMPARE_WITH_TIMEOUT(window_->run().end_us(), std::uint64_t{3'300'000}, kPatience_ms);
    QVERIFY(window_->run().recording().pushes.empty());
    run_to(4'000'000);
    QVERIFY(window_->run().session()->state_hash() != pushed);
  }

  void scrubbing_shows_the_past_in_every_panel() {
    open(kRoot / "scenarios/walk.yaml");
    run_to(3'200'000);
    auto* slider = window_->findChild<TransportBar*>()->findChild<QSlider*>();
    QSignalSpy moved(&window_->run(), &RunController::cursor_moved);
    slider->setValue(100);
    QCOMPARE(moved.count(), 1);
    QCOMPARE(window_->run().cursor_us(), std::uint64_t{1'000'000});
    auto* frames = window_->findChild<QTableView*>(QStringLiteral("frames"));
    const QString time = frames->currentIndex().siblingAtColumn(FrameModel::kTime).data().toString();
    QVERIFY2(time.toDouble() <= 1.0 && time.toDouble() > 0.9, qPrintable(time));
  }

  void filters_frames() {
    open(kRoot / "scenarios/walk.yaml");
    run_to(2'500'000);
    auto* panel = window_->findChild<CanPanel*>();
    auto* table = panel->findChild<QTableView*>(QStringLiteral("frames"));
    panel->update_frames();
    const int all = table->model()->rowCount();
    QVERIFY(all > 1000);
    QTest::keyClicks(panel->findChild<QLineEdit*>(), QStringLiteral("heartbeat"));
    const int heartbeats = table->model()->rowCount();
    QVERIFY(heartbeats > 0 && heartbeats < all / 4);
    for (int row = 0; row < heartbeats; row += 7)
      QVERIFY(
          table->model()->index(row, FrameModel::kIdentifier).data().toString().startsWith(QLatin1Char('7')));
    panel->findChild<QLineEdit*>()->clear();
    QCOMPARE(table->model()->rowCount(), all);
  }

  void shows_frames_axes_and_links_apart() {
    open(kRoot / "scenarios/walk.yaml");
    run_to(1'000'000);
    RobotView& view = window_->view();
    const auto picture = [&] {
      const std::uint64_t before = view.frames();
      view.update();
      if (!QTest::qWaitFor([&] { return view.frames() > before; }, kPatience_ms)) return QImage();
      QTest::qWait(250);  // until it is drawn in full
      return view.grabFramebuffer();
    };
    const QImage plain = picture();
    QVERIFY(!plain.isNull());
    for (const auto key : {Qt::Key_5, Qt::Key_6, Qt::Key_7}) {
      QTest::keyClick(window_.get(), key, Qt::ControlModifier);
      QVERIFY2(picture() != plain, qPrintable(QKeySequence(key).toString()));
      if (const QString folder = qEnvironmentVariable("KOBOSHI_PICTURES"); !folder.isEmpty())
        window_->grab().save(folder + QStringLiteral("/view-%1.png").arg(QKeySequence(key).toString()));
      QTest::keyClick(window_.get(), key, Qt::ControlModifier);
      QCOMPARE(picture(), plain);
    }
  }

  void reads_and_writes_objects() {
    open(kRoot / "scenarios/walk.yaml");
    run_to(2'000'000);
    auto* panel = window_->findChild<ObjectPanel*>();
    qobject_cast<QDockWidget*>(panel->parentWidget())->raise();
    auto* node = panel->findChild<QComboBox*>();
    node->setCurrentIndex(node->findText(QStringLiteral("left_knee"), Qt::MatchContains));
    auto* table = panel->findChild<QTableView*>();
    panel->findChild<QLineEdit*>()->setText(QStringLiteral("6081"));
    QCOMPARE(table->model()->rowCount(), 1);
    const QModelIndex value = table->model()->index(0, ObjectModel::kValue);
    window_->run().set_playing(true);
    QTest::mouseClick(panel->findChild<QPushButton*>(QStringLiteral("read_objects")), Qt::LeftButton);
    QTRY_VERIFY_WITH_TIMEOUT(!value.data().toString().isEmpty(), kPatience_ms);
    QVERIFY(value.data().toString() != QStringLiteral("4321"));
    // An edit as a user makes it.
    table->scrollTo(value);
    QTest::mouseClick(table->viewport(), Qt::LeftButton, {}, table->visualRect(value).center());
    QTest::keyClick(table->viewport(), Qt::Key_F2);
    auto* editor = table->findChild<QLineEdit*>();
    QVERIFY(editor != nullptr);
    editor->selectAll();
    QTest::keyClicks(editor, QStringLiteral("4321"));
    QTest::keyClick(editor, Qt::Key_Return);
    QTRY_COMPARE_WITH_TIMEOUT(value.data().toString(), QStringLiteral("4321"), kPatience_ms);
    // A value that the object cannot have.
    QVERIFY(!table->model()->setData(value, QStringLiteral("fast")));
    QVERIFY(std::ranges::any_of(panel->findChildren<QLabel*>(), [](const QLabel* label) {
      return label->text().contains(QStringLiteral("UNSIGNED32"));
    }));
  }

  void causes_a_fault_and_shows_it_on_the_bus() {
    open(kRoot / "scenarios/walk.yaml");
    run_to(2'000'000);
    window_->findChild<QComboBox*>(QStringLiteral("fault_kind"))
        ->setCurrentText(QStringLiteral("drive_power_loss"));
    window_->findChild<QComboBox*>(QStringLiteral("fault_target"))
        ->setCurrentText(QStringLiteral("left_knee"));
    QTest::mouseClick(window_->findChild<QPushButton*>(QStringLiteral("cause_fault")), Qt::LeftButton);
    run_to(2'500'000);
    auto* nodes = window_->findChild<NodeModel*>();
    const auto state = [&](const QString& node) {
      for (int row = 0; row < nodes->rowCount(); ++row)
        if (nodes->index(row, NodeModel::kNode).data().toString().endsWith(node))
          return nodes->index(row, NodeModel::kState).data().toString();
      return QString();
    };
    QTRY_COMPARE(state(QStringLiteral("left_knee")), QStringLiteral("no power"));
    QCOMPARE(state(QStringLiteral("right_knee")), QStringLiteral("error-active"));
    QVERIFY(std::ranges::any_of(window_->findChild<CanPanel*>()->findChildren<QLabel*>(), [](auto* label) {
      return QRegularExpression(QStringLiteral("bus load [1-9]")).match(label->text()).hasMatch();
    }));
    const auto& events = window_->run().recording().events;
    QVERIFY(std::ranges::any_of(
        events, [](const view::Event& event) { return event.text.find("left_knee") != std::string::npos; }));
    // Details that no scenario could contain.
    window_->findChild<QLineEdit*>(QStringLiteral("fault_details"))->setText(QStringLiteral("shrae: 0.1"));
    QTest::mouseClick(window_->findChild<QPushButton*>(QStringLiteral("cause_fault")), Qt::LeftButton);
    QVERIFY(window_->messages().isVisible());
  }

  void restarts_with_another_seed() {
    open(kRoot / "scenarios/walk.yaml");
    window_->findChild<QSpinBox*>()->setValue(7);
    QSignalSpy opened(&window_->run(), &RunController::opened);
    QTest::mouseClick(window_->findChild<QPushButton*>(QStringLiteral("restart")), Qt::LeftButton);
    QVERIFY(opened.wait(kPatience_ms));
    QCOMPARE(window_->run().session()->scenario().seed, std::uint64_t{7});
    QTRY_COMPARE(window_->run().end_us(), std::uint64_t{10'000});
  }

  // Every ground of the panel starts; slope and pieces stay for the next start, and go with another file.
  void starts_again_on_another_ground() {
    open(kRoot / "scenarios/go.yaml");
    auto* terrain = window_->findChild<QComboBox*>(QStringLiteral("terrain"));
    auto* roll = window_->findChild<QDoubleSpinBox*>(QStringLiteral("ground_roll"));
    const auto restart = [&] {
      QSignalSpy opened(&window_->run(), &RunController::opened);
      QTest::mouseClick(window_->findChild<QPushButton*>(QStringLiteral("restart")), Qt::LeftButton);
      return opened.wait(kPatience_ms);
    };
    const auto ground = [&]() -> const sim::Ground& { return window_->run().session()->scenario().ground; };
    for (int i = 1; i < terrain->count(); ++i) {
      terrain->setCurrentIndex(i);
      const auto overrides = window_->findChild<ScenarioSettings*>()->overrides();
      // Throws for a ground that a scenario cannot have. Only the plane has no pieces.
      QCOMPARE(sim::read_scenario(kRoot / "scenarios/go.yaml", overrides).ground.shapes.empty(), i == 1);
    }
    roll->setValue(2.5);
    QVERIFY(restart());
    QVERIFY(std::abs(ground().roll_rad - 2.5 * 0.0174533) < 1e-5);
    QVERIFY(restart());
    QVERIFY(std::abs(ground().roll_rad - 2.5 * 0.0174533) < 1e-5);
    QCOMPARE(ground().shapes.size(), std::size_t{1});
    run_to(100'000);
    open(kRoot / "scenarios/walk.yaml");
    QCOMPARE(terrain->currentIndex(), 0);
    QCOMPARE(roll->value(), 0.0);
  }

  // A recording on the disk: the window shows it before its blocks are read, and any moment of it.
  void opens_a_long_recording() {
    QTemporaryDir folder;
    const std::filesystem::path file = std::filesystem::path(folder.path().toStdString()) / "run.mcap";
    const view::Recording whole = koboshi::test::sample_recording(12'000);  // two minutes
    view::write_recording(file, whole);
    open(file);
    RunController& run = window_->run();
    QVERIFY(run.is_windowed());
    QCOMPARE(run.end_us(), whole.samples.back().time_us);
    QVERIFY(run.recording().samples.size() < 300);
    auto* plots = window_->findChild<PlotPanel*>();
    QTRY_COMPARE_WITH_TIMEOUT(plots->samples().times()->size(), whole.samples.size(), kPatience_ms);
    QCOMPARE(run.recording().events.size(), whole.events.size());
    auto* frames = window_->findChild<QTableView*>(QStringLiteral("frames"));
    for (const std::uint64_t time_us : {60'000'000u, 119'990'000u, 10'000u, 90'123'000u}) {
      run.set_cursor(time_us);
      const auto& samples = run.recording().samples;
      QVERIFY(samples.front().time_us <= time_us && samples.back().time_us + 10'000 > time_us);
      QVERIFY(run.recording().samples.size() <= 100 * RecordingWindow::kMaxBlocks + 100);
      const double shown_s =
          frames->currentIndex().siblingAtColumn(FrameModel::kTime).data().toString().toDouble();
      QVERIFY2(std::abs(shown_s - 1e-6 * static_cast<double>(time_us)) < 0.011,
               qPrintable(QString::number(shown_s)));
    }
    run.set_cursor(30'000'000);
    run.set_speed(2.0);
    run.set_playing(true);
    QTRY_VERIFY_WITH_TIMEOUT(run.cursor_us() > 32'000'000, kPatience_ms);
    run.set_playing(false);
  }

  void bad_files_end_in_the_message_bar() {
    QTemporaryDir folder;
    const QString file = folder.filePath(QStringLiteral("bad.yaml"));
    QFile bad(file);
    QVERIFY(bad.open(QIODevice::WriteOnly));
    bad.write("version: 1\nrobot: nowhere.sdf\nduration_s: 1\n");
    bad.close();
    QSignalSpy failed(&window_->run(), &RunController::failed);
    window_->open(file.toStdString());
    QVERIFY(failed.wait(kPatience_ms));
    QVERIFY2(window_->messages().text().contains(QStringLiteral("nowhere.sdf")),
             qPrintable(window_->messages().text()));
    QVERIFY(QApplication::activeModalWidget() == nullptr);
    window_->open(folder.path().toStdString() + "/none.yaml");
    QVERIFY(window_->messages().text().contains(QStringLiteral("none.yaml")));
  }

  void opens_dropped_files() {
    QMimeData files;
    files.setUrls({QUrl::fromLocalFile(QString::fromStdString((kRoot / "scenarios/squat.yaml").string()))});
    QSignalSpy opened(&window_->run(), &RunController::opened);
    QDragEnterEvent enter(QPoint(400, 300), Qt::CopyAction, &files, Qt::LeftButton, Qt::NoModifier);
    QApplication::sendEvent(window_.get(), &enter);
    QVERIFY(enter.isAccepted());
    QDropEvent drop(QPointF(400, 300), Qt::CopyAction, &files, Qt::LeftButton, Qt::NoModifier);
    QApplication::sendEvent(window_.get(), &drop);
    QVERIFY(opened.wait(kPatience_ms));
    QVERIFY(window_->windowTitle().contains(QStringLiteral("squat.yaml")));
  }

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
    window_->open(file);
    QCOMPARE(motion.text(), made);
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

  void asks_before_changes_are_lost() {
    action("New motion")->trigger();
    window_->motion().findChild<QAction*>(QStringLiteral("insert_pose"))->trigger();
    QVERIFY(window_->motion().modified());
    QVERIFY(!window_->close());
    QVERIFY(window_->messages().text().contains(QStringLiteral("not saved")));
    QVERIFY(window_->close());
  }

  void finds_and_triggers_commands() {
    auto* search = window_->findChild<CommandSearch*>();
    QTest::keyClick(window_.get(), Qt::Key_K, Qt::ControlModifier);
    QTRY_VERIFY(search->hasFocus());
    QAction* collisions = action("Collision shapes");
    QVERIFY(collisions != nullptr && !collisions->isChecked());
    QTest::keyClicks(search, QStringLiteral("collision"));
    QTest::keyClick(search->completer()->popup(), Qt::Key_Down);
    QTest::keyClick(search->completer()->popup(), Qt::Key_Return);
    QTRY_VERIFY(collisions->isChecked());
    QVERIFY(search->text().isEmpty());
  }

  void remembers_its_layout() {
    auto* dock = window_->findChild<QDockWidget*>(QStringLiteral("operator"));
    QVERIFY(dock->isVisible());
    dock->hide();
    window_->close();
    window_ = std::make_unique<MainWindow>(kRoot / "robots/koboshi/robot.sdf");
    window_->show();
    QVERIFY(QTest::qWaitForWindowExposed(window_.get()));
    QVERIFY(!window_->findChild<QDockWidget*>(QStringLiteral("operator"))->isVisible());
    action("Default layout")->trigger();
    QVERIFY(window_->findChild<QDockWidget*>(QStringLiteral("operator"))->isVisible());
  }

  // For eyes: KOBOSHI_PICTURES names a folder for pictures of the window.
  void pictures() {
    const QString folder = qEnvironmentVariable("KOBOSHI_PICTURES");
    if (folder.isEmpty()) return;
    open(kRoot / "scenarios/walk.yaml");
    window_->open(kRoot / "robots/koboshi/motions/squat.yaml");
    run_to(6'500'000);
    auto* objects = window_->findChild<ObjectPanel*>();
    objects->findChild<QComboBox*>()->setCurrentIndex(4);
    objects->findChild<QLineEdit*>()->setText(QStringLiteral("60"));
    objects->findChild<QPushButton*>(QStringLiteral("read_objects"))->click();
    run_to(7'500'000);
    for (const char* name : {"events", "can", "objects", "motion"}) {
      window_->findChild<QDockWidget*>(QLatin1String(name))->raise();
      QTest::qWait(800);
      window_->grab().save(folder + QStringLiteral("/studio-") + QLatin1String(name) +
                           QStringLiteral(".png"));
    }
    apply_theme(Theme::kDark);
    QTest::qWait(500);
    window_->grab().save(folder + QStringLiteral("/studio-dark.png"));
    apply_theme(Theme::kLight);
  }

  // Times of a long recording in the window: printed, since machines differ. KOBOSHI_RECORDING names one,
  // which `recording_bench repeat` makes.
  void long_recording() {
    const QString file = qEnvironmentVariable("KOBOSHI_RECORDING");
    if (file.isEmpty()) return;
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

  // Frames per second of the view: printed, since machines differ. KOBOSHI_BENCH runs it.
  void frame_rate() {
    if (qEnvironmentVariableIsEmpty("KOBOSHI_BENCH")) return;
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
  return koboshi::studio::test::run_window_test<koboshi::studio::WindowTest>(argc, argv);
}

#include "window_test.moc"
