// The studio on a bus: robots of other processes, commands to them, and the gamepad.

#include <QComboBox>
#include <QDoubleSpinBox>
#include <QLabel>
#include <QLineEdit>
#include <QProcess>
#include <QTableView>
#include <QTemporaryDir>
#include <QTimer>
#include <algorithm>
#include <atomic>
#include <cmath>
#include <optional>
#include <vector>

#include "sim_board/can/transport/transport.h"
#include "studio/controls/operator_commands.h"
#include "studio/motion_editor/motion_panel.h"
#include "studio/panels/can_panel.h"
#include "studio/panels/object_panel.h"
#include "studio/widgets/message_bar.h"
#include "tests/studio/window/window_fixture.h"

namespace koboshi::studio {

using test::kPatience_ms;
using test::kRoot;

// A gamepad whose state the test sets.
class FakeGamepads final : public Gamepads {
 public:
  explicit FakeGamepads(const std::optional<GamepadState>& state) : state_(state) {}
  std::optional<GamepadState> read() override { return state_; }
  std::string name() const override { return "fake pad"; }

 private:
  const std::optional<GamepadState>& state_;
};

// A controller that stands, and aborts or ignores every access to an object.
class PlainController final : public QObject {
 public:
  PlainController(const std::string& bus, bool answers)
      : transport_(sim_board::open_transport(bus)), answers_(answers) {
    connect(&timer_, &QTimer::timeout, this, &PlainController::exchange);
    timer_.start(10);
  }

 private:
  void exchange() {
    constexpr auto kStanding = static_cast<std::uint8_t>(behaviour::State::kStanding);
    send({.identifier = 0x181, .size = 8, .data = {kStanding}});
    while (const auto frame = transport_->receive()) {
      if (frame->identifier != 0x601 || !answers_) continue;
      const auto& asked = frame->data;
      send({.identifier = 0x581,
            .size = 8,
            .data = {0x80, asked[1], asked[2], asked[3], 0x11, 0x00, 0x09, 0x06}});  // no such sub-index
    }
    transport_->flush();
  }
  void send(const hal::CanFrame& frame) { static_cast<void>(transport_->send(frame, 0)); }

  const std::unique_ptr<sim_board::Transport> transport_;
  const bool answers_;
  QTimer timer_;
};

class BusTest final : public QObject {
  Q_OBJECT

 private:
  std::unique_ptr<MainWindow> window_;
  std::unique_ptr<QProcess> robot_;
  QTemporaryDir out_;
  int robots_ = 0;

  // A multicast group that no other test uses.
  QString bus() const {
    return QStringLiteral("udp:239.74.163.9:%1")
        .arg(20'000 + (QCoreApplication::applicationPid() + 7 * robots_) % 20'000);
  }
  bool start_robot(const QStringList& arguments) {
    robot_ = std::make_unique<QProcess>();
    robot_->setProcessChannelMode(QProcess::MergedChannels);
    robot_->setWorkingDirectory(QString::fromStdString(kRoot.string()));
    robot_->start(QCoreApplication::applicationDirPath() + QStringLiteral("/koboshi"),
                  arguments + QStringList{QStringLiteral("--can"), bus()});
    return robot_->waitForStarted(kPatience_ms);
  }
  bool attach_window() {
    QSignalSpy opened(&window_->run(), &RunController::opened);
    window_->attach(bus().toStdString());
    return opened.wait(kPatience_ms) && window_->run().source() == RunController::Source::kBus;
  }
  // Starts a robot in another process and attaches the window to its bus.
  bool attach(const QStringList& arguments) {
    ++robots_;
    return start_robot(arguments) && attach_window();
  }
  // Arguments of a run of a robot that hangs on its stand and awaits commands. It runs three times as fast as
  // real time.
  QStringList run_arguments() const {
    QStringList arguments{QStringLiteral("run"),     QStringLiteral("scenarios/go.yaml"),
                          QStringLiteral("--speed"), QStringLiteral("3"),
                          QStringLiteral("--out"),   out_.filePath(QString::number(robots_))};
    for (const char* one : {"commands=[]", "duration_s=400", "initial.held_until_s=399"})
      arguments << QStringLiteral("--set") << QLatin1String(one);
    return arguments;
  }
  // The value of a signal now; NaN: none yet.
  float value(const char* name) const {
    const view::Recording& seen = window_->run().recording();
    const auto signal = std::ranges::find(seen.signals, std::string(name), &view::Signal::name);
    if (signal == seen.signals.end() || seen.samples.empty()) return std::nanf("");
    return seen.samples.back().values[static_cast<std::size_t>(signal - seen.signals.begin())];
  }
  bool wait_for_state(behaviour::State state) const {
    const auto wanted = static_cast<float>(state);
    return QTest::qWaitFor([&] { return value(RunController::kBusState) == wanted; }, kPatience_ms);
  }
  // The dialogue with the controller, for the message of a failure.
  QString story() const {
    QStringList lines;
    for (const view::Frame& frame : window_->run().recording().frames) {
      const auto& can = frame.frame;
      if (can.identifier != 0x181 && can.identifier != 0x201 && can.identifier != 0x301) continue;
      QString line = QStringLiteral("%1 %2#")
                         .arg(1e-6 * static_cast<double>(frame.end_us), 0, 'f', 3)
                         .arg(can.identifier, 3, 16);
      for (int i = 0; i < can.size; ++i)
        line += QStringLiteral("%1").arg(can.data[static_cast<std::size_t>(i)], 2, 16, QLatin1Char('0'));
      if (lines.isEmpty() || lines.back().section(u' ', 1) != line.section(u' ', 1)) lines << line;
    }
    return lines.join(u'\n') + u'\n' + QString::fromUtf8(robot_->readAll());
  }
  // Frames with this identifier and first byte so far; -1: any byte.
  int count(std::uint16_t identifier, int first = -1) const {
    return static_cast<int>(
        std::ranges::count_if(window_->run().recording().frames, [&](const view::Frame& frame) {
          return frame.frame.identifier == identifier && (first < 0 || frame.frame.data[0] == first);
        }));
  }

 private Q_SLOTS:
  // All tests share a window, because making one takes longer than most of them.
  void initTestCase() {
    window_ = test::make_window();
    QVERIFY(window_);
  }
  void init() {
    window_->messages().hide();
    window_->activateWindow();
    QVERIFY(QTest::qWaitForWindowActive(window_.get()));
  }
  void cleanupTestCase() { window_.reset(); }
  void cleanup() {
    window_->findChild<OperatorCommands*>()->set_gamepads(nullptr);
    if (robot_) {
      robot_->kill();  // without drawing figures
      robot_->waitForFinished(kPatience_ms);
      robot_.reset();
    }
  }

  void says_which_buses_can_be_followed() {
    for (const char* bus : {"can0", "none", "socketcan:lo"}) {
      window_->messages().hide();
      window_->attach(bus);
      QTRY_VERIFY2_WITH_TIMEOUT(window_->messages().isVisible(), bus, kPatience_ms);
      QCOMPARE(window_->run().source(), RunController::Source::kNone);
    }
  }

  void follows_a_running_simulation() {
    QVERIFY2(attach(run_arguments()), robot_->readAll().constData());
    QVERIFY2(wait_for_state(behaviour::State::kLimp), qPrintable(story()));
    QVERIFY(test::click(*window_, "enable"));  // it bends its knees
    QVERIFY2(QTest::qWaitFor([&] { return value("left_knee_TPDO1.position_actual_value") < -20.0F; },
                             kPatience_ms),
             qPrintable(story()));
    const view::Recording& seen = window_->run().recording();
    QVERIFY(seen.frames.size() > 100);
    QVERIFY(window_->findChild<CanPanel*>()->findChild<FrameModel*>()->rowCount() > 0);
    QTRY_VERIFY_WITH_TIMEOUT(!seen.events.empty(), kPatience_ms);
    // Its objects can be read as those of a simulation in the window.
    auto* panel = window_->findChild<ObjectPanel*>();
    panel->findChild<QLineEdit*>()->setText(QStringLiteral("1005:00"));
    QTest::mouseClick(panel->findChild<QPushButton*>(QStringLiteral("read_objects")), Qt::LeftButton);
    const QModelIndex read = panel->findChild<QTableView*>()->model()->index(0, ObjectModel::kValue);
    QTRY_VERIFY_WITH_TIMEOUT(read.data().toString() == QStringLiteral("0x40000080"), kPatience_ms);
    // Its bus has no error counters that could be shown, and the panel says so.
    QVERIFY(std::ranges::any_of(window_->findChild<CanPanel*>()->findChildren<QLabel*>(), [](auto* label) {
      return label->text().contains(QStringLiteral("error counters"));
    }));
    // A motion goes to it from the editor, and comes back the same. A robot that is starting stores nothing.
    QVERIFY2(wait_for_state(behaviour::State::kStanding), qPrintable(story()));
    window_->open(kRoot / "robots/koboshi/motions/bow.yaml");
    window_->messages().hide();
    test::action(*window_, "Upload the motion to a robot")->trigger();
    QTRY_VERIFY_WITH_TIMEOUT(window_->messages().isVisible(), kPatience_ms);
    QVERIFY2(window_->messages().text().contains(QStringLiteral("read back the same")),
             qPrintable(window_->messages().text()));
    QCOMPARE(window_->messages().kind(), MessageKind::kSuccess);
    // The operator's list has it, and it is chosen.
    auto* motions = window_->findChild<QComboBox*>(QStringLiteral("motions"));
    QTRY_COMPARE_WITH_TIMEOUT(motions->currentText(), QStringLiteral("bow"), kPatience_ms);
    QVERIFY(motions->findText(QStringLiteral("stand")) >= 0);
    // A robot on a bus refuses what only a simulation can do.
    window_->run().give(simulation::Push());
    QVERIFY(window_->messages().isVisible());
  }

  // The operator's controls command a robot of another process, by nothing but frames.
  void commands_a_running_simulation() {
    using State = behaviour::State;
    ++robots_;
    QVERIFY(attach_window());
    auto* walk = window_->findChild<QPushButton*>(QStringLiteral("walk"));
    auto* deadline = window_->findChild<QLabel*>(QStringLiteral("walk_deadline"));
    {  // For a second the controller answers no request; it does not walk, and it is asked again.
      const PlainController silent(bus().toStdString(), false);
      QVERIFY(wait_for_state(State::kStanding));
      QTest::mousePress(walk, Qt::LeftButton);
      QTRY_VERIFY_WITH_TIMEOUT(deadline->text().contains(QStringLiteral("No answer")), kPatience_ms);
      QVERIFY(deadline->isVisible());
      QCOMPARE(count(0x201, 7), 0);
      QTest::mouseRelease(walk, Qt::LeftButton);
    }
    QVERIFY(start_robot(run_arguments()));
    QVERIFY2(wait_for_state(State::kLimp), qPrintable(story()));
    auto* motions = window_->findChild<QComboBox*>(QStringLiteral("motions"));
    QVERIFY2(QTest::qWaitFor([&] { return motions->count() > 0; }, kPatience_ms), qPrintable(story()));
    QCOMPARE(motions->itemText(0), QStringLiteral("stand"));
    // It measures its gyro's bias while it is limp: without it, it refuses to walk. A SYNC comes every 10 ms.
    QTRY_VERIFY_WITH_TIMEOUT(count(0x080) >= 250, kPatience_ms);
    QVERIFY(test::click(*window_, "enable"));
    QVERIFY2(wait_for_state(State::kStanding), qPrintable(story()));
    QTRY_VERIFY_WITH_TIMEOUT(window_->findChild<QLabel*>(QStringLiteral("controller_state"))
                                 ->text()
                                 .contains(QStringLiteral("standing")),
                             kPatience_ms);
    // A walk lasts as long as its button is down, and its velocity is repeated. The robot hangs on its stand.
    QTest::mousePress(walk, Qt::LeftButton);
    QVERIFY2(wait_for_state(State::kWalking), qPrintable(story()));
    QTRY_VERIFY_WITH_TIMEOUT(count(0x301) >= 5, kPatience_ms);
    // The robot would stop by itself, and nothing needs to be said about it.
    QCOMPARE(window_->run().bus()->walk_deadline(), WalkDeadline::State::kWorks);
    QVERIFY(!deadline->isVisible());
    test::save_picture(*window_, "bus-walking");
    // On a machine that pauses this process, the monitor has stopped the robot in between.
    int stops = count(0x201, 4);
    QTest::mouseRelease(walk, Qt::LeftButton);
    QTRY_VERIFY_WITH_TIMEOUT(count(0x201, 4) > stops, kPatience_ms);
    QVERIFY2(wait_for_state(State::kStanding), qPrintable(story()));
    const int velocities = count(0x301);
    // The gamepad does the same, and its loss stops the robot.
    std::optional<GamepadState> pad = GamepadState{};
    window_->findChild<OperatorCommands*>()->set_gamepads(std::make_unique<FakeGamepads>(pad));
    QTRY_VERIFY_WITH_TIMEOUT(
        window_->findChild<QLabel*>(QStringLiteral("gamepad"))->text().contains(QStringLiteral("fake pad")),
        kPatience_ms);
    pad->left_y = 0.6;
    QVERIFY2(wait_for_state(State::kWalking), qPrintable(story()));
    QTRY_VERIFY_WITH_TIMEOUT(count(0x301) >= velocities + 3, kPatience_ms);
    stops = count(0x201, 4);
    pad.reset();
    QTRY_VERIFY_WITH_TIMEOUT(count(0x201, 4) > stops, kPatience_ms);
    QVERIFY2(wait_for_state(State::kStanding), qPrintable(story()));
    // The keys do so, too; their walk ends when the window is no longer active.
    const int before = count(0x301);
    test::action(*window_, "Forward")->trigger();
    QTRY_VERIFY_WITH_TIMEOUT(count(0x301) >= before + 3, kPatience_ms);
    stops = count(0x201, 4);
    QWidget other;
    other.show();
    QVERIFY(QTest::qWaitForWindowExposed(&other));
    other.activateWindow();
    QTRY_VERIFY_WITH_TIMEOUT(count(0x201, 4) > stops, kPatience_ms);
    other.close();
    QVERIFY2(wait_for_state(State::kStanding), qPrintable(story()));
    // A motion, emergency stop and its reset.
    QVERIFY(test::click(*window_, "play_motion"));
    QTRY_VERIFY_WITH_TIMEOUT(count(0x201, 3) == 1, kPatience_ms);
    QVERIFY(test::click(*window_, "emergency_stop"));
    QVERIFY(wait_for_state(State::kEmergencyStop));
    QVERIFY(test::click(*window_, "reset"));
    QVERIFY(wait_for_state(State::kLimp));
    QVERIFY(test::click(*window_, "get_up"));
    QTRY_COMPARE_WITH_TIMEOUT(count(0x201, 9), 1, kPatience_ms);
  }

  // A robot that would walk on without the studio is pointed out.
  void says_that_a_robot_does_not_stop_by_itself() {
    ++robots_;
    const PlainController robot(bus().toStdString(), true);
    QVERIFY(attach_window());
    QVERIFY(wait_for_state(behaviour::State::kStanding));
    auto* deadline = window_->findChild<QLabel*>(QStringLiteral("walk_deadline"));
    QVERIFY(!deadline->isVisible());
    auto* walk = window_->findChild<QPushButton*>(QStringLiteral("walk"));
    QTest::mousePress(walk, Qt::LeftButton);
    QTRY_VERIFY_WITH_TIMEOUT(deadline->text().contains(QStringLiteral("killed")), kPatience_ms);
    QVERIFY(deadline->isVisible());
    QTRY_VERIFY_WITH_TIMEOUT(count(0x201, 7) > 0, kPatience_ms);
    test::save_picture(*window_, "bus-no-deadline");
    QTest::mouseRelease(walk, Qt::LeftButton);
  }

  // A board without a controller: its drives can be read, and nobody takes commands.
  void follows_a_board_without_controller() {
    QVERIFY2(attach({QStringLiteral("board")}), robot_->readAll().constData());
    QTRY_VERIFY_WITH_TIMEOUT(!window_->run().recording().frames.empty(), kPatience_ms);
    auto* panel = window_->findChild<ObjectPanel*>();
    auto* node = panel->findChild<QComboBox*>();
    node->setCurrentIndex(node->findText(QStringLiteral("left_knee"), Qt::MatchContains));
    panel->findChild<QLineEdit*>()->setText(QStringLiteral("1018:02"));
    const QModelIndex read = panel->findChild<QTableView*>()->model()->index(0, ObjectModel::kValue);
    const bool answered = QTest::qWaitFor(
        [&] {
          QTest::mouseClick(panel->findChild<QPushButton*>(QStringLiteral("read_objects")), Qt::LeftButton);
          QTest::qWait(300);
          return read.data().toString() == QStringLiteral("0x00000001");
        },
        kPatience_ms);
    QVERIFY2(answered, qPrintable(read.data().toString() + QString::fromUtf8(robot_->readAll())));
    QVERIFY(window_->findChild<QLabel*>(QStringLiteral("controller_state"))
                ->text()
                .contains(QStringLiteral("No controller")));
  }

  // In a simulation, the gamepad walks the robot, too.
  void drives_a_simulation_by_gamepad() {
    QSignalSpy opened(&window_->run(), &RunController::opened);
    const std::vector<Override> quick{{"physics.stepper", "lumped", "stepper"}};
    window_->run().open_scenario(kRoot / "scenarios/go.yaml", quick);
    QVERIFY(opened.wait(kPatience_ms));
    std::optional<GamepadState> pad = GamepadState{};
    window_->findChild<OperatorCommands*>()->set_gamepads(std::make_unique<FakeGamepads>(pad));
    QVERIFY(test::run_to(*window_, 5'000'000));
    QTest::qWait(100);  // a reading with released sticks
    pad->left_y = 1.0;
    QTest::qWait(100);
    QVERIFY(test::run_to(*window_, 5'500'000));
    QCOMPARE(window_->run().status().said.state, behaviour::State::kWalking);
    pad->pressed[static_cast<std::size_t>(GamepadButton::kLeftShoulder)] = true;
    QTest::qWait(100);
    QVERIFY(test::run_to(*window_, 6'000'000));
    QTRY_COMPARE(window_->run().status().said.state, behaviour::State::kEmergencyStop);
  }
};

}  // namespace koboshi::studio

int main(int argc, char** argv) {
  return koboshi::studio::test::run_window_test<koboshi::studio::BusTest>(argc, argv);
}

#include "bus_test.moc"
