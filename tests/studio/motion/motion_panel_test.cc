#include "tools/studio/motion/motion_panel.h"

#include <QAction>
#include <QApplication>
#include <QCheckBox>
#include <QClipboard>
#include <QDoubleSpinBox>
#include <QLineEdit>
#include <QPushButton>
#include <QSignalSpy>
#include <QSlider>
#include <QStyleFactory>
#include <QTableView>
#include <QTemporaryDir>
#include <QTest>
#include <algorithm>
#include <fstream>
#include <memory>
#include <sstream>
#include <string>

#include "tools/studio/motion/joint_panel.h"
#include "tools/studio/motion/message_line.h"
#include "tools/studio/motion/offer_bar.h"
#include "tools/studio/motion/step_model.h"
#include "tools/studio/motion/timeline.h"

namespace koboshi::studio {
namespace {

namespace fs = std::filesystem;

const fs::path kRobot = KOBOSHI_SOURCE_DIR "/robots/koboshi/robot.sdf";
const fs::path kMotions = KOBOSHI_SOURCE_DIR "/robots/koboshi/motions";
constexpr int kPatience_ms = 60'000;  // only a failed test waits as long

std::string text_of(const fs::path& file) {
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
}

[[maybe_unused]] void write(const fs::path& file, const std::string& text) { std::ofstream(file, std::ios::binary) << text; }

// The text with one place changed.
std::string with(std::string text, const std::string& before, const std::string& after) {
  const std::size_t at = text.find(before);
  if (at == std::string::npos) qFatal("no such text");
  return text.replace(at, before.size(), after);
}

QPalette dark_palette() {
  QPalette palette;
  const QColor text(222, 226, 232);
  palette.setColor(QPalette::Window, QColor(44, 48, 54));
  palette.setColor(QPalette::WindowText, text);
  palette.setColor(QPalette::Base, QColor(30, 33, 38));
  palette.setColor(QPalette::AlternateBase, QColor(37, 41, 47));
  palette.setColor(QPalette::Text, text);
  palette.setColor(QPalette::Button, QColor(53, 58, 65));
  palette.setColor(QPalette::ButtonText, text);
  palette.setColor(QPalette::Highlight, QColor(48, 120, 190));
  palette.setColor(QPalette::HighlightedText, Qt::white);
  palette.setColor(QPalette::ToolTipBase, QColor(60, 66, 74));
  palette.setColor(QPalette::ToolTipText, text);
  palette.setColor(QPalette::PlaceholderText, QColor(140, 146, 154));
  for (const auto role : {QPalette::Text, QPalette::WindowText, QPalette::ButtonText})
    palette.setColor(QPalette::Disabled, role, QColor(120, 126, 134));
  return palette;
}

}  // namespace

// A panel with a copy of a motion in a folder of its own, and real events.
class MotionPanelTest final : public QObject {
  Q_OBJECT

 private:
  std::unique_ptr<QTemporaryDir> folder_;
  std::unique_ptr<MotionPanel> panel_;
  fs::path file_;

  fs::path in_folder(const std::string& name) const { return fs::path(folder_->path().toStdString()) / name; }
  void open(const fs::path& file) {
    panel_ = std::make_unique<MotionPanel>();
    panel_->resize(1280, 720);
    panel_->show();
    QVERIFY(QTest::qWaitForWindowExposed(panel_.get()));
    QApplication::setActiveWindow(panel_.get());
    const auto error = panel_->open(file, kRobot);
    QVERIFY2(!error, qPrintable(error.value_or(QString())));
  }
  void open_copy(const char* name) {
    file_ = in_folder(name);
    fs::copy_file(kMotions / name, file_);
    open(file_);
  }
  MotionEditor& editor() const { return *panel_->findChild<MotionEditor*>(); }
  QTableView& table() const { return *panel_->findChild<QTableView*>(QStringLiteral("steps")); }
  StepModel& model() const { return *panel_->findChild<StepModel*>(); }
  Timeline& timeline() const { return *panel_->findChild<Timeline*>(); }
  const std::string& text() const { return editor().document().text(); }
  std::size_t undo_count() const { return editor().document().history().undo_count(); }
  QAction* action(const char* name) const { return panel_->findChild<QAction*>(QString::fromLatin1(name)); }
  QString cell(int row, int column) const { return model().index(row, column).data().toString(); }
  QString finding(int row) const { return cell(row, StepModel::kFinding); }
  QSlider* slider(const char* joint) const { return panel_->findChild<QSlider*>(QString::fromLatin1(joint)); }
  std::size_t joint(const char* name) const {
    const auto& names = editor().document().robot().model.joint_names;
    return static_cast<std::size_t>(std::ranges::find(names, name) - names.begin());
  }
  // Sends the keys of a shortcut to the table.
  void press(const char* name) {
    table().setFocus();
    const QKeyCombination keys = action(name)->shortcut()[0];
    QTest::keyClick(&table(), keys.key(), keys.keyboardModifiers());
  }
  void type_into(int row, int column, const char* value) {
    const QModelIndex index = model().index(row, column);
    table().scrollTo(index);
    QTest::mouseClick(table().viewport(), Qt::LeftButton, {}, table().visualRect(index).center());
    QTest::mouseDClick(table().viewport(), Qt::LeftButton, {}, table().visualRect(index).center());
    auto* const edit = table().viewport()->findChild<QLineEdit*>();
    QVERIFY(edit != nullptr);
    edit->selectAll();
    QTest::keyClicks(edit, QString::fromLatin1(value));
    QTest::keyClick(edit, Qt::Key_Return);
  }
  void wait_for_check() { QTRY_VERIFY_WITH_TIMEOUT(!editor().is_checking(), kPatience_ms); }
  void grab(const char* name) {
    const QString out = qEnvironmentVariable("KOBOSHI_GRAB");
    if (!out.isEmpty()) panel_->grab().save(out + u'/' + QString::fromLatin1(name) + QStringLiteral(".png"));
  }

 private Q_SLOTS:
  void init() {
    folder_ = std::make_unique<QTemporaryDir>();
    qputenv("XDG_STATE_HOME", folder_->path().toUtf8());
  }
  void cleanup() {
    panel_.reset();
    folder_.reset();
  }

  void edits_reach_the_file_to_the_byte() {
    open_copy("wave.yaml");
    const std::string original = text_of(file_);
    std::vector<double> pose;
    connect(panel_.get(), &MotionPanel::pose_changed, this,
            [&](const std::vector<double>& angles) { pose = angles; });

    // A drag of a slider is one step of the history.
    panel_->show_row(1);
    QSlider* const elbow = slider("right_elbow");
    QStyleOptionSlider option;
    option.initFrom(elbow);
    option.orientation = Qt::Horizontal;
    option.minimum = elbow->minimum();
    option.maximum = elbow->maximum();
    option.sliderPosition = option.sliderValue = elbow->sliderPosition();
    const QRect handle =
        elbow->style()->subControlRect(QStyle::CC_Slider, &option, QStyle::SC_SliderHandle, elbow);
    QTest::mousePress(elbow, Qt::LeftButton, {}, handle.center());
    for (int i = 1; i <= 5; ++i) QTest::mouseMove(elbow, handle.center() + QPoint(2 * i, 0));
    QTest::mouseRelease(elbow, Qt::LeftButton, {}, handle.center() + QPoint(10, 0));
    QCOMPARE(undo_count(), std::size_t{1});
    QVERIFY(text() != original);
    QVERIFY(std::abs(pose.at(joint("right_elbow")) - elbow->value() / 100.0 * 3.14159265358979 / 180.0) <
            1e-4);
    press("undo");
    QCOMPARE(text(), original);

    // A typed angle.
    auto* const box = panel_->findChild<JointPanel*>()->spin_box(joint("right_elbow"));
    box->setFocus();
    box->selectAll();
    QTest::keyClicks(box, QStringLiteral("-50"));
    QTest::keyClick(box, Qt::Key_Return);
    std::string expected = with(original, "right_elbow: -45", "right_elbow: -50");
    QCOMPARE(text(), expected);
    // Undo in the spin box concerns the motion.
    QTest::keyClick(box, Qt::Key_Z, Qt::ControlModifier);
    QCOMPARE(text(), original);
    press("redo");
    QCOMPARE(text(), expected);

    type_into(0, StepModel::kTime, "1.75");
    expected = with(expected, "{pose: stand, time_s: 1.5}", "{pose: stand, time_s: 1.75}");
    QCOMPARE(text(), expected);
    type_into(2, StepModel::kStep, "6");
    expected = with(expected, "times: 4", "times: 6");
    QCOMPARE(text(), expected);

    panel_->show_row(0);
    press("insert_wait");
    expected = with(expected, "time_s: 1.75}\n", "time_s: 1.75}\n  - {wait_s: 0.5}\n");
    QCOMPARE(text(), expected);
    QCOMPARE(table().currentIndex().row(), 1);

    // Scales by the bar in the panel.
    press("scale_time");
    auto* const scale = panel_->findChild<QDoubleSpinBox*>(QStringLiteral("scale"));
    QVERIFY(scale->isVisible());
    scale->setValue(200);
    QTest::mouseClick(panel_->findChild<QPushButton*>(QStringLiteral("apply_scale")), Qt::LeftButton);
    QVERIFY(!scale->isVisible());
    expected = with(expected, "wait_s: 0.5", "wait_s: 1");
    QCOMPARE(text(), expected);
    QTest::keyClick(&table(), Qt::Key_S, Qt::ControlModifier);
    QVERIFY(!panel_->modified());
    QCOMPARE(text_of(file_), expected);

    // Ten edits, ten times undo: the bytes of the beginning.
    const char* const edits[]{"mirror", "duplicate", "insert_pose", "duplicate",
                              "delete", "move_up",   "insert_loop", "mirror_motion"};
    panel_->show_row(2);
    const std::size_t before = undo_count();
    for (const char* const name : edits) {
      const std::string last = text();
      press(name);
      QVERIFY2(text() != last, name);
    }
    panel_->show_row(3);
    type_into(0, StepModel::kTime, "2");
    type_into(0, StepModel::kPause, "0.25");
    QCOMPARE(undo_count(), before + 10);
    const std::string last = text();
    for (int i = 0; i < 10; ++i) press("undo");
    QCOMPARE(text(), expected);
    QVERIFY(!panel_->modified());
    for (int i = 0; i < 10; ++i) press("redo");
    QCOMPARE(text(), last);
    while (undo_count() > 0) press("undo");
    QCOMPARE(text(), original);
  }

  void findings_mark_their_rows() {
    open_copy("wave.yaml");
    wait_for_check();
    for (int row = 0; row < model().rowCount(); ++row)
      QVERIFY2(finding(row).isEmpty(), qPrintable(finding(row)));
    // The compiler: too fast.
    type_into(1, StepModel::kTime, "0.02");
    QVERIFY2(finding(1).startsWith(u'M'), qPrintable(finding(1)));
    QVERIFY(finding(0).isEmpty());
    QVERIFY(!model().index(1, StepModel::kFinding).data(Qt::ToolTipRole).toString().isEmpty());
    press("undo");
    QVERIFY(finding(1).isEmpty());
    // The check, later: the pose falls.
    panel_->show_row(1);
    const std::size_t hip = joint("left_hip_pitch");
    panel_->findChild<JointPanel*>()->spin_box(hip)->setValue(-60);
    QTRY_VERIFY_WITH_TIMEOUT(finding(1).startsWith(u'C'), kPatience_ms);
    QVERIFY2(finding(0).isEmpty(), qPrintable(finding(0)));
    QVERIFY(!panel_->findChild<MessageLine*>()->text().isEmpty());
    // A click on the message leads to the step.
    panel_->show_row(6);
    QTest::keyClick(&table(), Qt::Key_F8, Qt::ShiftModifier);
    press("next_finding");
    grab("finding");
    QTest::mouseClick(panel_->findChild<QPushButton*>(QStringLiteral("message")), Qt::LeftButton);
    QVERIFY(!finding(table().currentIndex().row()).isEmpty());
    press("undo");
    QTRY_VERIFY_WITH_TIMEOUT(finding(1).isEmpty(), kPatience_ms);
  }

  void looks_right() {
    if (qEnvironmentVariableIsEmpty("KOBOSHI_GRAB")) QSKIP("KOBOSHI_GRAB names no folder");
    const QPalette light = QApplication::palette();
    for (const bool dark : {false, true}) {
      QApplication::setStyle(QStyleFactory::create(QStringLiteral("Fusion")));
      QApplication::setPalette(dark ? dark_palette() : light);
      for (const char* const name : {"greet", "rise_prone", "balance", "wave", "squat"}) {
        open(kMotions / (std::string(name) + ".yaml"));
        wait_for_check();
        panel_->show_row(1);
        panel_->findChild<JointPanel*>()->joint_chosen(joint("right_knee"));
        QCoreApplication::processEvents();
        grab((std::string(name) + (dark ? "_dark" : "_light")).c_str());
      }
    }
    QApplication::setPalette(light);
  }
};

}  // namespace koboshi::studio

QTEST_MAIN(koboshi::studio::MotionPanelTest)
#include "motion_panel_test.moc"
