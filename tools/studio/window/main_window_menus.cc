// The menus of the main window.

#include <QAction>
#include <QApplication>
#include <QDockWidget>
#include <QMenuBar>
#include <QSettings>
#include <QStatusBar>
#include <array>
#include <numbers>
#include <optional>
#include <string>
#include <utility>

#include "tools/studio/motion/motion_panel.h"
#include "tools/studio/window/command_search.h"
#include "tools/studio/window/main_window.h"
#include "tools/studio/window/operator_panel.h"
#include "tools/studio/window/pose_controller.h"
#include "tools/studio/window/theme.h"
#include "tools/studio/window/transport_bar.h"
#include "tools/teleop/key.h"

namespace koboshi::studio {
namespace {

// Directions from which to look at the robot, as in `koboshi render --view`.
struct NamedView {
  const char* name;
  Qt::Key key;
  double azimuth_deg;
  double elevation_deg;
};
constexpr std::array<NamedView, 4> kViews{
    {{QT_TRANSLATE_NOOP("MainWindow", "From the front"), Qt::Key_1, 0.0, 6.0},
     {QT_TRANSLATE_NOOP("MainWindow", "From the left"), Qt::Key_2, 90.0, 6.0},
     {QT_TRANSLATE_NOOP("MainWindow", "From above"), Qt::Key_3, 180.0, 90.0},
     {QT_TRANSLATE_NOOP("MainWindow", "Diagonally"), Qt::Key_4, 50.0, 14.0}}};

// The texts of Overlay that belong to the world; time, events and legend have panels of their own.
struct OverlayText {
  view::Overlay overlay;
  const char* text;
  bool shown;
};
constexpr std::array<OverlayText, 6> kOverlayTexts{
    {{view::Overlay::kZmp, QT_TRANSLATE_NOOP("MainWindow", "Zero moment point"), true},
     {view::Overlay::kCom, QT_TRANSLATE_NOOP("MainWindow", "Centre of mass"), false},
     {view::Overlay::kSupport, QT_TRANSLATE_NOOP("MainWindow", "Support polygon"), true},
     {view::Overlay::kContacts, QT_TRANSLATE_NOOP("MainWindow", "Contact forces"), false},
     {view::Overlay::kPushes, QT_TRANSLATE_NOOP("MainWindow", "Pushes"), true},
     {view::Overlay::kFootprints, QT_TRANSLATE_NOOP("MainWindow", "Footprints of a recorded run"), true}}};

QString tr_view(const char* text) { return QCoreApplication::translate("MainWindow", text); }

}  // namespace

QAction* MainWindow::add_action(QMenu& menu, const QString& text, const QKeySequence& shortcut,
                                const std::function<void()>& does) {
  QAction* action = menu.addAction(text);
  action->setShortcut(shortcut);
  if (does) connect(action, &QAction::triggered, this, does);
  return action;
}

void MainWindow::make_menus() {
  QMenu* file = menuBar()->addMenu(tr("&File"));
  add_action(*file, tr("&Open scenario, motion or run..."), QKeySequence::Open, [this] { choose_file(); });
  add_action(*file, tr("&Attach to a CAN bus..."), QKeySequence(tr("Ctrl+Shift+B")),
             [this] { choose_bus(); });
  file->addSeparator();
  file->addActions(motion_->file_actions());
  add_action(*file, tr("&Upload the motion to a robot"), QKeySequence(tr("Ctrl+Shift+T")),
             [this] { upload_motion(); });
  file->addSeparator();
  add_action(*file, tr("&Quit"), QKeySequence::Quit, [this] { close(); });
  QMenu* edit = menuBar()->addMenu(tr("&Edit"));
  edit->addActions(motion_->edit_actions());
  poses_->fill_menu(*menuBar()->addMenu(tr("&Pose")));
  QMenu* run = menuBar()->addMenu(tr("&Run"));
  run->addActions(findChild<TransportBar*>()->actions());
  add_action(*run, tr("Start &again with seed and stepper"), QKeySequence(tr("Ctrl+Shift+R")),
             [this] { operator_->restart(); });
  add_action(*run, tr("To the &beginning"), Qt::Key_Home, [this] { run_->set_cursor(0); });
  add_action(*run, tr("To the &end"), Qt::Key_End, [this] { run_->set_cursor(run_->end_us()); });
  loop_ = add_action(*run, tr("&Loop the playback"), QKeySequence(tr("Ctrl+Shift+L")), {});
  loop_->setCheckable(true);
  loop_->setToolTip(tr("Play a preview or a recorded run again from where the playback began"));
  make_robot_menu();
  make_view_menu();
  QMenu* help = menuBar()->addMenu(tr("&Help"));
  add_action(*help, tr("&Search commands"), QKeySequence(tr("Ctrl+K")), [this] { search_->setFocus(); });
  add_action(*help, tr("&About Koboshi"), {},
             [this] { statusBar()->showMessage(tr("Koboshi %1").arg(QStringLiteral(KOBOSHI_VERSION))); });
  menuBar()->setCornerWidget(search_);
  search_->set_actions(all_actions());
}

// The operator's keys, as in a terminal and in the live page; Ctrl+Alt keeps them apart from the keys of
// other panels.
void MainWindow::make_robot_menu() {
  QMenu* menu = menuBar()->addMenu(tr("R&obot"));
  for (const tools::KeyHelp& help : tools::key_help()) {
    const std::optional<tools::Key> key = tools::key_of_browser(help.browser_keys.front());
    if (!key || *key == tools::Key::kEnd) continue;
    std::string name = help.browser_keys.front();
    if (name.starts_with("Arrow")) name.erase(0, 5);
    if (name == " ") name = "Space";
    QString text = QCoreApplication::translate("Key", std::string(help.name).c_str());
    if (!text.isEmpty()) text[0] = text[0].toUpper();
    add_action(*menu, text, QKeySequence(QStringLiteral("Ctrl+Alt+") + QString::fromStdString(name)),
               [this, key = *key] { operator_->press(key); });
  }
}

void MainWindow::make_view_menu() {
  QMenu* menu = menuBar()->addMenu(tr("&View"));
  for (const NamedView& named : kViews) {
    add_action(*menu, tr_view(named.name), QKeySequence(named.key), [this, &named] {
      constexpr double kRad = std::numbers::pi / 180.0;  // per degree
      view_->look_from(kRad * named.azimuth_deg, kRad * named.elevation_deg);
    });
  }
  add_action(*menu, tr("Look at the &robot"), Qt::Key_F, [this] { view_->look_at_robot(); });
  QAction* follow = add_action(*menu, tr("&Follow the robot"), QKeySequence(tr("Ctrl+F")), {});
  follow->setCheckable(true);
  follow->setChecked(true);
  connect(follow, &QAction::toggled, view_, &RobotView::set_follow);
  QAction* collisions = add_action(*menu, tr("&Collision shapes"), QKeySequence(tr("Ctrl+Shift+C")), {});
  collisions->setCheckable(true);
  connect(collisions, &QAction::toggled, view_, &RobotView::set_collisions);
  const auto add_switch = [&](const QString& text, const QKeySequence& keys, void (RobotView::*set)(bool)) {
    QAction* action = add_action(*menu, text, keys, {});
    action->setCheckable(true);
    connect(action, &QAction::toggled, view_, set);
  };
  add_switch(tr("&Link frames"), QKeySequence(tr("Ctrl+5")), &RobotView::set_link_frames);
  add_switch(tr("&Joint axes"), QKeySequence(tr("Ctrl+6")), &RobotView::set_joint_axes);
  add_switch(tr("&Exploded view"), QKeySequence(tr("Ctrl+7")), &RobotView::set_exploded);
  menu->addSeparator();
  for (const OverlayText& row : kOverlayTexts) {
    QAction* action = add_action(*menu, tr_view(row.text), {}, {});
    action->setCheckable(true);
    action->setChecked(row.shown);
    overlay_actions_[static_cast<std::size_t>(row.overlay)] = action;
    connect(action, &QAction::toggled, this, &MainWindow::show_marks);
  }
  menu->addSeparator();
  panels_menu_ = menu->addMenu(tr("&Panels"));
  for (QDockWidget* dock : findChildren<QDockWidget*>()) panels_menu_->addAction(dock->toggleViewAction());
  add_action(*panels_menu_, tr("&Default layout"), {}, [this] { reset_layout(); });
  QAction* dark = add_action(*menu, tr("&Dark colours"), QKeySequence(tr("Ctrl+Shift+D")), {});
  dark->setCheckable(true);
  dark->setChecked(QSettings().value(QStringLiteral("dark"), false).toBool());
  connect(dark, &QAction::toggled, this, [](bool on) {
    apply_theme(on ? Theme::kDark : Theme::kLight);
    QSettings().setValue(QStringLiteral("dark"), on);
  });
  apply_theme(dark->isChecked() ? Theme::kDark : Theme::kLight);
  QAction* full = add_action(*menu, tr("Full &screen"), QKeySequence(Qt::Key_F11), {});
  full->setCheckable(true);
  connect(full, &QAction::toggled, this,
          [this](bool on) { setWindowState(windowState().setFlag(Qt::WindowFullScreen, on)); });
}

QList<QAction*> MainWindow::all_actions() const {
  QList<QAction*> all;
  for (const QMenu* menu : menuBar()->findChildren<QMenu*>()) {
    for (QAction* action : menu->actions())
      if (!action->isSeparator() && action->menu() == nullptr && !action->text().isEmpty() &&
          !all.contains(action))
        all << action;
  }
  return all;
}

}  // namespace koboshi::studio
