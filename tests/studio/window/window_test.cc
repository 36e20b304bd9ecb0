// The window itself: files, messages, the search for commands and the layout.

#include <QAbstractItemView>
#include <QAction>
#include <QApplication>
#include <QComboBox>
#include <QCompleter>
#include <QDockWidget>
#include <QDragEnterEvent>
#include <QDropEvent>
#include <QLineEdit>
#include <QMimeData>
#include <QPushButton>
#include <QSignalSpy>
#include <QTemporaryDir>
#include <QTest>
#include <QUrl>
#include <filesystem>
#include <memory>

#include "tests/studio/window/view_fixture.h"
#include "tools/studio/motion/motion_panel.h"
#include "tools/studio/window/command_search.h"
#include "tools/studio/window/message_bar.h"
#include "tools/studio/window/object_panel.h"
#include "tools/studio/window/theme.h"

namespace koboshi::studio {

using test::kPatience_ms;
using test::kRoot;

class WindowTest final : public ViewFixture {
  Q_OBJECT

 private Q_SLOTS:
  void init() {
    if (test::is_for_eyes_alone()) QSKIP("KOBOSHI_PICTURES names no folder");
    show_window();
  }
  void cleanup() { window_.reset(); }

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
    open_scenario("walk.yaml");
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
};

}  // namespace koboshi::studio

int main(int argc, char** argv) {
  return koboshi::studio::test::run_window_test<koboshi::studio::WindowTest>(argc, argv);
}

#include "window_test.moc"
