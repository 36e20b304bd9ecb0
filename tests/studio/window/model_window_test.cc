// The model editor in the window: with the view, with a simulation, and the pictures of its tutorial.

#include <QAction>
#include <QDockWidget>
#include <QPushButton>
#include <QSettings>
#include <QSignalSpy>
#include <QSurfaceFormat>
#include <QTemporaryDir>
#include <QTest>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <sstream>

#include "tools/studio/model/field_view.h"
#include "tools/studio/model/model_panel.h"
#include "tools/studio/window/command_search.h"
#include "tools/studio/window/main_window.h"
#include "tools/studio/window/message_bar.h"
#include "tools/view/render/camera.h"

namespace koboshi::studio {
namespace {

constexpr int kModelPatience_ms = 20'000;
const std::filesystem::path kRepository = KOBOSHI_SOURCE_DIR;

std::string file_text_of(const std::filesystem::path& file) {
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
}

}  // namespace

class ModelWindowTest final : public QObject {
  Q_OBJECT

 private:
  std::unique_ptr<QTemporaryDir> folder_;
  std::filesystem::path file_;
  std::unique_ptr<MainWindow> window_;

  ModelPanel& panel() { return window_->model(); }
  void open_walk() {
    QSignalSpy opened(&window_->run(), &RunController::opened);
    window_->open(kRepository / "scenarios/walk.yaml");
    QVERIFY(opened.wait(kModelPatience_ms));
  }
  void run_to(std::uint64_t time_us) {
    RunController& run = window_->run();
    run.session()->wait();  // a run begins with a step
    run.step((time_us - run.session()->status().time_us) / 1000);
    QTRY_VERIFY_WITH_TIMEOUT(run.end_us() >= time_us, kModelPatience_ms);
  }
  void start_again() {
    QSignalSpy opened(&window_->run(), &RunController::opened);
    auto* button = panel().findChild<QPushButton*>(QStringLiteral("start_again_model"));
    QVERIFY(button->isEnabled());
    QTest::mouseClick(button, Qt::LeftButton);
    QVERIFY(opened.wait(kModelPatience_ms));
  }
  void set(const char* path, const char* value) {
    QVERIFY2(panel().set(QLatin1String(path), QLatin1String(value)), qPrintable(panel().message()));
  }
  QImage picture() {
    window_->view().repaint();
    return window_->view().grabFramebuffer();
  }
  // A place of the view at which there is the trunk.
  std::optional<QPoint> trunk_place() {
    RobotView& view = window_->view();
    if (view.posed().empty()) return std::nullopt;
    const Eigen::Vector2d place_px =
        view::project(view.camera(), view.width(), view.height(), view.posed()[0].p_WL_m.cast<double>());
    for (int dy = -60; dy <= 20; dy += 10)
      for (int dx = -20; dx <= 20; dx += 10) {
        const QPointF place(place_px.x() + dx, place_px.y() + dy);
        if (const auto hit = view.link_at(place); hit && hit->link == 0) return place.toPoint();
      }
    return std::nullopt;
  }
  void save_picture(const char* name) {
    const QString pictures = qEnvironmentVariable("KOBOSHI_PICTURES");
    if (pictures.isEmpty()) return;
    QTest::qWait(700);
    window_->grab().save(pictures + u'/' + QLatin1String(name) + QStringLiteral(".png"));
  }
  void show_panel() { window_->findChild<QDockWidget*>(QStringLiteral("model"))->raise(); }

 private Q_SLOTS:
  void init() {
    QSettings().clear();
    folder_ = std::make_unique<QTemporaryDir>();
    file_ = std::filesystem::path(folder_->path().toStdString()) / "robot.sdf";
    std::filesystem::create_directory_symlink(kRepository / "robots/koboshi/meshes",
                                              file_.parent_path() / "meshes");
    std::filesystem::copy_file(kRepository / "robots/koboshi/robot.sdf", file_);
    window_ = std::make_unique<MainWindow>(file_);
    window_->resize(1280, 800);
    window_->show();
    QVERIFY(QTest::qWaitForWindowExposed(window_.get()));
    show_panel();
  }
  void cleanup() { window_.reset(); }

  void chooses_in_the_view_and_in_the_tree() {
    QTRY_VERIFY_WITH_TIMEOUT(window_->view().frames() > 0, kModelPatience_ms);
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
    open_walk();
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
    QVERIFY(panel().save());
    QVERIFY(!window_->windowTitle().contains(QLatin1Char('*')));
    QVERIFY(window_->close());
    QVERIFY(file_text_of(file_).find("<mass>0.361</mass>") != std::string::npos);
  }

  // For the tutorial: KOBOSHI_PICTURES names a folder.
  void pictures() {
    if (qEnvironmentVariableIsEmpty("KOBOSHI_PICTURES")) return;
    open_walk();
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

// The default format must be set before the application is made.
int main(int argc, char** argv) {
  QSurfaceFormat::setDefaultFormat(koboshi::studio::RobotView::format());
  QApplication application(argc, argv);
  QApplication::setOrganizationName(QStringLiteral("Koboshi"));
  QApplication::setApplicationName(QStringLiteral("Koboshi Studio Test"));
  koboshi::studio::ModelWindowTest test;
  return QTest::qExec(&test, argc, argv);
}

#include "model_window_test.moc"
