// The menus of the main window.

#include <QAction>
#include <QApplication>
#include <QMenuBar>
#include <QSettings>
#include <QStatusBar>
#include <algorithm>
#include <array>
#include <numbers>
#include <optional>
#include <string>
#include <utility>

#include "sim_board/board/sim_board.h"
#include "studio/controls/operator_panel.h"
#include "studio/controls/transport_bar.h"
#include "studio/motion_editor/motion_panel.h"
#include "studio/widgets/command_search.h"
#include "studio/widgets/theme.h"
#include "studio/window/documents.h"
#include "studio/window/main_window.h"
#include "studio/window/motion_playback.h"
#include "studio/window/panels.h"
#include "studio/window/pose_controller.h"
#include "tools/teleop/key.h"
#include "view/render/looks.h"

namespace koboshi::studio {
namespace {

// The texts of view::kNamedViews.
constexpr std::array<const char*, view::kNamedViews.size()> kViewTexts{
    QT_TRANSLATE_NOOP("MainWindow", "From the front"), QT_TRANSLATE_NOOP("MainWindow", "From the left"),
    QT_TRANSLATE_NOOP("MainWindow", "From above"), QT_TRANSLATE_NOOP("MainWindow", "Diagonally")};

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
     {view::Overlay::kFootprints, QT_TRANSLATE_NOOP("MainWindow", "Footprints"), true}}};

// The operator's keys, apart from the one that ends a run. Desktops take Ctrl+Alt with an arrow to change the
// workspace: there is a letter for each arrow.
struct KeyText {
  tools::Key key;
  const char* text;
  Qt::Key letter = Qt::Key_unknown;
};
constexpr std::array<KeyText, 15> kKeyTexts{
    {{tools::Key::kForward, QT_TRANSLATE_NOOP("Key", "Forward"), Qt::Key_W},
     {tools::Key::kBackward, QT_TRANSLATE_NOOP("Key", "Backward"), Qt::Key_S},
     {tools::Key::kTurnLeft, QT_TRANSLATE_NOOP("Key", "Turn left"), Qt::Key_J},
     {tools::Key::kTurnRight, QT_TRANSLATE_NOOP("Key", "Turn right"), Qt::Key_L},
     {tools::Key::kLeft, QT_TRANSLATE_NOOP("Key", "Left")},
     {tools::Key::kRight, QT_TRANSLATE_NOOP("Key", "Right")},
     {tools::Key::kGo, QT_TRANSLATE_NOOP("Key", "Go")},
     {tools::Key::kStop, QT_TRANSLATE_NOOP("Key", "Stop")},
     {tools::Key::kPush, QT_TRANSLATE_NOOP("Key", "Push")},
     {tools::Key::kPushMore, QT_TRANSLATE_NOOP("Key", "Push more")},
     {tools::Key::kPushLess, QT_TRANSLATE_NOOP("Key", "Push less")},
     {tools::Key::kEnable, QT_TRANSLATE_NOOP("Key", "Enable")},
     {tools::Key::kGetUp, QT_TRANSLATE_NOOP("Key", "Get up")},
     {tools::Key::kEmergencyStop, QT_TRANSLATE_NOOP("Key", "Emergency stop")},
     {tools::Key::kReset, QT_TRANSLATE_NOOP("Key", "Reset")}}};

// A key that a browser names, as Qt names it.
QString key_name(std::string_view browser_key) {
  if (browser_key == " ") return QStringLiteral("Space");
  const QString name = QString::fromUtf8(browser_key.data(), static_cast<qsizetype>(browser_key.size()));
  if (name.size() == 1 && name.front().isUpper()) return QStringLiteral("Shift+") + name;
  return name.startsWith(QLatin1String("Arrow")) ? name.sliced(5) : name;
}

QString key_name(tools::Key key) {
  for (const tools::KeyHelp& help : tools::key_help())
    if (help.name == tools::name_of(key)) return key_name(help.browser_keys.front());
  return {};
}

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
  QAction* save = add_action(*file, tr("&Save"), QKeySequence::Save, [this] { documents_->save(); });
  save->setObjectName(QStringLiteral("save"));
  save->setToolTip(tr("Save the active document"));
  file->addActions(motion().file_actions());
  add_action(*file, tr("&Upload the motion to a robot"), QKeySequence(tr("Ctrl+Shift+T")),
             [this] { playback_->upload(bus_.toStdString(), bus_options_); });
  file->addSeparator();
  add_action(*file, tr("&Quit"), QKeySequence::Quit, [this] { close(); });
  QMenu* edit = menuBar()->addMenu(tr("&Edit"));
  QAction* undo = add_action(*edit, tr("&Undo"), QKeySequence(tr("Ctrl+Z")), [this] { documents_->undo(); });
  undo->setToolTip(tr("Take the last change of the active document back"));
  QAction* redo = add_action(*edit, tr("&Redo"), {}, [this] { documents_->redo(); });
  redo->setShortcuts({QKeySequence(tr("Ctrl+Y")), QKeySequence(tr("Ctrl+Shift+Z"))});
  redo->setToolTip(tr("Make the change of the active document again"));
  edit->addSeparator();
  edit->addActions(motion().edit_actions());
  poses_->fill_menu(*menuBar()->addMenu(tr("&Pose")));
  make_run_menu();
  make_robot_menu();
  make_view_menu();
  panels_->add_menus(*menuBar());
  QMenu* help = menuBar()->addMenu(tr("&Help"));
  add_action(*help, tr("&Search commands"), QKeySequence(tr("Ctrl+K")), [this] { search_->setFocus(); });
  add_action(*help, tr("&About Koboshi"), QKeySequence(Qt::Key_F1),
             [this] { statusBar()->showMessage(tr("Koboshi %1").arg(QStringLiteral(KOBOSHI_VERSION))); });
  menuBar()->setCornerWidget(search_);
  search_->set_actions(all_actions());
}

void MainWindow::make_run_menu() {
  QMenu* run = menuBar()->addMenu(tr("&Run"));
  run->addActions(findChild<TransportBar*>()->actions());
  add_action(*run, tr("Back &one control tick (10 ms)"), Qt::Key_Comma, [this] {
    run_->set_cursor(run_->cursor_us() - std::min(run_->cursor_us(), sim_board::SimBoard::kTick_us));
  });
  add_action(*run, tr("Start &again with seed and stepper"), QKeySequence(tr("Ctrl+Shift+R")),
             [this] { panels_->operator_panel().restart(); });
  add_action(*run, tr("To the &beginning"), Qt::Key_Home, [this] { run_->set_cursor(0); });
  add_action(*run, tr("To the &end"), Qt::Key_End, [this] { run_->set_cursor(run_->end_us()); });
  QAction* loop = add_action(*run, tr("&Loop the playback"), QKeySequence(tr("Ctrl+Shift+L")), {});
  loop->setCheckable(true);
  loop->setToolTip(tr("Play a preview or a recorded run again from where the playback began"));
  playback_->set_loop(loop);
}

// The operator's keys, as in a terminal and in the live page; Ctrl+Alt keeps them apart from the keys of
// other panels.
void MainWindow::make_robot_menu() {
  QMenu* menu = menuBar()->addMenu(tr("R&obot"));
  for (const KeyText& row : kKeyTexts) {
    QList<QKeySequence> keys{QKeySequence(QStringLiteral("Ctrl+Alt+") + key_name(row.key))};
    if (row.letter != Qt::Key_unknown) keys.prepend(QKeySequence(Qt::CTRL | Qt::ALT | row.letter));
    add_action(*menu, QCoreApplication::translate("Key", row.text), {}, [this, key = row.key] {
      panels_->operator_panel().press(key);
    })->setShortcuts(keys);
  }
}

void MainWindow::make_view_menu() {
  QMenu* menu = menuBar()->addMenu(tr("&View"));
  for (std::size_t i = 0; i < kViewTexts.size(); ++i) {
    const view::NamedView& named = view::kNamedViews[i];
    add_action(*menu, tr_view(kViewTexts[i]), QKeySequence(QString(QLatin1Char(named.key))), [this, &named] {
      constexpr double kRad = std::numbers::pi / 180.0;  // per degree
      view_->look_from(kRad * named.azimuth_deg, kRad * named.elevation_deg);
    });
  }
  add_action(*menu, tr("Look at the &robot"), Qt::Key_F, [this] { view_->look_at_robot(); });
  QAction* follow = add_action(*menu, tr("&Follow the robot"), QKeySequence(tr("Ctrl+F")), {});
  follow->setShortcuts({follow->shortcut(), QKeySequence(tr("Shift+F"))});  // Shift+F: as in the replay page
  follow->setCheckable(true);
  follow->setChecked(true);
  connect(follow, &QAction::toggled, view_, [this](bool on) { view_->change().set_follow(on); });
  const auto add_switch = [&](const QString& text, const QKeySequence& keys,
                              void (RobotPicture::*set)(bool)) {
    QAction* action = add_action(*menu, text, keys, {});
    action->setCheckable(true);
    connect(action, &QAction::toggled, view_, [this, set](bool on) { (view_->change().*set)(on); });
  };
  add_switch(tr("&Collision shapes"), QKeySequence(tr("Ctrl+Shift+C")), &RobotPicture::set_collisions);
  add_switch(tr("&Link frames"), QKeySequence(tr("Ctrl+5")), &RobotPicture::set_link_frames);
  add_switch(tr("&Joint axes"), QKeySequence(tr("Ctrl+6")), &RobotPicture::set_joint_axes);
  add_switch(tr("&Exploded view"), QKeySequence(tr("Ctrl+7")), &RobotPicture::set_exploded);
  add_switch(tr("&Inertia ellipsoids"), QKeySequence(tr("Ctrl+8")), &RobotPicture::set_inertias);
  menu->addSeparator();
  int key = Qt::Key_1;
  for (const OverlayText& row : kOverlayTexts) {
    QAction* action = add_action(*menu, tr_view(row.text),
                                 QKeySequence(Qt::CTRL | Qt::SHIFT | static_cast<Qt::Key>(key++)), {});
    action->setCheckable(true);
    action->setChecked(row.shown);
    overlay_actions_[static_cast<std::size_t>(row.overlay)] = action;
    connect(action, &QAction::toggled, this, &MainWindow::show_marks);
  }
  menu->addSeparator();
  panels_->fill_menu(*menu->addMenu(tr("&Panels")));
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
