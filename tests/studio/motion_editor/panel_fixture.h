#pragma once

#include <QAction>
#include <QApplication>
#include <QLineEdit>
#include <QSlider>
#include <QTableView>
#include <QTemporaryDir>
#include <QTest>
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include "studio/motion_editor/motion_panel.h"
#include "studio/motion_editor/step_model.h"
#include "studio/motion_editor/timeline.h"
#include "tests/support/large_motion.h"

namespace koboshi::studio {

namespace fs = std::filesystem;

inline const fs::path kRobot = KOBOSHI_SOURCE_DIR "/robots/koboshi/robot.sdf";
inline const fs::path kMotions = KOBOSHI_SOURCE_DIR "/robots/koboshi/motions";
inline constexpr int kLargeSteps = 1000;
inline constexpr int kPatience_ms = 30'000;  // only a failed test waits as long

inline std::string text_of(const fs::path& file) {
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
}

inline void write(const fs::path& file, const std::string& text) {
  std::ofstream(file, std::ios::binary) << text;
}

// The text with one place changed.
inline std::string with(std::string text, const std::string& before, const std::string& after) {
  const std::size_t at = text.find(before);
  if (at == std::string::npos) qFatal("no such text");
  return text.replace(at, before.size(), after);
}

// The first line that differs.
inline QByteArray difference(const std::string& actual, const std::string& expected) {
  std::istringstream one(actual);
  std::istringstream other(expected);
  std::string line;
  std::string wanted;
  while (std::getline(one, line) && std::getline(other, wanted) && line == wanted) {
  }
  return QByteArray::fromStdString("has:   " + line + "\nwants: " + wanted);
}

#define COMPARE_TEXT(actual, ...) \
  QVERIFY2((actual) == (__VA_ARGS__), difference(actual, __VA_ARGS__).constData())

inline QPalette dark_palette() {
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

// A panel with a copy of a motion in a folder of its own, and real events.
class PanelFixture : public QObject {
 protected:
  std::unique_ptr<QTemporaryDir> folder_;
  std::unique_ptr<MotionPanel> panel_;
  fs::path file_;

  fs::path in_folder(const std::string& name) const { return fs::path(folder_->path().toStdString()) / name; }
  void open(const fs::path& file) {
    panel_.reset();
    panel_ = std::make_unique<MotionPanel>();
    panel_->resize(1280, 720);
    panel_->show();
    QVERIFY(QTest::qWaitForWindowExposed(panel_.get()));
    panel_->activateWindow();
    QVERIFY(QTest::qWaitForWindowActive(panel_.get()));
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
  // Sends the keys of a shortcut to the table; an action whose key is that of the window is triggered.
  void press(const char* name) {
    table().setFocus();
    if (action(name)->shortcut().isEmpty()) return action(name)->trigger();
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
    // The table takes the value over by an event, and removes the editor by another one.
    QCoreApplication::processEvents();
    QCoreApplication::sendPostedEvents(nullptr, QEvent::DeferredDelete);
  }
  fs::path large_motion(const std::string& time_s = "1.5") const {
    const auto nod = [](int i) { return "{head_tilt: 0." + std::to_string(1000 + i) + "}"; };
    const fs::path file = in_folder("large.yaml");
    write(file, koboshi::test::large_motion(kLargeSteps, nod, time_s));
    return file;
  }
  // Also those of open documents.
  static std::vector<fs::path> find_recovery_files() {
    std::vector<fs::path> files;
    std::error_code none;
    for (const auto& entry : fs::directory_iterator(default_recovery_folder(), none)) {
      if (entry.path().extension() == ".recovery") files.push_back(entry.path());
    }
    return files;
  }
  void wait_for_check() { QTRY_VERIFY_WITH_TIMEOUT(!editor().is_checking(), kPatience_ms); }
  void grab(const char* name) {
    const QString out = qEnvironmentVariable("KOBOSHI_GRAB");
    if (!out.isEmpty()) panel_->grab().save(out + u'/' + QString::fromLatin1(name) + QStringLiteral(".png"));
  }
  void prepare() {
    folder_ = std::make_unique<QTemporaryDir>();
    qputenv("XDG_STATE_HOME", folder_->path().toUtf8());
  }
  void clean_up() {
    panel_.reset();
    folder_.reset();
  }
};

}  // namespace koboshi::studio
