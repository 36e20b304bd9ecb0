#include <QAction>
#include <QComboBox>
#include <QDockWidget>
#include <QDoubleSpinBox>
#include <QLabel>
#include <QLineEdit>
#include <QPushButton>
#include <QSignalSpy>
#include <QSlider>
#include <QSplitter>
#include <QTableWidget>
#include <QTemporaryDir>
#include <QTest>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/text/text.h"
#include "sim_board/description/load.h"
#include "studio/controls/run_controller.h"
#include "studio/parameters/comparison.h"
#include "studio/tuning/compare_panel.h"
#include "studio/tuning/parameter_panel.h"
#include "studio/tuning/parameter_row.h"
#include "studio/tuning/study_panel.h"
#include "studio/window/main_window.h"
#include "studio/window/tuning_panels.h"

namespace koboshi::studio {
namespace {

namespace fs = std::filesystem;

constexpr int kPatience_ms = 30'000;
const fs::path kRoot = KOBOSHI_SOURCE_DIR;
constexpr const char* kSpeedLimit = "highest_velocity_forward_mm_per_s";

// Trials of 0.3 s: what this search finds is of no interest.
constexpr const char* kStudy =
    "version: 1\n"
    "scenario: ../scenarios/go.yaml\n"
    "numbers:\n"
    "  parameters.step_time_ms: {range: [200, 360], grid: 10, start: 220}\n"
    "  parameters.step_height_mm: {range: [14, 35], grid: 0.1, start: 20}\n"
    "trials:\n"
    "  - name: stand\n"
    "    set: {duration_s: 0.3}\n";

void write(const fs::path& file, const std::string& text) { std::ofstream(file) << text; }
std::string read(const fs::path& file) { return read_text_file(file, "a file"); }

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t begin = text.find(from);
  return begin == std::string::npos ? "nothing to replace: " + from : text.replace(begin, from.size(), to);
}

// The robot walks forward from 4.2 s on, with the fastest stepper.
std::string scenario_of_a_walk() {
  const std::string go = read(kRoot / "scenarios/go.yaml");
  return replaced(go.substr(0, go.find("commands:")), "held_until_s: 3.5", "held_until_s: 3.2") +
         "physics: {stepper: lumped}\n"
         "commands:\n"
         "  - {at_s: 2, enable: true}\n"
         "  - {at_s: 3.4, walk: {}}\n"
         "  - {at_s: 4.2, walk: {forward_m_per_s: 0.2}}\n";
}

}  // namespace

// The panels on copies of the robot, a scenario and a study.
class TuningTest final : public QObject {
  Q_OBJECT

 private:
  std::unique_ptr<QTemporaryDir> folder_;
  std::unique_ptr<RunController> run_;
  std::unique_ptr<TuningPanels> panels_;
  std::unique_ptr<QSplitter> window_;

  fs::path root() const { return folder_->path().toStdString(); }
  fs::path parameters_file() const { return root() / "robots/koboshi/parameters.yaml"; }
  ParameterEditor& editor() { return panels_->parameters().editor(); }
  std::size_t at(const char* key) { return index_of(editor().document()->table(), key).value(); }
  std::optional<double> value(const char* key) { return editor().document()->value(at(key)); }
  std::optional<double> in_force(const char* key) { return editor().live().state(at(key)).in_force; }
  QAction* action(const char* text) {
    for (QAction* one : panels_->parameters().findChildren<QAction*>())
      if (one->text().remove(QLatin1Char('&')) == QLatin1String(text)) return one;
    return nullptr;
  }

  void open(const fs::path& scenario) {
    QSignalSpy opened(run_.get(), &RunController::opened);
    run_->open_scenario(scenario);
    QVERIFY(opened.wait(kPatience_ms));
  }
  void run_to(std::uint64_t time_us) {
    run_->step((time_us - run_->status().time_us) / 1000);
    QTRY_VERIFY_WITH_TIMEOUT(run_->end_us() >= time_us, kPatience_ms);
  }
  // Lets the simulation run until something has happened, for 4 s of its own time at most. Each step is
  // waited for: the machine may be slower than the clock.
  void while_running_until(const std::function<bool()>& happened) {
    for (int tries = 0; tries < 200 && !happened(); ++tries) {
      run_to(run_->status().time_us + 20'000);
      QTest::qWait(10);
    }
    QVERIFY(happened());
  }
  double speed_m_per_s() const {
    const view::Recording& recording = run_->recording();
    return trunk_quantity(recording, recording.samples.size() - 1, TrunkQuantity::kSpeed);
  }

 private Q_SLOTS:
  void init() {
    folder_ = std::make_unique<QTemporaryDir>();
    fs::create_directories(root() / "robots");
    fs::copy(kRoot / "robots/koboshi", root() / "robots/koboshi", fs::copy_options::recursive);
    fs::create_directories(root() / "scenarios");
    // The paths in a scenario begin at the folder with the robots.
    fs::copy(kRoot / "scenarios/walk.yaml", root() / "scenarios/walk.yaml");
    write(root() / "scenarios/go.yaml", scenario_of_a_walk());
    fs::create_directories(root() / "studies");
    write(root() / "studies/tiny.yaml", kStudy);
    run_ = std::make_unique<RunController>();
    panels_ = std::make_unique<TuningPanels>(*run_);
    window_ = std::make_unique<QSplitter>();
    window_->addWidget(&panels_->parameters());
    window_->addWidget(&panels_->comparison());
    window_->addWidget(&panels_->studies());
    window_->resize(1200, 420);
    window_->show();
    QVERIFY(QTest::qWaitForWindowExposed(window_.get()));
    panels_->set_robot(sim_board::load_robot(root() / "robots/koboshi/robot.sdf"));
    QVERIFY(editor().document() != nullptr);
  }
  void cleanup() {
    panels_.reset();
    window_.reset();
    run_.reset();
    folder_.reset();
  }

  // A slider changes the velocity limit of a walking robot, which obeys; undo takes it back there, too;
  // saving changes one number of the file.
  void a_slider_slows_a_walking_robot() {
    open(root() / "scenarios/go.yaml");
    const std::string before = read(parameters_file());
    QCOMPARE(in_force(kSpeedLimit), std::optional(330.0));
    run_to(7'000'000);
    QVERIFY2(speed_m_per_s() > 0.15, qPrintable(QString::number(speed_m_per_s())));
    ParameterRow& row = panels_->parameters().row(at(kSpeedLimit));
    QVERIFY(row.slider()->isEnabled());
    row.slider()->setFocus();
    while (value(kSpeedLimit) > 60.0) {
      const auto last = value(kSpeedLimit);
      QTest::keyClick(row.slider(), Qt::Key_PageDown);
      if (value(kSpeedLimit) == last) break;
    }
    QVERIFY(value(kSpeedLimit) < 101.0);
    while_running_until([&] { return in_force(kSpeedLimit) == value(kSpeedLimit); });
    run_to(9'500'000);
    QCOMPARE(row.live_text(), QStringLiteral("✓"));
    QVERIFY2(speed_m_per_s() < 0.12, qPrintable(QString::number(speed_m_per_s())));
    QCOMPARE(read(parameters_file()), before);

    // The walk takes the numbers of its steps within two of them.
    panels_->parameters().row(at("step_height_mm")).box()->setValue(26.0);
    while_running_until([&] { return in_force("step_height_mm") == std::optional(26.0); });
    QTRY_COMPARE(panels_->parameters().row(at("step_height_mm")).live_text(), QStringLiteral("✓"));

    action("Save")->trigger();
    const std::string limit = std::string(kSpeedLimit) + ": ";
    const std::string now = editor().document()->table()[at(kSpeedLimit)].text(*value(kSpeedLimit));
    QCOMPARE(read(parameters_file()), replaced(replaced(before, limit + "330", limit + now),
                                               "step_height_mm: 27.7", "step_height_mm: 26"));
    while (editor().document()->history().can_undo()) action("Undo")->trigger();
    QCOMPARE(editor().document()->text(), before);
    action("Redo")->trigger();
    action("Undo")->trigger();
    while_running_until([&] { return in_force(kSpeedLimit) == std::optional(330.0); });
  }

  void shows_what_controller_and_compiler_refuse() {
    open(root() / "scenarios/go.yaml");
    run_to(3'500'000);
    panels_->parameters().row(at("mounting_roll_deg")).box()->setValue(1.0);
    run_to(3'700'000);
    QTRY_VERIFY(
        panels_->parameters().row(at("mounting_roll_deg")).live_text().contains(QLatin1String("refused")));
    QVERIFY(panels_->parameters().message().contains(QLatin1String("mounting_roll_deg")));
    QVERIFY(editor().undo());
    panels_->parameters().row(at("com_height_mm")).box()->setValue(400.0);
    QTRY_VERIFY2(panels_->parameters().message().contains(QLatin1String("expected")),
                 qPrintable(panels_->parameters().message()));
    QVERIFY(editor().reset_all());
    QTRY_VERIFY(panels_->parameters().message().isEmpty());
  }

  void sends_nothing_to_a_robot_on_a_bus_unasked() {
    QSignalSpy requested(&editor(), &ParameterEditor::requested);
    editor().run_attached();
    QVERIFY(editor().set(at("step_height_mm"), 25.0));
    QCOMPARE(requested.count(), 0);
    QVERIFY(!panels_->parameters().findChild<QPushButton*>(QStringLiteral("start_again"))->isVisible());
    editor().set_live(true);
    QVERIFY(editor().set(at("step_height_mm"), 26.0));
    QCOMPARE(requested.count(), 1);
    editor().read_all();
    QCOMPARE(requested.count(), 1 + static_cast<int>(editor().document()->table().size()));
  }

  void finds_parameters_by_words() {
    auto* search = panels_->parameters().findChild<QLineEdit*>();
    QTest::keyClicks(search, QStringLiteral("pendulum"));
    QVERIFY(panels_->parameters().row(at("com_height_mm")).is_visible());
    QVERIFY(!panels_->parameters().row(at("step_time_ms")).is_visible());
    search->clear();
    QVERIFY(panels_->parameters().row(at("step_time_ms")).is_visible());
  }

  // The numbers of a gait are compiled: they take effect when the scenario starts again.
  void changes_the_gait_of_a_scenario() {
    open(root() / "scenarios/walk.yaml");
    panels_->parameters().findChild<QComboBox*>()->setCurrentIndex(1);
    QCOMPARE(editor().shown(), ParameterEditor::kGait);
    QVERIFY(editor().document()->is_gait());
    const auto gain = value("feedback.ankle_roll_s");
    QVERIFY(gain && *gain > 0.0);
    QVERIFY(in_force("feedback.ankle_roll_s").has_value());
    QSignalSpy restart(panels_.get(), &TuningPanels::restart_wanted);
    QVERIFY(editor().set(at("step_height_m"), 0.014));
    QCOMPARE(panels_->parameters().row(at("step_height_m")).live_text(), QStringLiteral("after Start again"));
    panels_->parameters().findChild<QPushButton*>(QStringLiteral("start_again"))->click();
    QCOMPARE(restart.count(), 1);
    QSignalSpy opened(run_.get(), &RunController::opened);
    run_->reopen({});
    QVERIFY(opened.wait(kPatience_ms));
    const auto& overrides = run_->session()->scenario().gait->overrides;
    QVERIFY(!overrides.empty());
    QCOMPARE(overrides.front().path, std::string("step_height_m"));
    QCOMPARE(overrides.front().value, std::string("0.014"));
  }

  void two_sets_walk_beside_each_other() {
    open(root() / "scenarios/go.yaml");
    QVERIFY(editor().set(at(kSpeedLimit), 80.0));
    ComparePanel& compare = panels_->comparison();
    QSignalSpy started(&compare, &ComparePanel::started);
    compare.findChild<QPushButton*>(QStringLiteral("compare"))->click();
    QVERIFY(started.wait(kPatience_ms));
    QTRY_VERIFY_WITH_TIMEOUT(compare.comparison()->common_samples() >= 580, kPatience_ms);
    compare.set_playing(false);
    QTRY_VERIFY(!compare.comparison()->is_busy());
    QTRY_VERIFY(compare.table().rowCount() > 0);
    QCOMPARE(compare.table().item(0, 0)->text(), QStringLiteral("Speed [m/s]"));
    QTRY_VERIFY(compare.table().item(0, 3)->text().toDouble() < -0.01);
    QCOMPARE(compare.view().picture().posed().size(),
             2 * compare.comparison()->recording(0).scene.links.size());
    QTRY_VERIFY(compare.view().frames() > 0);
  }

  // For eyes: KOBOSHI_PICTURES names a folder for pictures of the window.
  void pictures() {
    const QString folder = qEnvironmentVariable("KOBOSHI_PICTURES");
    if (folder.isEmpty()) QSKIP("KOBOSHI_PICTURES names no folder");
    window_->hide();
    MainWindow studio(root() / "robots/koboshi/robot.sdf");
    studio.resize(1500, 950);
    studio.show();
    const auto dock = [&](const char* name) { return studio.findChild<QDockWidget*>(QLatin1String(name)); };
    QSignalSpy opened(&studio.run(), &RunController::opened);
    studio.open(root() / "scenarios/go.yaml");
    QVERIFY(opened.wait(kPatience_ms));
    studio.run().step(7500);
    QTRY_VERIFY_WITH_TIMEOUT(studio.run().end_us() >= 7'500'000, kPatience_ms);
    auto* parameters = studio.findChild<ParameterPanel*>();
    const ParameterTable table = controller_table();
    for (const auto& [key, value] : {std::pair("step_height_mm", 28.0), std::pair("trunk_pitch_deg", 5.0),
                                     std::pair(kSpeedLimit, 220.0)})
      QVERIFY(parameters->editor().set(index_of(table, key).value(), value));
    for (int i = 0; i < 20; ++i) {
      studio.run().step(20);
      QTest::qWait(20);
    }
    dock("parameters")->raise();
    dock("comparison")->raise();
    studio.resizeDocks({dock("comparison")}, {400}, Qt::Vertical);
    studio.resizeDocks({dock("parameters")}, {500}, Qt::Horizontal);
    parameters->findChild<QLineEdit*>()->setText(QStringLiteral("step"));
    auto* compare = studio.findChild<ComparePanel*>();
    QSignalSpy started(compare, &ComparePanel::started);
    compare->start();
    QVERIFY(started.wait(kPatience_ms));
    QTRY_VERIFY_WITH_TIMEOUT(compare->comparison()->common_samples() >= 800, 4 * kPatience_ms);
    compare->set_playing(false);
    compare->view().look_at_robot();
    QTest::qWait(1500);
    studio.grab().save(folder + QStringLiteral("/studio-parameters.png"));
    dock("studies")->raise();
    QTest::qWait(500);
    studio.grab().save(folder + QStringLiteral("/studio-studies.png"));
  }

  // A search is started, watched, stopped, resumed and adopted: one change, which can be undone, and no file
  // is written.
  void a_study_is_searched_and_adopted() {
    // They appear by generations, of six; enough of them for a search that lasts some seconds.
    constexpr std::size_t kEvaluations = 96;
    StudyPanel& panel = panels_->studies();
    QVERIFY(panel.settings().study == root() / "studies/tiny.yaml");
    StudySettings settings = panel.settings();
    settings.out = root() / "found";
    settings.evaluations = kEvaluations;
    settings.seeds = 1;
    settings.stepper = "lumped";
    settings.jobs = 1;
    panel.set_settings(settings);
    QSignalSpy finished(&panel, &StudyPanel::finished);
    QSignalSpy failed(&panel, &StudyPanel::failed);
    panel.findChild<QPushButton*>(QStringLiteral("start_study"))->click();
    QTRY_VERIFY_WITH_TIMEOUT(panel.run() && panel.run()->evaluations.size() >= 2, kPatience_ms);
    const QString state = panel.findChild<QLabel*>(QStringLiteral("study_state"))->text();
    QVERIFY2(state.contains(QLatin1String("running")), qPrintable(state));
    panel.stop();
    QVERIFY(finished.wait(kPatience_ms));
    QVERIFY2(failed.isEmpty(), qPrintable(failed.value(0).value(0).toString()));
    const std::size_t stopped_after = panel.run()->evaluations.size();
    QVERIFY(stopped_after < kEvaluations && !panel.run()->is_finished);
    panel.start();
    QTRY_VERIFY_WITH_TIMEOUT(!panel.is_running(), kPatience_ms);
    QVERIFY2(failed.isEmpty(), qPrintable(failed.value(0).value(0).toString()));
    QVERIFY(panel.run()->is_finished);
    QCOMPARE(panel.run()->evaluations.size(), kEvaluations);

    const std::string before = read(parameters_file());
    auto* table = panel.findChild<QTableWidget*>();
    QVERIFY(table->rowCount() > 3);
    table->selectRow(3);
    const auto number = static_cast<std::size_t>(table->item(3, 0)->text().toInt());
    const StudyEvaluation& chosen = panel.run()->evaluations[number - 1];
    panel.findChild<QPushButton*>(QStringLiteral("adopt"))->click();
    QCOMPARE(value("step_time_ms"), std::optional(chosen.values[0]));
    QCOMPARE(value("step_height_mm"), std::optional(chosen.values[1]));
    QCOMPARE(editor().document()->history().undo_count(), std::size_t{1});
    QCOMPARE(read(parameters_file()), before);
    QVERIFY(editor().undo());
    QCOMPARE(editor().document()->text(), before);
  }
};

}  // namespace koboshi::studio

int main(int argc, char** argv) {
  QApplication application(argc, argv);
  koboshi::studio::TuningTest test;
  return QTest::qExec(&test, argc, argv);
}

#include "tuning_test.moc"
