#include "studio/model/model_panel.h"

#include <QAction>
#include <QCheckBox>
#include <QDateTime>
#include <QHBoxLayout>
#include <QLabel>
#include <QPushButton>
#include <QSplitter>
#include <QToolBar>
#include <QVBoxLayout>
#include <set>
#include <utility>

#include "studio/model/body_tree.h"
#include "studio/model/field_view.h"
#include "studio/motion_editor/offer_bar.h"
#include "studio/widgets/colours.h"

namespace koboshi::studio {
namespace {

constexpr int kWatchPeriod_ms = 3000;

std::filesystem::path recovery_folder_of_models() { return default_recovery_folder() / "models"; }

}  // namespace

ModelPanel::ModelPanel(QWidget* parent)
    : QWidget(parent),
      tools_(new QToolBar(this)),
      both_sides_(new QCheckBox(tr("Both sides"), this)),
      offer_(new OfferBar(this)),
      bodies_(new BodyTree(this)),
      fields_(new FieldView(this)),
      message_(new QLabel(this)),
      effect_(new QLabel(this)),
      start_again_(new QPushButton(tr("Start again"), this)) {
  setLocale(QLocale::c());
  setMinimumWidth(48 * fontMetrics().horizontalAdvance(QLatin1Char('0')));
  build_actions();
  build_layout();
  connect(bodies_, &BodyTree::element_chosen, this, [this](const QString& element) {
    show_element();
    Q_EMIT chosen_changed(element);
  });
  connect(fields_, &FieldView::edited, this, &ModelPanel::set);
  connect(start_again_, &QPushButton::clicked, this, &ModelPanel::start_again_requested);
  timer_.setInterval(kWatchPeriod_ms);
  connect(&timer_, &QTimer::timeout, this, &ModelPanel::check_disk);
  timer_.start();
  show_effect();
}

ModelPanel::~ModelPanel() = default;

// The window has the keys of these actions: they act on the active document.
QAction* ModelPanel::add(const char* name, const QString& text, const QString& tip,
                         std::function<void()> act) {
  auto* action = new QAction(text, this);
  action->setObjectName(QString::fromLatin1(name));
  action->setToolTip(tip);
  connect(action, &QAction::triggered, this, [act = std::move(act)] { act(); });
  tools_->addAction(action);
  return action;
}

void ModelPanel::build_actions() {
  tools_->setMovable(false);
  undo_ = add("undo_model", tr("Undo"), tr("Takes the last change of the robot back (Ctrl+Z)"),
              [this] { undo(); });
  redo_ =
      add("redo_model", tr("Redo"), tr("Makes the change of the robot again (Ctrl+Y)"), [this] { redo(); });
  save_ = add("save_model", tr("Save"), tr("Saves the robot (Ctrl+S)"), [this] { save(); });
  both_sides_->setObjectName(QStringLiteral("both_sides"));
  both_sides_->setToolTip(tr("Changes of a left or right part also change its mirror image"));
  tools_->addSeparator();
  tools_->addWidget(both_sides_);
}

void ModelPanel::build_layout() {
  message_->setWordWrap(true);
  message_->setTextInteractionFlags(Qt::TextSelectableByMouse);
  message_->hide();
  effect_->setWordWrap(true);
  start_again_->setObjectName(QStringLiteral("start_again_model"));
  start_again_->setToolTip(tr("Starts the simulation again with the model as it is now"));
  auto* split = new QSplitter(Qt::Vertical, this);
  split->addWidget(bodies_);
  split->addWidget(fields_);
  split->setStretchFactor(0, 2);
  split->setStretchFactor(1, 3);
  split->setChildrenCollapsible(false);
  auto* last = new QHBoxLayout;
  last->setContentsMargins(6, 2, 4, 4);
  last->addWidget(effect_, 1);
  last->addWidget(start_again_);
  auto* column = new QVBoxLayout(this);
  column->setContentsMargins(0, 0, 0, 0);
  column->setSpacing(0);
  column->addWidget(tools_);
  column->addWidget(offer_);
  column->addWidget(split, 1);
  column->addWidget(message_);
  column->addLayout(last);
}

std::optional<QString> ModelPanel::open(const std::filesystem::path& robot) {
  try {
    document_ = std::make_unique<ModelDocument>(robot, recovery_folder_of_models());
  } catch (const std::exception& error) {
    const QString text = QString::fromUtf8(error.what());
    show_message(text, true);
    return text;
  }
  show_message({}, false);
  follow_document();
  if (chosen().isEmpty()) choose(QString::fromStdString(document_->robot().links.front().name));
  offer_recovery();
  Q_EMIT title_changed();
  return std::nullopt;
}

// --- Edits

bool ModelPanel::attempt(const std::function<void()>& edit) {
  if (!document_) return false;
  const std::uint64_t revision = document_->revision();
  try {
    edit();
  } catch (const std::exception& error) {
    show_message(QString::fromUtf8(error.what()), true);
    return false;
  }
  show_message({}, false);
  const bool is_edited = document_->revision() != revision;
  if (is_edited) follow_document();
  Q_EMIT title_changed();
  if (is_edited) Q_EMIT edited();
  return true;
}

bool ModelPanel::set(const QString& path, const QString& typed) {
  return attempt([&] {
    const sim_board::ModelField field = sim_board::find_field(document_->xml(), path.toStdString());
    const bool both = both_sides_->isChecked() && sim_board::has_other_side(document_->xml(), field);
    document_->set(field.key(), typed.toStdString(), both ? sim_board::Sides::kBoth : sim_board::Sides::kOne);
  });
}

bool ModelPanel::undo() {
  bool done = false;
  attempt([&] { done = document_->undo(); });
  return done;
}

bool ModelPanel::redo() {
  bool done = false;
  attempt([&] { done = document_->redo(); });
  return done;
}

bool ModelPanel::save() {
  if (!document_) return false;
  if (document_->changed_on_disk() == DiskChange::kChanged) {
    check_disk();
    show_message(tr("Not saved: another program has changed the file."), true);
    return false;
  }
  const bool saved = attempt([&] { document_->save(); });
  if (saved)
    show_message(tr("Saved %1.").arg(QString::fromStdString(document_->file().filename().string())), false);
  follow_document();
  return saved;
}

// --- Selection

void ModelPanel::choose(const QString& element) {
  if (!document_ || element == chosen()) return;
  bodies_->choose(element);
  show_element();
}

QString ModelPanel::chosen() const { return bodies_->chosen(); }

void ModelPanel::show_element() {
  if (document_) fields_->show_element(*document_, chosen());
}

void ModelPanel::follow_document() {
  std::set<std::string> marked;
  for (const tools::ModelFinding& finding : document_->report().findings)
    marked.insert(document_->element_at(finding.line));
  bodies_->show_robot(*document_);
  bodies_->mark(marked);
  show_element();
  const TextHistory& history = document_->history();
  undo_->setEnabled(history.can_undo());
  redo_->setEnabled(history.can_redo());
  save_->setEnabled(document_->is_modified());
  show_effect();
  Q_EMIT changed();
}

// --- The sentences of the panel

void ModelPanel::set_running(const std::optional<std::string>& text) {
  running_.reset();
  if (text && document_) running_.emplace(document_->file(), *text);
  show_effect();
}

void ModelPanel::show_effect() {
  const bool differs = running_ && document_ && !same_physics(*running_, document_->xml());
  start_again_->setEnabled(differs);
  if (!running_) {
    effect_->setText(tr("Changes apply to the next simulation of this robot."));
  } else if (differs) {
    effect_->setText(tr("The simulation still has the model from before. Changes apply with Start again."));
  } else if (running_->text() != document_->text()) {
    effect_->setText(tr("Changes of the look are shown at once. The simulation has this model."));
  } else {
    effect_->setText(tr("The simulation has this model."));
  }
}

// Name, value, unit and range of a value beside each other.
QSize ModelPanel::sizeHint() const { return {60 * fontMetrics().horizontalAdvance(QLatin1Char('0')), 700}; }

QString ModelPanel::effect() const { return effect_->text(); }

QString ModelPanel::message() const { return message_->text(); }

void ModelPanel::set_both_sides(bool both) { both_sides_->setChecked(both); }

void ModelPanel::show_message(const QString& text, bool is_error) {
  if (!text.isEmpty() && text != message_->text())
    Q_EMIT told(text, is_error ? MessageKind::kError : MessageKind::kSuccess);
  message_->setText(text);
  message_->setVisible(!text.isEmpty());
  QPalette colours = palette();
  if (is_error) colours.setColor(QPalette::WindowText, colours_of(colours).error);
  message_->setPalette(colours);
  message_->setContentsMargins(6, 2, 6, 2);
}

// --- The file

void ModelPanel::autosave() {
  try {
    document_->autosave(QDateTime::currentSecsSinceEpoch());
  } catch (const std::exception& error) {
    show_message(QString::fromUtf8(error.what()), true);
  }
}

void ModelPanel::keep_recovery() {
  if (!modified()) return;
  autosave();
  document_->keep_recovery();
}

void ModelPanel::check_disk() {
  if (!document_) return;
  autosave();
  if (document_->changed_on_disk() != DiskChange::kChanged || offer_->isVisible()) return;
  offer_->offer(tr("Another program has changed %1.")
                    .arg(QString::fromStdString(document_->file().filename().string())),
                {{tr("Reload"), [this] { attempt([this] { document_->reload(); }); }},
                 {tr("Overwrite"), [this] { attempt([this] { document_->save(); }); }},
                 {tr("Later"), {}}});
}

void ModelPanel::offer_recovery() {
  for (const Recovery& recovery : find_recoveries(recovery_folder_of_models())) {
    if (recovery.original != document_->file()) continue;
    const QString when =
        QDateTime::fromSecsSinceEpoch(recovery.time_unix_s).toString(QStringLiteral("yyyy-MM-dd hh:mm"));
    offer_->offer(tr("The editor ended without saving this robot. Its text of %1 was kept.").arg(when),
                  {{tr("Restore"),
                    [this, recovery] {
                      attempt([&] { document_->replace_text(recovery.text); });
                      discard_recovery(recovery);
                    }},
                   {tr("Discard"), [recovery] { discard_recovery(recovery); }},
                   {tr("Later"), {}}});
    return;
  }
}

}  // namespace koboshi::studio
