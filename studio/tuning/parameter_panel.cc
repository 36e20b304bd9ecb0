#include "studio/tuning/parameter_panel.h"

#include <QAction>
#include <QCheckBox>
#include <QComboBox>
#include <QDateTime>
#include <QGridLayout>
#include <QHBoxLayout>
#include <QLabel>
#include <QLineEdit>
#include <QPushButton>
#include <QScrollArea>
#include <QSignalBlocker>
#include <QToolButton>
#include <QVBoxLayout>
#include <algorithm>

#include "studio/motion_editor/offer_bar.h"
#include "studio/tuning/parameter_row.h"

namespace koboshi::studio {
namespace {

constexpr int kCheck_ms = 250;

QToolButton* button_of(QAction* action) {
  auto* button = new QToolButton;
  button->setDefaultAction(action);
  button->setAutoRaise(true);
  return button;
}

}  // namespace

ParameterPanel::ParameterPanel(QWidget* parent)
    : QWidget(parent),
      editor_(this),
      file_(new QComboBox),
      search_(new QLineEdit),
      changed_only_(new QCheckBox(tr("Changed"))),
      live_(new QCheckBox(tr("Live"))),
      apply_(new QPushButton(tr("Apply"))),
      again_(new QPushButton(tr("Start again"))),
      area_(new QScrollArea),
      offer_(new OfferBar(this)),
      message_(new QLabel) {
  add_actions();
  area_->setWidgetResizable(true);
  area_->setFrameShape(QFrame::NoFrame);
  message_->setWordWrap(true);
  message_->setObjectName(QStringLiteral("parameter_message"));
  auto* layout = new QVBoxLayout(this);
  layout->setContentsMargins(4, 4, 4, 4);
  layout->addWidget(offer_);
  layout->addLayout(make_search());
  layout->addLayout(make_buttons());
  layout->addWidget(area_, 1);
  layout->addWidget(message_);
  check_timer_.setSingleShot(true);
  check_timer_.setInterval(kCheck_ms);
  connect(&check_timer_, &QTimer::timeout, this, &ParameterPanel::check);
  connect(&editor_, &ParameterEditor::opened, this, &ParameterPanel::build);
  connect(&editor_, &ParameterEditor::changed, this, [this] {
    error_.clear();
    refresh();
  });
  connect(&editor_, &ParameterEditor::live_changed, this, &ParameterPanel::show_answer);
  connect(&editor_, &ParameterEditor::all_live_changed, this, &ParameterPanel::refresh);
  connect(&editor_, &ParameterEditor::refused, this, &ParameterPanel::show_error);
  build();
}

void ParameterPanel::add_actions() {
  const auto add_button = [this](const QString& text, const QString& tip, const auto& does) {
    auto* action = new QAction(text, this);  // its key is that of the window for the active document
    action->setToolTip(tip);
    connect(action, &QAction::triggered, this, does);
    return action;
  };
  save_ = add_button(tr("Save"), tr("Writes the changed values into the file (Ctrl+S)"), [this] { save(); });
  undo_ = add_button(tr("Undo"), tr("Takes the last change of a parameter back (Ctrl+Z)"),
                     [this] { editor_.undo(); });
  redo_ = add_button(tr("Redo"), tr("Makes the change again (Ctrl+Y)"), [this] { editor_.redo(); });
  const auto add = [&](const QString& text, const QString& keys, const QString& tip, const auto& does) {
    QAction* action = add_button(text, tip, does);
    action->setShortcut(QKeySequence(keys));
    addAction(action);
    return action;
  };
  reset_ = add(tr("Reset &all parameters"), tr("Ctrl+Alt+Shift+R"),
               tr("Gives every parameter its value in the file"), [this] { editor_.reset_all(); });
  add(tr("Re&load parameters"), tr("Ctrl+Alt+Shift+L"), tr("Takes over what another program has written"),
      [this] { editor_.reload(); });
  add(tr("Read &from the controller"), tr("Ctrl+Alt+Shift+D"),
      tr("Reads all parameters of the running controller by SDO"), [this] { editor_.read_all(); });
}

QHBoxLayout* ParameterPanel::make_search() {
  file_->setAccessibleName(tr("File of parameters"));
  file_->setProperty("verbatim", true);  // names of files
  file_->setSizeAdjustPolicy(QComboBox::AdjustToContents);
  connect(file_, qOverload<int>(&QComboBox::currentIndexChanged), this, [this] {
    if (file_->currentIndex() >= 0)
      editor_.show(static_cast<ParameterEditor::File>(file_->currentData().toInt()));
  });
  search_->setPlaceholderText(tr("Search: name, group, unit, meaning"));
  search_->setClearButtonEnabled(true);
  search_->setAccessibleName(tr("Search for parameters"));
  connect(search_, &QLineEdit::textChanged, this, &ParameterPanel::filter);
  changed_only_->setToolTip(tr("Shows only parameters that differ from the file"));
  connect(changed_only_, &QCheckBox::toggled, this, &ParameterPanel::filter);
  auto* line = new QHBoxLayout;
  line->addWidget(file_);
  line->addWidget(search_, 1);
  line->addWidget(changed_only_);
  return line;
}

QHBoxLayout* ParameterPanel::make_buttons() {
  live_->setChecked(editor_.is_live());
  live_->setToolTip(tr("Writes each change to the running controller by SDO"));
  connect(live_, &QCheckBox::toggled, this, [this](bool on) { editor_.set_live(on); });
  apply_->setToolTip(tr("Writes all values that the running controller does not have"));
  connect(apply_, &QPushButton::clicked, this, [this] { editor_.apply_all(); });
  again_->setObjectName(QStringLiteral("start_again"));
  again_->setToolTip(tr("Resets the simulation: the gait is compiled with these numbers"));
  connect(again_, &QPushButton::clicked, this, &ParameterPanel::restart_wanted);
  auto* line = new QHBoxLayout;
  for (QAction* action : {save_, undo_, redo_, reset_}) line->addWidget(button_of(action));
  reset_->setIconText(tr("Reset all"));
  line->addStretch(1);
  line->addWidget(live_);
  line->addWidget(apply_);
  line->addWidget(again_);
  return line;
}

void ParameterPanel::build() {
  rows_.clear();
  groups_.clear();
  auto* content = new QWidget;
  auto* grid = new QGridLayout(content);
  grid->setContentsMargins(4, 2, 4, 2);
  grid->setHorizontalSpacing(6);
  grid->setVerticalSpacing(1);
  grid->setColumnStretch(1, 1);
  if (const ParameterDocument* document = editor_.document()) {
    const ParameterTable table = document->table();
    for (std::size_t first = 0, last = 0; first < table.size(); first = last) {
      while (last < table.size() && table[last].group == table[first].group) ++last;
      add_group(*grid, first, last);
    }
  } else {
    grid->addWidget(new QLabel(tr("This robot has no file parameters.yaml")), 0, 0);
  }
  grid->setRowStretch(grid->rowCount(), 1);
  area_->setWidget(content);
  again_->setVisible(editor_.shown() == ParameterEditor::kGait);
  overwrites_ = false;
  offer_recovery();
  refresh_file();
  refresh();
  filter();
}

void ParameterPanel::add_group(QGridLayout& grid, std::size_t first, std::size_t last) {
  const ParameterTable table = editor_.document()->table();
  const std::string& effect = table[first].effect;
  const QString title =
      QStringLiteral("<b>%1</b> — ").arg(QString::fromStdString(table[first].group).toHtmlEscaped()) +
      tr("takes effect %1").arg(QString::fromStdString(effect));
  Group group{.heading = new QLabel(title), .rows = {}};
  group.heading->setContentsMargins(0, 5, 0, 0);
  grid.addWidget(group.heading, grid.rowCount(), 0, 1, 5);
  for (std::size_t index = first; index < last; ++index) {
    auto* row = new ParameterRow(table[index], table[index].effect != effect, grid, group.heading);
    connect(row, &ParameterRow::edited, this,
            [this, index](double value, bool drags) { edit(index, value, drags); });
    connect(row, &ParameterRow::drag_ended, this, [this] {
      editor_.end_drag();
      refresh();
    });
    connect(row, &ParameterRow::reset_wanted, this, [this, index] { editor_.reset_to_file(index); });
    connect(row, &ParameterRow::default_wanted, this, [this, index] { editor_.reset_to_default(index); });
    rows_.push_back(row);
    group.rows.push_back(index);
  }
  groups_.push_back(std::move(group));
}

void ParameterPanel::refresh_file() {
  const QSignalBlocker quiet(file_);
  file_->clear();
  for (const auto which : {ParameterEditor::kRobot, ParameterEditor::kGait}) {
    const ParameterDocument* document = editor_.document(which);
    if (document == nullptr) continue;
    file_->addItem(QString::fromStdString(document->file().filename().string()), static_cast<int>(which));
    file_->setItemData(file_->count() - 1, QString::fromStdString(document->file().string()),
                       Qt::ToolTipRole);
  }
  file_->setCurrentIndex(file_->findData(static_cast<int>(editor_.shown())));
}

void ParameterPanel::refresh() {
  for (std::size_t index = 0; index < rows_.size(); ++index) refresh_row(index);
  refresh_actions();
  if (changed_only_->isChecked()) filter();
  check_timer_.start();
}

void ParameterPanel::refresh_row(std::size_t index) {
  const ParameterDocument* document = editor_.document();
  if (document == nullptr || index >= rows_.size()) return;
  rows_[index]->show({.value = document->value(index),
                      .in_file = document->file_value(index),
                      .is_changed = document->is_changed(index),
                      .is_connected = editor_.is_connected(),
                      .live = editor_.live().state(index)});
}

void ParameterPanel::refresh_actions() {
  const ParameterDocument* document = editor_.document();
  save_->setEnabled(document != nullptr && document->is_modified());
  undo_->setEnabled(document != nullptr && document->history().can_undo());
  redo_->setEnabled(document != nullptr && document->history().can_redo());
  reset_->setEnabled(document != nullptr && !document->changed().empty());
  apply_->setEnabled(editor_.is_connected());
  again_->setEnabled(editor_.is_connected() && !editor_.is_attached());
  const QSignalBlocker quiet(live_);
  live_->setChecked(editor_.is_live());
}

void ParameterPanel::filter() {
  const ParameterDocument* document = editor_.document();
  if (document == nullptr) return;
  const std::string words = search_->text().toStdString();
  for (const Group& group : groups_) {
    bool shows_any = false;
    for (const std::size_t index : group.rows) {
      const bool shows = document->table()[index].matches(words) &&
                         (!changed_only_->isChecked() || document->is_changed(index));
      rows_[index]->set_visible(shows);
      shows_any = shows_any || shows;
    }
    group.heading->setVisible(shows_any);
  }
}

// A refusal by the compiler goes before an earlier error.
void ParameterPanel::check() {
  const QString problem = editor_.problem();
  message_->setText(problem.isEmpty() ? error_ : problem);
}

void ParameterPanel::show_error(const QString& error) {
  const bool is_new = error != error_;
  error_ = error;
  message_->setText(error);
  if (is_new) Q_EMIT told(error, MessageKind::kError);
}

void ParameterPanel::show_answer(std::size_t index) {
  refresh_row(index);
  const std::string& refusal = editor_.live().state(index).refusal;
  if (refusal.empty()) return;
  show_error(tr("The controller refuses %1: %2")
                 .arg(QString::fromStdString(editor_.document()->table()[index].key),
                      QString::fromStdString(refusal)));
}

QString ParameterPanel::message() const { return message_->text(); }

void ParameterPanel::edit(std::size_t index, double value, bool drags) {
  overwrites_ = false;
  editor_.set(index, value, drags ? QStringLiteral("slider %1").arg(index) : QString());
}

bool ParameterPanel::save() {
  overwrites_ = !editor_.save(overwrites_);
  return !overwrites_;
}

void ParameterPanel::offer_recovery() {
  const auto found = editor_.recovery();
  if (!found) return;
  const auto& [which, recovery] = *found;
  const QString when =
      QDateTime::fromSecsSinceEpoch(recovery.time_unix_s).toString(QStringLiteral("yyyy-MM-dd hh:mm"));
  offer_->offer(
      tr("The editor ended without saving %1. Its text of %2 was kept.")
          .arg(QString::fromStdString(recovery.original.filename().string()), when),
      {{tr("Restore"), [this, which = which, recovery = recovery] { editor_.restore(which, recovery); }},
       {tr("Discard"), [recovery = recovery] { discard_recovery(recovery); }},
       {tr("Later"), {}}});
}

}  // namespace koboshi::studio
