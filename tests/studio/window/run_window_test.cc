// Runs in the window: play, rewind, push, faults, grounds and recordings, and what its panels show of them.

#include <QApplication>
#include <QComboBox>
#include <QDockWidget>
#include <QDoubleSpinBox>
#include <QLabel>
#include <QLineEdit>
#include <QPushButton>
#include <QRegularExpression>
#include <QSignalSpy>
#include <QSlider>
#include <QSpinBox>
#include <QTableView>
#include <QTemporaryDir>
#include <QTest>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>

#include "base/text/text.h"
#include "simulation/scenario/reader.h"
#include "studio/controls/scenario_settings.h"
#include "studio/controls/transport_bar.h"
#include "studio/model/robot_copy.h"
#include "studio/panels/can_panel.h"
#include "studio/panels/event_panel.h"
#include "studio/panels/node_table.h"
#include "studio/panels/object_panel.h"
#include "studio/plot/plot_panel.h"
#include "studio/tuning/parameter_panel.h"
#include "studio/widgets/message_bar.h"
#include "tests/studio/window/view_fixture.h"
#include "tests/support/sample_recording.h"
#include "view/recording/recording_file.h"
#include "view/render/looks.h"

namespace koboshi::studio {

using test::kPatience_ms;
using test::kRoot;

class RunWindowTest final : public ViewFixture {
  Q_OBJECT

 private Q_SLOTS:
  void init() { show_window(); }
  void cleanup() { window_.reset(); }

  void draws_the_robot() {
    open_scenario("walk.yaml");
    QTRY_VERIFY_WITH_TIMEOUT(window_->view().frames() > 0, kPatience_ms);
    QVERIFY2(window_->view().error().isEmpty(), qPrintable(window_->view().error()));
    QTRY_VERIFY(trunk_place());  // the trunk is in the picture
    const QImage picture = window_->view().grab().toImage();
    const QPoint trunk = *trunk_place();
    const double ratio = window_->devicePixelRatioF();
    const QColor there = picture.pixelColor((QPointF(trunk) * ratio).toPoint());
    const QColor sky = picture.pixelColor(5, 5);
    QVERIFY2(there != sky, "the picture is empty where the trunk should be");
  }

  void space_starts_and_pauses() {
    open_scenario("walk.yaml");
    QTest::keyClick(window_.get(), Qt::Key_Space);
    QTRY_VERIFY_WITH_TIMEOUT(window_->run().end_us() > 300'000, kPatience_ms);
    QVERIFY(window_->run().playing());
    QTest::keyClick(window_.get(), Qt::Key_Space);
    QTRY_VERIFY_WITH_TIMEOUT(!window_->run().playing(), kPatience_ms);
    QTRY_COMPARE(window_->run().cursor_us(), window_->run().end_us());
  }

  void pushes_with_the_mouse_and_rewinds() {
    open_scenario("walk.yaml");
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
    // No table keeps the future.
    const auto last_s = [](const QTableView* table, int column) {
      const int rows = table->model()->rowCount();
      return rows > 0 ? table->model()->index(rows - 1, column).data().toString().toDouble() : -1.0;
    };
    auto* events = window_->findChild<EventPanel*>();
    QVERIFY(last_s(events, 0) > 0.0);
    QVERIFY2(last_s(events, 0) <= 3.3, qPrintable(QString::number(last_s(events, 0))));
    const auto* frames = window_->findChild<QTableView*>(QStringLiteral("frames"));
    QVERIFY2(last_s(frames, FrameModel::kTime) <= 3.31,
             qPrintable(QString::number(last_s(frames, FrameModel::kTime))));
    const SampleTimes& times = *window_->findChild<PlotPanel*>()->samples().times();
    QCOMPARE(times[times.size() - 1], std::uint64_t{3'300'000});
    run_to(4'000'000);
    QVERIFY(window_->run().session()->state_hash() != pushed);
  }

  void scrubbing_shows_the_past_in_every_panel() {
    open_scenario("walk.yaml");
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

  void a_click_on_the_time_slider_jumps_there() {
    open_scenario("walk.yaml");
    run_to(3'000'000);
    auto* slider = window_->findChild<TransportBar*>()->findChild<QSlider*>();
    for (const double share : {0.75, 0.25, 0.5}) {
      QTest::mouseClick(slider, Qt::LeftButton, {},
                        {static_cast<int>(share * slider->width()), slider->height() / 2});
      const double cursor_s = 1e-6 * static_cast<double>(window_->run().cursor_us());
      QVERIFY2(std::abs(cursor_s - 3.0 * share) < 0.06, qPrintable(QString::number(cursor_s)));
    }
  }

  void a_scenario_starts_with_the_robot_of_the_command_line() {
    QTemporaryDir folder;
    RobotCopies copies(kRoot / "robots/koboshi/robot.sdf", folder.path().toStdString());
    const std::filesystem::path other =
        copies.write(read_text_file(kRoot / "robots/koboshi/robot.sdf", "a robot"));
    window_ = test::make_window(other);
    QVERIFY(window_);
    window_->use_robot_in_scenarios();
    open(kRoot / "scenarios/walk.yaml");
    QCOMPARE(window_->run().session()->scenario().robot, other);
    QSignalSpy opened(&window_->run(), &RunController::opened);
    QVERIFY(test::click(*window_, "restart"));
    QVERIFY(opened.wait(kPatience_ms));
    QCOMPARE(window_->run().session()->scenario().robot, other);
  }

  // Parameters of this robot that are being edited stay, so that nobody is asked about them; a question would
  // wait for an answer.
  void a_scenario_keeps_changed_parameters_of_the_robot_of_the_command_line() {
    QTemporaryDir folder;
    RobotCopies copies(kRoot / "robots/koboshi/robot.sdf", folder.path().toStdString());
    const std::filesystem::path other =
        copies.write(read_text_file(kRoot / "robots/koboshi/robot.sdf", "a robot"));
    const std::filesystem::path parameters = other.parent_path() / "parameters.yaml";
    std::filesystem::remove(parameters);  // a link to the robot's own file
    std::filesystem::copy_file(kRoot / "robots/koboshi/parameters.yaml", parameters);
    window_ = test::make_window(other);
    QVERIFY(window_);
    window_->use_robot_in_scenarios();
    ParameterEditor& editor = window_->findChild<ParameterPanel*>()->editor();
    editor.show(ParameterEditor::kRobot);
    const double value = *editor.document()->value(0);
    QVERIFY(editor.set(0, value * 1.01) || editor.set(0, value * 0.9));
    QVERIFY(editor.is_modified());
    open(kRoot / "scenarios/walk.yaml");
    QCOMPARE(window_->run().session()->scenario().robot, other);
    QVERIFY(editor.is_modified());
  }

  // As in the replay page (view/render/looks.h).
  void keys_are_those_of_the_replay_page() {
    open_scenario("walk.yaml");
    for (const view::NamedView& named : view::kNamedViews) {
      QTest::keyClick(window_.get(), named.key);
      const view::Camera& camera = window_->view().picture().camera();
      QVERIFY(std::abs(camera.azimuth_rad - named.azimuth_deg / 57.29578) < 1e-3);
      QVERIFY(std::abs(camera.elevation_rad - named.elevation_deg / 57.29578) < 1e-3);
    }
    const std::pair<std::string_view, const char*> texts[] = {{"play", "Start"},
                                                              {"tick", "Advance one control tick (10 ms)"},
                                                              {"tick_back", "Back one control tick (10 ms)"},
                                                              {"begin", "To the beginning"},
                                                              {"end", "To the end"},
                                                              {"look", "Look at the robot"},
                                                              {"follow", "Follow the robot"}};
    QCOMPARE(std::size(texts), view::kSharedKeys.size());
    for (const auto& [name, text] : texts) {
      const auto shared = std::ranges::find(view::kSharedKeys, name, &view::SharedKey::action);
      QVERIFY(shared != view::kSharedKeys.end());
      const QString key = QString::fromUtf8(shared->key.data(), static_cast<qsizetype>(shared->key.size()));
      const bool is_upper = key.size() == 1 && key.front().isUpper();
      const QAction* found = action(text);
      QVERIFY2(found != nullptr, text);
      const QKeySequence wanted(key == QStringLiteral(" ") ? QStringLiteral("Space")
                                : is_upper                 ? QStringLiteral("Shift+") + key
                                                           : key);
      QVERIFY2(found->shortcuts().contains(wanted), text);
    }
  }

  void filters_frames_and_shows_the_load() {
    open_scenario("walk.yaml");
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
    // The load follows from the frames where the nodes are unknown, as on a real bus.
    const auto load_in = [](const CanPanel& shown, const QString& behind) {
      static const QRegularExpression load(QStringLiteral("bus load (\\d+) %"));
      for (const QLabel* label : shown.findChildren<QLabel*>())
        if (const auto match = load.match(label->text());
            match.hasMatch() && label->text().mid(match.capturedEnd()).startsWith(behind))
          return match.captured(1).toInt();
      return -1;
    };
    CanPanel of_frames;
    of_frames.set_recording(&window_->run().recording(), {});
    of_frames.set_cursor(2'500'000);
    const int simulated = load_in(*panel, QString());
    QVERIFY2(simulated > 20 && simulated < 90, qPrintable(QString::number(simulated)));
    QVERIFY(std::abs(load_in(of_frames, QStringLiteral(" at 1 Mbit/s")) - simulated) <= 1);
    of_frames.set_cursor(0);
    QCOMPARE(load_in(of_frames, QStringLiteral(" at 1 Mbit/s")), 0);
  }

  void shows_frames_axes_and_links_apart() {
    open_scenario("walk.yaml");
    run_to(1'000'000);
    RobotView& view = window_->view();
    QTest::qWait(250);  // until the robot rests, and every picture is in full resolution
    const auto picture = [&] {
      const std::uint64_t before = view.frames();
      view.update();
      const bool is_drawn = QTest::qWaitFor([&] { return view.frames() > before; }, kPatience_ms);
      return is_drawn ? view.grab().toImage() : QImage();
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
    open_scenario("walk.yaml");
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
    open_scenario("walk.yaml");
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
    open_scenario("walk.yaml");
    window_->findChild<QSpinBox*>()->setValue(7);
    QSignalSpy opened(&window_->run(), &RunController::opened);
    QTest::mouseClick(window_->findChild<QPushButton*>(QStringLiteral("restart")), Qt::LeftButton);
    QVERIFY(opened.wait(kPatience_ms));
    QCOMPARE(window_->run().session()->scenario().seed, std::uint64_t{7});
    QTRY_COMPARE(window_->run().end_us(), std::uint64_t{10'000});
  }

  // Every ground of the panel starts; slope and pieces stay for the next start, and go with another file.
  void starts_again_on_another_ground() {
    open_scenario("go.yaml");
    auto* terrain = window_->findChild<QComboBox*>(QStringLiteral("terrain"));
    auto* roll = window_->findChild<QDoubleSpinBox*>(QStringLiteral("ground_roll"));
    const auto restart = [&] {
      QSignalSpy opened(&window_->run(), &RunController::opened);
      QTest::mouseClick(window_->findChild<QPushButton*>(QStringLiteral("restart")), Qt::LeftButton);
      return opened.wait(kPatience_ms);
    };
    const auto ground = [&]() -> const simulation::Ground& {
      return window_->run().session()->scenario().ground;
    };
    for (int i = 1; i < terrain->count(); ++i) {
      terrain->setCurrentIndex(i);
      const auto overrides = window_->findChild<ScenarioSettings*>()->overrides();
      // Throws for a ground that a scenario cannot have. Only the plane has no pieces.
      QCOMPARE(simulation::read_scenario(kRoot / "scenarios/go.yaml", overrides).ground.shapes.empty(),
               i == 1);
    }
    roll->setValue(2.5);
    QVERIFY(restart());
    QVERIFY(std::abs(ground().roll_rad - 2.5 * 0.0174533) < 1e-5);
    QVERIFY(restart());
    QVERIFY(std::abs(ground().roll_rad - 2.5 * 0.0174533) < 1e-5);
    QCOMPARE(ground().shapes.size(), std::size_t{1});
    run_to(100'000);
    open_scenario("walk.yaml");
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
};

}  // namespace koboshi::studio

int main(int argc, char** argv) {
  return koboshi::studio::test::run_window_test<koboshi::studio::RunWindowTest>(argc, argv);
}

#include "run_window_test.moc"
