#include <QAction>
#include <QClipboard>
#include <QDoubleSpinBox>
#include <QFileDialog>
#include <QGuiApplication>
#include <QLabel>
#include <QLineEdit>
#include <QTableView>
#include <QToolBar>
#include <algorithm>
#include <utility>

#include "studio/motion_editor/joint_panel.h"
#include "studio/motion_editor/message_line.h"
#include "studio/motion_editor/motion_panel.h"
#include "studio/motion_editor/offer_bar.h"
#include "studio/motion_editor/step_model.h"
#include "studio/motion_editor/timeline.h"

// The actions of the motion editor.
namespace koboshi::studio {
namespace {

using Rows = std::span<const std::size_t>;

constexpr double kNewStepTime_s = 0.5;
constexpr double kZoomStep = 1.5;

}  // namespace

QAction* MotionPanel::add_action(QList<QAction*>& actions, const QString& name, const QString& text,
                                 const QKeySequence& keys, const QString& tip, std::function<void()> act) {
  auto* const action = new QAction(text, this);
  action->setObjectName(name);
  action->setShortcut(keys);
  action->setToolTip(QStringLiteral("%1 (%2)").arg(tip, keys.toString(QKeySequence::NativeText)));
  action->setStatusTip(tip);
  connect(action, &QAction::triggered, this, [act = std::move(act)] { act(); });
  addAction(action);
  actions.append(action);
  return action;
}

QAction* MotionPanel::add_edit(const char* name, const QString& text, const QKeySequence& keys,
                               const QString& tip, std::function<void()> act) {
  return add_action(edit_actions_, QString::fromLatin1(name), text, keys, tip, std::move(act));
}

// An action of the toolbar alone: the window has the key, which acts on the active document.
QAction* MotionPanel::add_button(const char* name, const QString& text, const QString& keys,
                                 const QString& tip, std::function<void()> act) {
  auto* const action = new QAction(text, this);
  action->setObjectName(QString::fromLatin1(name));
  action->setProperty("keys", keys);
  action->setToolTip(QStringLiteral("%1 (%2)").arg(tip, keys));
  connect(action, &QAction::triggered, this, [act = std::move(act)] { act(); });
  tools_->addAction(action);
  return action;
}

void MotionPanel::add_separator(QList<QAction*>& actions) {
  auto* const line = new QAction(this);
  line->setSeparator(true);
  actions.append(line);
}

// The name under which the robot lists the motion.
void MotionPanel::build_name() {
  name_ = new QLineEdit(this);
  name_->setObjectName(QStringLiteral("motion_name"));
  name_->setAccessibleName(tr("Name of the motion"));
  name_->setToolTip(
      tr("Name under which a robot lists the motion: 1 to 24 printable ASCII letters.\n"
         "A new motion gets the name of its file."));
  constexpr int kMaxLetters = 24;
  name_->setMaxLength(kMaxLetters);
  name_->setFixedWidth(16 * fontMetrics().averageCharWidth() + 12);
  connect(name_, &QLineEdit::editingFinished, this, [this] {
    const std::string name = name_->text().toStdString();
    name_->setModified(false);
    if (!editor_->is_open() || editor_->document().name() == name) return;
    editor_->edit([&](MotionDocument& document) { document.set_name(name); });
    update_name();
  });
  auto* const label = new QLabel(tr("Name"), this);
  label->setContentsMargins(6, 0, 4, 0);
  tools_->addWidget(label);
  tools_->addWidget(name_);
  tools_->addSeparator();
}

void MotionPanel::update_name() {
  name_->setEnabled(editor_->is_open() && !editor_->document().name().empty());
  if (name_->isModified()) return;
  name_->setText(editor_->is_open() ? QString::fromStdString(editor_->document().name()) : QString());
}

void MotionPanel::build_actions() {
  build_name();
  add_button("undo", tr("&Undo"), tr("Ctrl+Z"), tr("Undo the last edit"), [this] { undo(); });
  add_button("redo", tr("&Redo"), tr("Ctrl+Y"), tr("Redo the edit that was undone"), [this] { redo(); });
  tools_->addSeparator();
  add_edit("cut", tr("Cu&t"), QKeySequence::Cut, tr("Copy the selected steps and delete them"), [this] {
    copy();
    edit_selected([](MotionDocument& document, Rows rows) { document.erase_rows(rows); });
  });
  tools_->addAction(add_edit("copy", tr("&Copy"), QKeySequence::Copy,
                             tr("Copy the selected steps with their poses"), [this] { copy(); }));
  tools_->addAction(add_edit("paste", tr("&Paste"), QKeySequence::Paste,
                             tr("Insert copied steps, also of another motion"), [this] { paste(); }));
  tools_->addAction(add_edit("duplicate", tr("Du&plicate"), Qt::CTRL | Qt::Key_D,
                             tr("Repeat the selected steps behind them"), [this] {
                               add_steps([this](MotionDocument& document, const StepPlace&) {
                                 return document.duplicate_rows(selected());
                               });
                             }));
  tools_->addAction(add_edit(
      "delete", tr("&Delete"), QKeySequence::Delete, tr("Delete the selected steps"),
      [this] { edit_selected([](MotionDocument& document, Rows rows) { document.erase_rows(rows); }); }));
  add_edit("select_all", tr("Select &all"), QKeySequence::SelectAll, tr("Select all steps"),
           [this] { table_->selectAll(); });
  build_step_actions();
  build_time_actions();
  build_play_actions();
  build_view_actions();
  build_file_actions();
}

void MotionPanel::build_step_actions() {
  add_separator(edit_actions_);
  tools_->addAction(edit_actions_.back());
  tools_->addAction(add_edit("insert_pose", tr("&Insert pose"), Qt::Key_Insert,
                             tr("Insert a move to a new pose with the present angles"), [this] {
                               add_steps([this](MotionDocument& document, const StepPlace& place) {
                                 const auto& rows = document.rows().rows;
                                 const auto angles =
                                     rows.empty() ? document.robot().standing_rad
                                                  : rows[std::min(place.index, rows.size() - 1)].angles_rad;
                                 return document.insert_pose(place, angles, kNewStepTime_s);
                               });
                             }));
  add_edit("insert_wait", tr("Insert &wait"), Qt::SHIFT | Qt::Key_Insert, tr("Insert a wait of 0.5 s"),
           [this] {
             add_steps([](MotionDocument& document, const StepPlace& place) {
               return document.insert_step(place, "{wait_s: 0.5}");
             });
           });
  add_edit("insert_loop", tr("Insert &loop"), Qt::CTRL | Qt::Key_L,
           tr("Insert a loop of two rounds around a wait"), [this] {
             add_steps([](MotionDocument& document, const StepPlace& place) {
               return document.insert_step(place,
                                           "- loop:\n    times: 2\n    steps:\n      - {wait_s: 0.5}\n");
             });
           });
  add_edit("rename_pose", tr("R&ename pose"), Qt::CTRL | Qt::Key_E,
           tr("Give the pose of this step another name, in all places"), [this] { joints_->edit_name(); });
  add_edit("move_up", tr("Move u&p"), Qt::ALT | Qt::Key_Up,
           tr("Move the selected steps before the step above"), [this] { move(-1); });
  add_edit("move_down", tr("Move do&wn"), Qt::ALT | Qt::Key_Down,
           tr("Move the selected steps behind the step below"), [this] { move(1); });
}

void MotionPanel::build_time_actions() {
  add_separator(edit_actions_);
  tools_->addAction(edit_actions_.back());
  tools_->addAction(add_edit(
      "mirror", tr("&Mirror"), Qt::CTRL | Qt::Key_M, tr("Exchange left and right in the selected steps"),
      [this] { edit_selected([](MotionDocument& document, Rows rows) { document.mirror_rows(rows); }); }));
  add_edit("mirror_motion", tr("Mirror the &motion"), Qt::CTRL | Qt::SHIFT | Qt::Key_M,
           tr("Exchange left and right in the whole motion"),
           [this] { editor_->edit([](MotionDocument& document) { document.mirror_motion(); }); });
  tools_->addAction(add_edit(
      "reverse", tr("Re&verse"), Qt::CTRL | Qt::Key_R, tr("Play the selected moves in the reverse order"),
      [this] { edit_selected([](MotionDocument& document, Rows rows) { document.reverse_rows(rows); }); }));
  tools_->addAction(add_edit("scale_time", tr("&Scale time…"), Qt::CTRL | Qt::Key_T,
                             tr("Make the selected steps slower or faster"), [this] {
                               scale_bar_->show();
                               scale_factor_->setFocus();
                               scale_factor_->selectAll();
                             }));
}

void MotionPanel::build_play_actions() {
  add_separator(edit_actions_);
  tools_->addAction(edit_actions_.back());
  tools_->addAction(
      add_edit("play_preview", tr("Pre&view"), Qt::Key_F5,
               tr("Play without physics from the cursor of the timeline or the current step"),
               [this] { Q_EMIT play_requested(false, std::max(0, table_->currentIndex().row())); }));
  tools_->addAction(add_edit("play_physics", tr("Simula&te"), Qt::Key_F6,
                             tr("Play the motion in the simulation"),
                             [this] { Q_EMIT play_requested(true, 0); }));
  add_edit("play_physics_from", tr("Simulate &from here"), Qt::SHIFT | Qt::Key_F6,
           tr("Play the steps from the current one in the simulation: the robot stands up, moves to the pose "
              "before them in 1.5 s, and goes on"),
           [this] { Q_EMIT play_requested(true, std::max(0, table_->currentIndex().row())); });
}

void MotionPanel::build_view_actions() {
  QList<QAction*>& all = edit_actions_;
  add_separator(all);
  add_action(all, QStringLiteral("next_finding"), tr("&Next finding"), Qt::Key_F8,
             tr("Go to the next message"), [this] { messages_->show_next(1); });
  add_action(all, QStringLiteral("previous_finding"), tr("Previous &finding"), Qt::SHIFT | Qt::Key_F8,
             tr("Go to the previous message"), [this] { messages_->show_next(-1); });
  add_action(all, QStringLiteral("zoom_in"), tr("&Zoom in"), Qt::CTRL | Qt::Key_Plus,
             tr("Show less time in the timeline"), [this] { timeline_->zoom(kZoomStep); });
  add_action(all, QStringLiteral("zoom_out"), tr("Zoom &out"), Qt::CTRL | Qt::Key_Minus,
             tr("Show more time in the timeline"), [this] { timeline_->zoom(1.0 / kZoomStep); });
  add_action(all, QStringLiteral("zoom_fit"), tr("Show &all"), Qt::CTRL | Qt::Key_0,
             tr("Show the whole motion in the timeline"), [this] { timeline_->fit(); });
}

void MotionPanel::build_file_actions() {
  QList<QAction*>& all = file_actions_;
  add_action(all, QStringLiteral("new"), tr("&New motion"), QKeySequence::New,
             tr("Begin a motion for the same robot"), [this] { new_motion(); });
  add_action(all, QStringLiteral("save_as"), tr("Save motion &as…"), Qt::CTRL | Qt::SHIFT | Qt::Key_S,
             tr("Save the motion in another file"), [this] { choose_file(); });
  add_action(all, QStringLiteral("upgrade"), tr("&Upgrade to version 2"), Qt::CTRL | Qt::SHIFT | Qt::Key_U,
             tr("Convert the motion to version 2 of the language"),
             [this] { editor_->edit([](MotionDocument& document) { document.upgrade(); }); });
}

void MotionPanel::update_actions() {
  const bool is_open = editor_->is_open();
  const bool has_rows = is_open && !selected().empty();
  update_name();
  const auto enable = [this](const char* name, bool enabled) {
    findChild<QAction*>(QString::fromLatin1(name), Qt::FindDirectChildrenOnly)->setEnabled(enabled);
  };
  for (const char* const name : {"cut", "copy", "duplicate", "delete", "rename_pose", "move_up", "move_down",
                                 "mirror", "reverse", "scale_time"})
    enable(name, has_rows);
  for (const char* const name : {"paste", "insert_pose", "insert_wait", "insert_loop", "mirror_motion",
                                 "play_preview", "play_physics", "play_physics_from", "save_as", "upgrade"})
    enable(name, is_open);
  enable("new", editor_->has_robot());
  const auto name_edit = [&](const char* name, const QString& verb, bool can, std::string_view label) {
    auto* const action = findChild<QAction*>(QString::fromLatin1(name), Qt::FindDirectChildrenOnly);
    action->setEnabled(can);
    const QString what = QString::fromUtf8(label.data(), static_cast<qsizetype>(label.size()));
    const QString tip = can ? verb + u' ' + what.left(1).toLower() + what.mid(1) : verb;
    action->setToolTip(QStringLiteral("%1 (%2)").arg(tip, action->property("keys").toString()));
  };
  name_edit("undo", tr("Undo:"), is_open && editor_->document().history().can_undo(),
            is_open ? editor_->document().history().undo_label() : "");
  name_edit("redo", tr("Redo:"), is_open && editor_->document().history().can_redo(),
            is_open ? editor_->document().history().redo_label() : "");
}

// --- Edits

std::vector<std::size_t> MotionPanel::selected() const {
  std::vector<std::size_t> rows;
  const QItemSelection ranges = table_->selectionModel()->selection();
  for (const QItemSelectionRange& range : ranges) {
    for (int row = range.top(); row <= range.bottom(); ++row) rows.push_back(static_cast<std::size_t>(row));
  }
  std::ranges::sort(rows);
  rows.erase(std::ranges::unique(rows).begin(), rows.end());
  return rows;
}

void MotionPanel::select_rows(std::size_t first, std::size_t count) {
  if (count == 0 || first >= static_cast<std::size_t>(model_->rowCount())) return;
  show_row(first);
  const QModelIndex last = model_->index(
      static_cast<int>(std::min(first + count, static_cast<std::size_t>(model_->rowCount()))) - 1, 0);
  table_->selectionModel()->select({model_->index(static_cast<int>(first), 0), last},
                                   QItemSelectionModel::ClearAndSelect | QItemSelectionModel::Rows);
}

void MotionPanel::edit_selected(
    const std::function<void(MotionDocument&, std::span<const std::size_t>)>& change) {
  const std::vector<std::size_t> rows = selected();
  const std::size_t before = static_cast<std::size_t>(model_->rowCount());
  if (rows.empty() || !editor_->edit([&](MotionDocument& document) { change(document, rows); })) return;
  const auto after = static_cast<std::size_t>(model_->rowCount());
  if (after < before && after > 0) select_rows(std::min(rows.front(), after - 1), 1);
}

void MotionPanel::add_steps(const std::function<std::size_t(MotionDocument&, const StepPlace&)>& add) {
  const std::vector<std::size_t> rows = selected();
  const StepPlace place =
      rows.empty() ? StepPlace{StepPlace::Kind::kEndOf, 0} : StepPlace{StepPlace::Kind::kAfter, rows.back()};
  const auto before = static_cast<std::size_t>(model_->rowCount());
  std::size_t first = 0;
  if (!editor_->edit([&](MotionDocument& document) { first = add(document, place); })) return;
  const auto after = static_cast<std::size_t>(model_->rowCount());
  if (after > before) select_rows(first, after - before);
}

void MotionPanel::undo() {
  editor_->edit([](MotionDocument& document) { static_cast<void>(document.undo()); });
}

void MotionPanel::redo() {
  editor_->edit([](MotionDocument& document) { static_cast<void>(document.redo()); });
}

void MotionPanel::copy() {
  const std::vector<std::size_t> rows = selected();
  if (rows.empty()) return;
  editor_->edit([&](MotionDocument& document) {
    QGuiApplication::clipboard()->setText(QString::fromStdString(document.copy_rows(rows)));
  });
  messages_->show_note(rows.size() == 1 ? tr("Copied 1 step") : tr("Copied %1 steps").arg(rows.size()));
}

void MotionPanel::paste() {
  const std::string text = QGuiApplication::clipboard()->text().toStdString();
  add_steps([&](MotionDocument& document, const StepPlace& place) { return document.paste(place, text); });
}

// Moves the selected steps by one place among those around them; out of their loop at its ends.
void MotionPanel::move(int direction) {
  const std::vector<std::size_t> rows = selected();
  if (rows.empty()) return;
  const auto& all = editor_->rows().rows;
  const MotionRow& edge = all[direction < 0 ? rows.front() : rows.back()];
  const auto is_sibling = [&](const MotionRow& other) {
    return other.section == edge.section && other.parent == edge.parent && other.in_else == edge.in_else &&
           static_cast<std::ptrdiff_t>(other.list_index) ==
               static_cast<std::ptrdiff_t>(edge.list_index) + direction;
  };
  std::optional<std::size_t> next = edge.parent;
  const auto sibling = std::ranges::find_if(all, is_sibling);
  if (sibling != all.end()) next = static_cast<std::size_t>(sibling - all.begin());
  if (!next) return;
  const StepPlace place{direction < 0 ? StepPlace::Kind::kBefore : StepPlace::Kind::kAfter, *next};
  std::size_t first = 0;
  if (editor_->edit([&](MotionDocument& document) { first = document.move_rows(rows, place); }))
    select_rows(first, rows.size());
}

void MotionPanel::scale_time() {
  scale_bar_->hide();
  const double factor = scale_factor_->value() / 100.0;
  edit_selected([factor](MotionDocument& document, std::span<const std::size_t> rows) {
    document.scale_time(rows, factor);
  });
  table_->setFocus();
}

void MotionPanel::new_motion() {
  replace([this] {
    if (!report(editor_->begin())) return;
    if (model_->rowCount() > 0) show_row(0);
    Q_EMIT edited();
  });
}

// Lets the user choose the file. Returns whether the motion is saved.
bool MotionPanel::choose_file() {
  const QString name = QFileDialog::getSaveFileName(
      this, tr("Save motion"), QString::fromStdString(file().string()), tr("Motions (*.yaml)"));
  if (name.isEmpty()) return false;
  std::filesystem::path chosen(name.toStdString());
  if (!chosen.has_extension()) chosen += ".yaml";
  return save_as(chosen);
}

void MotionPanel::set_keys_everywhere(bool everywhere) {
  const Qt::ShortcutContext context = everywhere ? Qt::WindowShortcut : Qt::WidgetWithChildrenShortcut;
  static const QStringList always{QStringLiteral("new"), QStringLiteral("play_preview"),
                                  QStringLiteral("play_physics"), QStringLiteral("play_physics_from")};
  for (QAction* const action : edit_actions_ + file_actions_)
    if (!always.contains(action->objectName())) action->setShortcutContext(context);
}

}  // namespace koboshi::studio
