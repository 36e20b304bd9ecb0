// The window itself: files, messages, the search for commands and the layout.

#include <QAbstractItemView>
#include <QAction>
#include <QApplication>
#include <QClipboard>
#include <QComboBox>
#include <QCompleter>
#include <QDockWidget>
#include <QDragEnterEvent>
#include <QDropEvent>
#include <QLabel>
#include <QLineEdit>
#include <QMessageBox>
#include <QMimeData>
#include <QPushButton>
#include <QSignalSpy>
#include <QTemporaryDir>
#include <QTest>
#include <QTimer>
#include <QUrl>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <set>
#include <vector>

#include "studio/document/recovery.h"
#include "studio/motion_editor/motion_panel.h"
#include "studio/motion_editor/offer_bar.h"
#include "studio/panels/log_panel.h"
#include "studio/panels/object_panel.h"
#include "studio/widgets/command_search.h"
#include "studio/widgets/message_bar.h"
#include "studio/widgets/theme.h"
#include "tests/studio/window/view_fixture.h"

namespace koboshi::studio {

using test::kPatience_ms;
using test::kRoot;

class WindowTest final : public ViewFixture {
  Q_OBJECT

 private:
  // WCAG 2.1, 1.4.3.
  static double contrast(const QColor& one, const QColor& other) {
    const auto luminance = [](const QColor& colour) {
      const auto linear = [](double share) {
        return share <= 0.04045 ? share / 12.92 : std::pow((share + 0.055) / 1.055, 2.4);
      };
      return 0.2126 * linear(static_cast<double>(colour.redF())) +
             0.7152 * linear(static_cast<double>(colour.greenF())) +
             0.0722 * linear(static_cast<double>(colour.blueF()));
    };
    const auto [dark, light] = std::minmax({luminance(one), luminance(other)});
    return (light + 0.05) / (dark + 0.05);
  }

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
    const auto question = [this] { return window_->findChild<QMessageBox*>(QStringLiteral("unsaved")); };
    for (int i = 0; i < 2; ++i) {
      QVERIFY(!window_->close());
      QVERIFY(question() != nullptr && question()->isVisible());
      QCOMPARE(question()->informativeText(), QStringLiteral("Motion: untitled"));
    }
    question()->button(QMessageBox::Cancel)->click();
    QTRY_VERIFY(question() == nullptr);
    QVERIFY(window_->isVisible() && window_->motion().modified());
    QVERIFY(!window_->close());
    question()->button(QMessageBox::Discard)->click();
    QTRY_VERIFY(!window_->isVisible());
  }

  // The end of the desktop's session: it may not ask any more, or waits for the answer.
  void keeps_changes_at_the_end_of_the_session() {
    action("New motion")->trigger();
    window_->motion().findChild<QAction*>(QStringLiteral("insert_pose"))->trigger();
    const std::string text = window_->motion().text();
    QTimer::singleShot(0, window_.get(), [this] {
      window_->findChild<QMessageBox*>(QStringLiteral("unsaved"))->button(QMessageBox::Cancel)->click();
    });
    QVERIFY(!window_->end_session(true));
    QVERIFY(window_->end_session(false));
    window_->close();
    window_.reset();  // a window that is still there keeps its recoveries to itself
    window_ = test::make_window();
    auto* bar = window_->motion().findChild<OfferBar*>(QStringLiteral("recovery"));
    QVERIFY(bar->isVisibleTo(&window_->motion()));  // at once, without a file that is opened
    bar->findChild<QPushButton*>(QStringLiteral("Restore"))->click();
    QVERIFY(window_->motion().text() == text);
    QVERIFY(window_->motion().modified());
    QVERIFY(!window_->close());
    window_->findChild<QMessageBox*>(QStringLiteral("unsaved"))->button(QMessageBox::Discard)->click();
    QVERIFY(find_recoveries(default_recovery_folder()).empty());
  }

  // Sign, word and colours tell the kind of a message, on both themes; the log keeps it.
  void messages_look_like_what_they_are() {
    MessageBar& bar = window_->messages();
    auto* log = window_->findChild<LogPanel*>();
    for (const Theme theme : {Theme::kLight, Theme::kDark}) {
      apply_theme(theme);
      std::set<QString> words;
      std::set<QRgb> colours;
      std::vector<QImage> icons;
      for (const MessageKind kind :
           {MessageKind::kSuccess, MessageKind::kInformation, MessageKind::kWarning, MessageKind::kError}) {
        const QString text = QStringLiteral("message %1").arg(static_cast<int>(kind));
        window_->messages().show_message(text, kind);
        QCOMPARE(bar.text(), text);
        const QString word = bar.findChild<QLabel*>(QStringLiteral("message_kind"))->text();
        const QImage icon =
            bar.findChild<QLabel*>(QStringLiteral("message_icon"))->pixmap(Qt::ReturnByValue).toImage();
        const QColor ground = bar.grab().toImage().pixelColor(bar.width() / 2, 3);
        words.insert(word);
        colours.insert(ground.rgb());
        QVERIFY(std::ranges::find(icons, icon) == icons.end());
        icons.push_back(icon);
        // Readable: WCAG 2.1 asks for a contrast of 4.5 between a text and its ground.
        QVERIFY2(contrast(bar.palette().color(QPalette::WindowText), ground) > 4.5, qPrintable(word));
        if (kind == MessageKind::kSuccess) QVERIFY(ground.green() > ground.red());
        if (kind == MessageKind::kError) QVERIFY(ground.red() > ground.green());
        QVERIFY(log->text().contains(word + u' ' + text));
        if (theme == Theme::kDark)
          test::save_picture(*window_, qPrintable(QStringLiteral("message-dark-") + word));
        if (theme == Theme::kLight)
          test::save_picture(*window_, qPrintable(QStringLiteral("message-light-") + word));
      }
      QCOMPARE(words.size(), 4U);
      QCOMPARE(colours.size(), 4U);
    }
    apply_theme(Theme::kLight);
    QTest::mouseClick(log->findChild<QPushButton*>(QStringLiteral("copy_log")), Qt::LeftButton);
    QCOMPARE(QGuiApplication::clipboard()->text().count(u'\n'), 8);
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
