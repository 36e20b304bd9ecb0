#pragma once

#include <QAction>
#include <QApplication>
#include <QPushButton>
#include <QSettings>
#include <QSignalSpy>
#include <QTest>
#include <filesystem>
#include <memory>

#include "studio/widgets/command_search.h"
#include "studio/window/main_window.h"

// The window of a test of the studio. QtTest's macros return from the function in which they are, so helpers
// return whether they have worked.
namespace koboshi::studio::test {

constexpr int kPatience_ms = 20'000;
inline const std::filesystem::path kRoot = KOBOSHI_SOURCE_DIR;

// Makes a window of the usual size with forgotten settings, shows it, and makes it the active one. Null: it
// did not become active.
inline std::unique_ptr<MainWindow> make_window(
    const std::filesystem::path& robot = kRoot / "robots/koboshi/robot.sdf") {
  QSettings().clear();
  auto window = std::make_unique<MainWindow>(robot);
  window->resize(1280, 800);
  window->show();
  if (!QTest::qWaitForWindowExposed(window.get())) return nullptr;
  window->activateWindow();
  return QTest::qWaitForWindowActive(window.get()) ? std::move(window) : nullptr;
}

inline bool open(MainWindow& window, const std::filesystem::path& file) {
  QSignalSpy opened(&window.run(), &RunController::opened);
  window.open(file);
  return opened.wait(kPatience_ms);
}

// Runs the simulation as fast as possible up to this time, and pauses it.
inline bool run_to(MainWindow& window, std::uint64_t time_us) {
  RunController& run = window.run();
  if (run.session() != nullptr) run.session()->wait();  // a run begins with a step of its own
  const std::uint64_t now_us =
      run.session() != nullptr ? run.session()->status().time_us : run.status().time_us;
  run.step((time_us - now_us) / 1000);
  return QTest::qWaitFor([&] { return run.end_us() >= time_us; }, kPatience_ms);
}

// The action with this text, without its mnemonic; null: none.
inline QAction* action(const MainWindow& window, const char* text) {
  for (QAction* one : window.all_actions())
    if (plain_text(*one) == QLatin1String(text)) return one;
  return nullptr;
}

// Clicks a button by its name. False: there is none.
inline bool click(const MainWindow& window, const char* name) {
  auto* button = window.findChild<QPushButton*>(QLatin1String(name));
  if (button == nullptr) return false;
  QTest::mouseClick(button, Qt::LeftButton);
  return true;
}

// Whether the present test only saves pictures, and nobody has asked for them.
inline bool is_for_eyes_alone() {
  return qstrcmp(QTest::currentTestFunction(), "pictures") == 0 &&
         qEnvironmentVariableIsEmpty("KOBOSHI_PICTURES");
}

// Grabs a picture of the window into the folder KOBOSHI_PICTURES, if there is one; for eyes.
inline void save_picture(MainWindow& window, const char* name) {
  const QString pictures = qEnvironmentVariable("KOBOSHI_PICTURES");
  if (pictures.isEmpty()) return;
  QTest::qWait(500);
  window.grab().save(pictures + u'/' + QLatin1String(name) + QStringLiteral(".png"));
}

// Runs tests in an application whose settings are not those of the studio.
template <typename Run>
int run_in_application(int argc, char** argv, const Run& run) {
  QApplication application(argc, argv);
  QApplication::setOrganizationName(QStringLiteral("Koboshi"));
  QApplication::setApplicationName(QStringLiteral("Koboshi Studio Test"));
  return run();
}

// The main function of a test program with a window.
template <typename Test>
int run_window_test(int argc, char** argv) {
  return run_in_application(argc, argv, [&] {
    Test test;
    return QTest::qExec(&test, argc, argv);
  });
}

}  // namespace koboshi::studio::test
