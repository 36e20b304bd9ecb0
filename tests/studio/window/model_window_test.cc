// The model editor in the window: with the view, with a simulation, and the pictures of its tutorial.

#include <QAction>
#include <QDockWidget>
#include <QMessageBox>
#include <QPushButton>
#include <QSignalSpy>
#include <QTemporaryDir>
#include <filesystem>
#include <fstream>
#include <memory>
#include <sstream>

#include "studio/model/field_view.h"
#include "studio/model/model_panel.h"
#include "studio/widgets/message_bar.h"
#include "tests/studio/window/view_fixture.h"

namespace koboshi::studio {
namespace {

std::string file_text_of(const std::filesystem::path& file) {
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
}

}  // namespace

using test::kPatience_ms;
using test::kRoot;

class ModelWindowTest final : public ViewFixture {
  Q_OBJECT

 private:
  std::unique_ptr<QTemporaryDir> folder_;
  std::filesystem::path file_;

  ModelPanel& panel() { return window_->model(); }
  void start_again() {
    QSignalSpy opened(&window_->run(), &RunController::opened);
    auto* button = panel().findChild<QPushButton*>(QStringLiteral("start_again_model"));
    QVERIFY(button->isEnabled());
    QTest::mouseClick(button, Qt::LeftButton);
    QVERIFY(opened.wait(kPatience_ms));
  }
  void set(const char* path, const char* value) {
    QVERIFY2(panel().set(QLatin1String(path), QLatin1String(value)), qPrintable(panel().message()));
  }
  QImage picture() {
    window_->view().repaint();
    return window_->view().grab().toImage();
  }
  void show_panel() { window_->findChild<QDockWidget*>(QStringLiteral("model"))->raise(); }

 private Q_SLOTS:
  void init() {
    if (test::is_for_eyes_alone()) QSKIP("KOBOSHI_PICTURES names no folder");
    folder_ = std::make_unique<QTemporaryDir>();
    file_ = std::filesystem::path(folder_->path().toStdString()) / "robot.sdf";
    std::filesystem::create_directory_symlink(kRoot / "robots/koboshi/meshes",
                                              file_.parent_path() / "meshes");
    std::filesystem::copy_file(kRoot / "robots/koboshi/robot.sdf", file_);
    show_window(file_);
    show_panel();
  }
  void cleanup() { window_.reset(); }

  void chooses_in_the_view_and_in_the_tree() {
    QTRY_VERIFY_WITH_TIMEOUT(window_->view().frames() > 0, kPatience_ms);
    QTRY_VERIFY(trunk_place());  // without a run, the view shows the edited robot
    panel().choose(QStringLiteral("head"));
    QTest::mouseClick(&window_->view(), Qt::LeftButton, {}, *trunk_place());
    QCOMPARE(panel().chosen(), QStringLiteral("trunk"));
    QVERIFY(panel().fields().choose(QStringLiteral("trunk.mass")).isValid());
    const QImage with_trunk = picture();
    for (QAction* action : window_->all_actions())
      if (plain_text(*action) == QLatin1String("Inertia ellipsoids")) action->toggle();
    QVERIFY(picture() != with_trunk);
  }

  void shows_a_mesh_at_once_and_a_mass_after_another_start() {
    open_scenario("walk.yaml");
    const std::string first = file_text_of(file_);
    run_to(400'000);
    const std::uint64_t hash = window_->run().session()->state_hash();
    const double mass_kg = window_->run().session()->robot().total_mass_kg();
    QVERIFY2(panel().effect().contains(QLatin1String("has this model")), qPrintable(panel().effect()));
    QTRY_VERIFY(trunk_place());
    const QImage before = picture();
    set("head.helmet.zoom", "0.001 0.001 0.003");
    QVERIFY(picture() != before);
    QVERIFY2(panel().effect().contains(QLatin1String("at once")), qPrintable(panel().effect()));
    set("trunk.mass", "400 g");
    set("left_foot.friction", "0.5");
    QVERIFY2(panel().effect().contains(QLatin1String("Start again")), qPrintable(panel().effect()));
    QCOMPARE(window_->run().session()->robot().total_mass_kg(), mass_kg);

    start_again();
    QVERIFY(std::abs(window_->run().session()->robot().total_mass_kg() - mass_kg - 0.04) < 1e-9);
    QVERIFY2(panel().effect().contains(QLatin1String("has this model")), qPrintable(panel().effect()));
    run_to(400'000);
    QVERIFY(window_->run().session()->state_hash() != hash);
    QVERIFY(file_text_of(file_) == first);

    for (int i = 0; i < 3; ++i) QVERIFY(panel().undo());
    start_again();
    run_to(400'000);
    QCOMPARE(window_->run().session()->state_hash(), hash);
  }

  void asks_about_changes_that_are_not_saved() {
    set("trunk.mass", "362 g");
    // The motion editor has the same keys.
    window_->activateWindow();
    QVERIFY(QTest::qWaitForWindowActive(window_.get()));
    panel().fields().setFocus();
    QTest::keyClick(&panel().fields(), Qt::Key_Z, Qt::ControlModifier);
    QTRY_VERIFY(!panel().modified());
    set("trunk.mass", "361 g");
    QVERIFY(window_->windowTitle().contains(QLatin1String("robot.sdf*")));
    QVERIFY(!window_->close());
    window_->findChild<QMessageBox*>(QStringLiteral("unsaved"))->button(QMessageBox::Cancel)->click();
    QVERIFY(panel().save());
    QVERIFY(!window_->windowTitle().contains(QLatin1Char('*')));
    QVERIFY(window_->close());
    QVERIFY(file_text_of(file_).find("<mass>0.361</mass>") != std::string::npos);
  }

  // For the tutorial: KOBOSHI_PICTURES names a folder.
  void pictures() {
    open_scenario("walk.yaml");
    run_to(1'000'000);
    for (QAction* action : window_->all_actions())
      if (plain_text(*action) == QLatin1String("Inertia ellipsoids")) action->toggle();
    panel().choose(QStringLiteral("left_shank"));
    panel().fields().choose(QStringLiteral("left_shank.mass"));
    Q_EMIT panel().chosen_changed(QStringLiteral("left_shank"));
    save_picture("studio-model");
    set("left_shank.mass", "45 g");
    panel().choose(QStringLiteral("right_shank"));
    save_picture("studio-model-finding");
    QVERIFY(panel().undo());
    panel().set_both_sides(true);
    set("left_shank.mass", "45 g");
    set("head.helmet.zoom", "0.001 0.001 0.0012");
    start_again();
    run_to(6'500'000);
    panel().choose(QStringLiteral("left_knee"));
    Q_EMIT panel().chosen_changed(QStringLiteral("left_knee"));
    save_picture("studio-model-walks");
  }
};

}  // namespace koboshi::studio

int main(int argc, char** argv) {
  return koboshi::studio::test::run_window_test<koboshi::studio::ModelWindowTest>(argc, argv);
}

#include "model_window_test.moc"
