#include <QProcess>
#include <QPushButton>
#include <string_view>

#include "studio/motion_editor/message_line.h"
#include "studio/motion_editor/offer_bar.h"
#include "tests/studio/motion_editor/panel_fixture.h"
#include "tests/support/qt_tests.h"

// Files of motions: recovery after a crash, and other programs.
namespace koboshi::studio {

inline constexpr const char* kEditAndWait = "--edit-and-wait";

class MotionFilesTest final : public PanelFixture {
  Q_OBJECT

 private Q_SLOTS:
  void init() { prepare(); }
  void cleanup() { clean_up(); }

  void recovers_after_a_crash() {
    open_copy("wave.yaml");
    const std::string original = text();
    type_into(0, StepModel::kTime, "1.75");
    const std::string edited = text();
    QVERIFY(edited != original);
    auto* const timer = editor().findChild<QTimer*>();
    QVERIFY(timer != nullptr && timer->isActive());
    timer->setInterval(1);
    QTRY_VERIFY_WITH_TIMEOUT(!find_recovery_files().empty(), kPatience_ms);
    editor().keep_recovery();
    panel_.reset();
    COMPARE_TEXT(text_of(file_), original);

    open(file_);
    auto* const bar = panel_->findChild<OfferBar*>(QStringLiteral("recovery"));
    QVERIFY(bar->isVisible());
    COMPARE_TEXT(text(), original);
    grab("recovery");
    QTest::mouseClick(bar->findChild<QPushButton*>(QStringLiteral("Restore")), Qt::LeftButton);
    QVERIFY(!bar->isVisible());
    COMPARE_TEXT(text(), edited);
    QVERIFY(panel_->modified());
    QVERIFY(panel_->save());
    COMPARE_TEXT(text_of(file_), edited);
    panel_.reset();
    QVERIFY(find_recovery_files().empty());
    open(file_);
    QVERIFY(!panel_->findChild<OfferBar*>(QStringLiteral("recovery"))->isVisible());
  }

  // Another process edits and is killed; this one recovers what it wrote.
  void recovers_after_kill_9() {
    file_ = in_folder("wave.yaml");
    fs::copy_file(kMotions / "wave.yaml", file_);
    const std::string original = text_of(file_);
    QProcess editing;
    editing.start(QCoreApplication::applicationFilePath(),
                  {QLatin1String(kEditAndWait), QString::fromStdString(file_.string())});
    QVERIFY(editing.waitForStarted(kPatience_ms));
    QTRY_VERIFY_WITH_TIMEOUT(!find_recovery_files().empty(), kPatience_ms);
    editing.kill();
    QVERIFY(editing.waitForFinished(kPatience_ms));
    QCOMPARE(editing.exitStatus(), QProcess::CrashExit);
    COMPARE_TEXT(text_of(file_), original);

    open(file_);
    auto* const bar = panel_->findChild<OfferBar*>(QStringLiteral("recovery"));
    QVERIFY(bar->isVisible());
    QTest::mouseClick(bar->findChild<QPushButton*>(QStringLiteral("Restore")), Qt::LeftButton);
    QVERIFY(text() != original);
    QVERIFY(panel_->save());
    QVERIFY(text_of(file_).find("time_s: 1.75") != std::string::npos);
  }

  void recovers_a_motion_that_was_never_saved() {
    open_copy("greet.yaml");
    action("new")->trigger();
    type_into(0, StepModel::kTime, "1.75");
    const std::string begun = text();
    editor().findChild<QTimer*>()->setInterval(1);
    QTRY_VERIFY_WITH_TIMEOUT(!find_recovery_files().empty(), kPatience_ms);
    editor().keep_recovery();
    open(file_);
    auto* const bar = panel_->findChild<OfferBar*>(QStringLiteral("recovery"));
    QTest::mouseClick(bar->findChild<QPushButton*>(QStringLiteral("Restore")), Qt::LeftButton);
    COMPARE_TEXT(text(), begun);
    QVERIFY(panel_->file().empty());
    QVERIFY(panel_->modified());
  }

  void notices_changes_by_other_programs() {
    open_copy("wave.yaml");
    const std::string other = with(text(), "time_s: 1.5", "time_s: 2.5");
    auto* const bar = panel_->findChild<OfferBar*>(QStringLiteral("disk"));
    QVERIFY(panel_->save());
    QVERIFY(!bar->isVisible());
    write(file_, other);
    QTRY_VERIFY_WITH_TIMEOUT(bar->isVisible(), kPatience_ms);
    // Save does not overwrite it unasked.
    type_into(1, StepModel::kTime, "1.25");
    QVERIFY(!panel_->save());
    QVERIFY(panel_->findChild<MessageLine*>()->text().startsWith(QStringLiteral("Not saved")));
    COMPARE_TEXT(text_of(file_), other);
    const std::string mine = text();
    for (auto* const button : bar->findChildren<QPushButton*>()) {
      if (button->text().startsWith(QStringLiteral("Reload")) && button->isVisible()) {
        QTest::mouseClick(button, Qt::LeftButton);
        break;
      }
    }
    COMPARE_TEXT(text(), other);
    QVERIFY(!panel_->modified());
    press("undo");
    COMPARE_TEXT(text(), mine);
    press("redo");
    // A file that is replaced, as editors do it, and then removed.
    write(in_folder("new"), with(other, "time_s: 2.5", "time_s: 3.5"));
    fs::rename(in_folder("new"), file_);
    QTRY_VERIFY_WITH_TIMEOUT(bar->isVisible(), kPatience_ms);
    QTest::mouseClick(bar->findChild<QPushButton*>(QStringLiteral("Overwrite")), Qt::LeftButton);
    COMPARE_TEXT(text_of(file_), other);
    fs::remove(file_);
    QTRY_VERIFY_WITH_TIMEOUT(bar->isVisible(), kPatience_ms);
    QVERIFY(panel_->save());
    COMPARE_TEXT(text_of(file_), other);
    QVERIFY(!bar->isVisible());
  }
};

static const test::AddQtTest<MotionFilesTest> kMotionFilesTest;

// Changes the first step's time as an edit of the panel, saves automatically, and waits to be killed.
static int edit_and_wait(const char* file) {
  MotionPanel panel;
  panel.show();
  if (panel.open(file, kRobot)) return 1;
  auto& editor = *panel.findChild<MotionEditor*>();
  editor.findChild<QTimer*>()->setInterval(1);
  const std::size_t first = 0;
  editor.edit([&](MotionDocument& document) { document.set_time({&first, 1}, 1.75); });
  return QApplication::exec();
}

}  // namespace koboshi::studio

int main(int argc, char** argv) {
  QApplication application(argc, argv);
  if (argc == 3 && std::string_view(argv[1]) == koboshi::studio::kEditAndWait)
    return koboshi::studio::edit_and_wait(argv[2]);
  return koboshi::test::run_qt_tests(argc, argv);
}

#include "motion_files_test.moc"
