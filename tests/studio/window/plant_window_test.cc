// The panel of the plant in the window: its sliders change the next run as `koboshi run --plant` does.

#include <QComboBox>
#include <QDockWidget>
#include <QDoubleSpinBox>
#include <QLabel>
#include <QLineEdit>
#include <QMessageBox>
#include <QPushButton>
#include <QSignalSpy>
#include <QSlider>
#include <QTemporaryDir>
#include <QToolButton>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "base/file/output_file.h"
#include "base/text/text.h"
#include "simulation/scenario/reader.h"
#include "studio/plant/plant_list.h"
#include "studio/plant/plant_panel.h"
#include "studio/plant/plant_row.h"
#include "studio/run/session.h"
#include "studio/window/documents.h"
#include "tests/studio/window/view_fixture.h"

namespace koboshi::studio {

using test::kPatience_ms;
using test::kRoot;

class PlantWindowTest final : public ViewFixture {
  Q_OBJECT

 private:
  static constexpr std::uint64_t kRun_us = 100'000;

  std::unique_ptr<QTemporaryDir> folder_;
  std::filesystem::path file_;

  PlantPanel& panel() { return window_->plant(); }
  PlantRow& row(const char* name) { return *panel().row(name); }
  QString shown(int entry, int column) { return panel().list().topLevelItem(entry)->text(column); }
  // The text in the corner of the view; empty: none.
  QString caption() {
    const auto* label = window_->view().findChild<QLabel*>(QStringLiteral("plant_differences"));
    return label->isVisible() ? label->text() : QString();
  }
  std::string file_text() const { return read_text_file(file_, "a scenario"); }
  void start_again() {
    QSignalSpy opened(&window_->run(), &RunController::opened);
    QVERIFY(test::click(*window_, "start_again_plant"));
    QVERIFY(opened.wait(kPatience_ms));
  }
  std::uint64_t hash_of_run() {
    run_to(kRun_us);
    return window_->run().session()->state_hash();
  }
  // Of `koboshi run` with these options.
  std::uint64_t hash_of_option(const std::filesystem::path& file,
                               const std::vector<std::pair<std::string, std::string>>& plant) {
    std::vector<Override> overrides;
    for (const auto& [key, value] : plant)
      overrides.push_back(text_override("plant." + key, value, "--plant"));
    Session session(simulation::read_scenario(file, overrides));
    session.step(kRun_us / 1000);
    return session.state_hash();
  }
  void type(const char* entry) {
    auto* line = panel().findChild<QLineEdit*>(QStringLiteral("plant_entry"));
    line->clear();
    QTest::keyClicks(line, QLatin1String(entry));
    QTest::keyClick(line, Qt::Key_Return);
  }

 private Q_SLOTS:
  void init() {
    if (test::is_for_eyes_alone()) QSKIP("KOBOSHI_PICTURES names no folder");
    folder_ = std::make_unique<QTemporaryDir>();
    file_ = std::filesystem::path(folder_->path().toStdString()) / "squat.yaml";
    std::filesystem::copy_file(kRoot / "scenarios/squat.yaml", file_);
    show_window();
    window_->findChild<QDockWidget*>(QStringLiteral("plant"))->raise();
  }
  void cleanup() { window_.reset(); }

  void a_slider_changes_the_next_run_and_removing_restores_it() {
    QVERIFY(panel().effect().contains(QLatin1String("has to be open")));
    open(file_);
    const std::uint64_t as_modelled = hash_of_run();
    panel().choose(QStringLiteral("left_shank"));
    QSlider* slider = row("left_shank.mass").slider();
    slider->setSliderDown(true);
    for (const int place : {400, 500, 600}) slider->setSliderPosition(place);
    slider->setSliderDown(false);
    QCOMPARE(panel().list().topLevelItemCount(), 1);
    QCOMPARE(shown(0, PlantList::kQuantity), QStringLiteral("left_shank.mass"));
    QCOMPARE(shown(0, PlantList::kPlant), QStringLiteral("92 g"));
    QCOMPARE(shown(0, PlantList::kModel), QStringLiteral("50 g"));
    QCOMPARE(row("left_shank.mass").box()->value(), 92.0);
    QVERIFY(panel().effect().contains(QLatin1String("Start again")));
    QVERIFY(window_->windowTitle().startsWith(QStringLiteral("squat.yaml*")));
    QVERIFY(caption().isEmpty());                    // the run is as it was
    QVERIFY(panel().undo() && !panel().modified());  // the drag was one step
    QVERIFY(panel().redo());

    start_again();
    QVERIFY(caption().contains(QLatin1String("left_shank.mass = 92 g")));
    QVERIFY2(panel().effect().contains(QLatin1String("has these values")), qPrintable(panel().effect()));
    const std::uint64_t heavier = hash_of_run();
    QVERIFY(heavier != as_modelled);
    QCOMPARE(heavier, hash_of_option(file_, {{"left_shank.mass", "92g"}}));
    test::save_picture(*window_, "plant-squat");

    panel().list().findChild<QToolButton*>(QStringLiteral("remove_plant"))->click();
    QTRY_COMPARE(panel().list().topLevelItemCount(), 0);
    start_again();
    QVERIFY(caption().isEmpty());
    QCOMPARE(hash_of_run(), as_modelled);
    QVERIFY(file_text() == read_text_file(kRoot / "scenarios/squat.yaml", "a scenario"));
  }

  void says_what_it_refuses_and_saves_the_rest() {
    open(file_);
    const auto refusal = [this](const char* entry) {
      type(entry);
      return panel().message();
    };
    QVERIFY(refusal("left_shank.mass=45").contains(QLatin1String("did you mean 45 g?")));
    QVERIFY(
        refusal("left_shnk.mass=45 g").startsWith(QLatin1String("plant: found left_shnk.mass, expected")));
    QVERIFY(refusal("left_shank.mass").contains(QLatin1String("KEY=VALUE")));
    panel().choose(QStringLiteral("left_shank"));
    QDoubleSpinBox* box = row("left_shank.mass").box();
    box->setValue(45'000.0);
    QVERIFY2(panel().message().contains(QLatin1String("osmium")), qPrintable(panel().message()));
    QVERIFY(!panel().message().contains(QLatin1Char('\n')));
    QCOMPARE(box->value(), 50.0);
    QCOMPARE(panel().list().topLevelItemCount(), 0);
    QVERIFY(!panel().modified());
    box->setValue(60.0);
    QVERIFY(panel().message().isEmpty());
    // Another scenario would take the change away.
    window_->open(kRoot / "scenarios/walk.yaml");
    auto* question = window_->findChild<QMessageBox*>(QStringLiteral("unsaved"));
    QVERIFY(question != nullptr);
    QCOMPARE(question->informativeText(), QStringLiteral("Scenario: squat.yaml"));
    question->button(QMessageBox::Cancel)->click();
    QVERIFY(panel().modified());
    QVERIFY(panel().undo());

    type("trunk.com = 0 0 10mm");
    panel().choose(QStringLiteral("left_foot"));
    panel().row("left_foot.friction")->box()->setValue(0.3);
    QCOMPARE(panel().list().topLevelItemCount(), 2);
    QCOMPARE(window_->documents().active(), Documents::kScenario);
    window_->documents().save();
    QVERIFY(!panel().modified());
    QVERIFY(file_text().find("plant:\n  trunk.com: 0 0 10mm\n  left_foot.friction: 0.3\n") !=
            std::string::npos);
    const std::uint64_t of_option = hash_of_option(
        kRoot / "scenarios/squat.yaml", {{"trunk.com", "0 0 10 mm"}, {"left_foot.friction", "0.3"}});
    QCOMPARE(hash_of_option(file_, {}), of_option);
    open(file_);
    QCOMPARE(panel().list().topLevelItemCount(), 2);
    QCOMPARE(shown(1, PlantList::kModel), QStringLiteral("0.8"));
    QCOMPARE(hash_of_run(), of_option);
    // Into another file, which is then open.
    type("left_shank.mass=60 g");
    QSignalSpy opened(&window_->run(), &RunController::opened);
    const std::filesystem::path other = file_.parent_path() / "heavy.yaml";
    QVERIFY(panel().save_as(other));
    QVERIFY(opened.wait(kPatience_ms));
    QCOMPARE(window_->run().file(), other);
    QCOMPARE(panel().document()->file(), other);
    QCOMPARE(panel().list().topLevelItemCount(), 3);
    QVERIFY(!panel().modified());
  }

  // For eyes: KOBOSHI_PICTURES names a folder.
  void pictures() {
    open_scenario("walk.yaml");
    panel().choose(QStringLiteral("left_shank"));
    row("left_shank.mass").box()->setValue(80.0);
    type("krs_2552.resistance_ohm=6.5");
    row("left_shank.com z").box()->setValue(-40.0);
    start_again();
    run_to(6'500'000);
    save_picture("studio-plant");
    row("left_shank.mass").box()->setValue(800.0);
    panel().choose(QStringLiteral("krs_2552"));
    save_picture("studio-plant-refused");
  }
};

}  // namespace koboshi::studio

int main(int argc, char** argv) {
  return koboshi::studio::test::run_window_test<koboshi::studio::PlantWindowTest>(argc, argv);
}

#include "plant_window_test.moc"
