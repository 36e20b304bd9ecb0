#include "studio/plant/plant_panel.h"

#include <QAction>
#include <QCheckBox>
#include <QComboBox>
#include <QDateTime>
#include <QDoubleSpinBox>
#include <QFileDialog>
#include <QGridLayout>
#include <QHBoxLayout>
#include <QLabel>
#include <QLineEdit>
#include <QPushButton>
#include <QScrollArea>
#include <QSignalBlocker>
#include <QSplitter>
#include <QToolBar>
#include <QVBoxLayout>
#include <algorithm>
#include <exception>
#include <utility>

#include "base/file/output_file.h"
#include "studio/motion_editor/offer_bar.h"
#include "studio/plant/plant_list.h"
#include "studio/plant/plant_row.h"
#include "studio/widgets/colours.h"

namespace koboshi::studio {
namespace {

constexpr int kWatchPeriod_ms = 3000;

std::filesystem::path recovery_folder_of_scenarios() { return default_recovery_folder() / "scenarios"; }

QString file_name_of(const PlantDocument& document) {
  return QString::fromStdString(document.file().filename().string());
}

bool same_settings(const std::vector<simulation::PlantSetting>& one,
                   const std::vector<simulation::PlantSetting>& other) {
  return std::ranges::equal(one, other, [](const auto& a, const auto& b) {
    return a.field.text == b.field.text && a.value == b.value;
  });
}

}  // namespace

PlantPanel::PlantPanel(QWidget* parent)
    : QWidget(parent),
      tools_(new QToolBar(this)),
      both_sides_(new QCheckBox(tr("Both sides"), this)),
      offer_(new OfferBar(this)),
      elements_(new QComboBox(this)),
      area_(new QScrollArea(this)),
      typed_(new QLineEdit(this)),
      list_(new PlantList(this)),
      message_(new QLabel(this)),
      effect_(new QLabel(this)),
      start_again_(new QPushButton(tr("Start again"), this)) {
  setLocale(QLocale::c());
  setMinimumWidth(48 * fontMetrics().horizontalAdvance(QLatin1Char('0')));
  build_actions();
  build_menu();
  build_layout();
  connect(elements_, &QComboBox::currentIndexChanged, this, &PlantPanel::build_rows);
  connect(typed_, &QLineEdit::returnPressed, this, &PlantPanel::add_typed);
  connect(list_, &PlantList::chosen, this, &PlantPanel::choose_entry);
  connect(list_, &PlantList::removed, this,
          [this](std::size_t entry) { attempt([&] { document_->erase_entry(entry); }); });
  connect(start_again_, &QPushButton::clicked, this, &PlantPanel::start_again_requested);
  timer_.setInterval(kWatchPeriod_ms);
  connect(&timer_, &QTimer::timeout, this, &PlantPanel::check_disk);
  timer_.start();
  follow_document();
}

PlantPanel::~PlantPanel() = default;

// The window has the keys of these actions: they act on the active document.
QAction* PlantPanel::add(const char* name, const QString& text, const QString& tip,
                         std::function<void()> act) {
  auto* action = new QAction(text, this);
  action->setObjectName(QString::fromLatin1(name));
  action->setToolTip(tip);
  connect(action, &QAction::triggered, this, [act = std::move(act)] { act(); });
  tools_->addAction(action);
  return action;
}

void PlantPanel::build_actions() {
  tools_->setMovable(false);
  undo_ = add("undo_plant", tr("Undo"), tr("Takes the last change of the simulated robot back (Ctrl+Z)"),
              [this] { undo(); });
  redo_ = add("redo_plant", tr("Redo"), tr("Makes the change of the simulated robot again (Ctrl+Y)"),
              [this] { redo(); });
  save_ = add("save_plant", tr("Save"), tr("Writes the differences into the scenario (Ctrl+S)"),
              [this] { save(); });
  reset_ = add("reset_plant", tr("Reset all"), tr("The simulated robot has all values of the model again"),
               [this] { attempt([this] { document_->erase_all(); }); });
  both_sides_->setObjectName(QStringLiteral("both_sides_plant"));
  both_sides_->setToolTip(tr("Changes of a left or right part also change its mirror image"));
  tools_->addSeparator();
  tools_->addWidget(both_sides_);
}

// These actions get the menu of the panel.
void PlantPanel::build_menu() {
  const auto add_to_menu = [this](const QString& text, const QString& keys, const QString& tip,
                                  std::function<void()> act) {
    auto* action = new QAction(text, this);
    action->setShortcut(QKeySequence(keys));
    action->setToolTip(tip);
    connect(action, &QAction::triggered, this, [act = std::move(act)] { act(); });
    addAction(action);
  };
  add_to_menu(tr("&Start again with these values"), tr("Ctrl+Alt+Shift+A"),
              tr("Starts the simulation again with the values as they are now"), [this] {
                if (start_again_->isEnabled()) Q_EMIT start_again_requested();
              });
  add_to_menu(tr("&All values of the model"), tr("Ctrl+Alt+Shift+M"),
              tr("The simulated robot has all values of the model again"),
              [this] { attempt([this] { document_->erase_all(); }); });
  add_to_menu(tr("Save the scenario &in another file..."), tr("Ctrl+Alt+Shift+I"),
              tr("Writes the scenario with these values into another file, and opens it"),
              [this] { choose_file(); });
}

QWidget* PlantPanel::make_entry_line() {
  typed_->setObjectName(QStringLiteral("plant_entry"));
  typed_->setPlaceholderText(tr("Any other value: left_shank.mass=80g"));
  typed_->setToolTip(tr("A key and a value as behind koboshi run --plant; Enter sets it"));
  typed_->setAccessibleName(tr("Value of the simulated robot by its key"));
  typed_->setClearButtonEnabled(true);
  return typed_;
}

void PlantPanel::build_layout() {
  elements_->setProperty("verbatim", true);  // names of the robot's file
  elements_->setObjectName(QStringLiteral("plant_element"));
  elements_->setAccessibleName(tr("Link, joint or type of servo"));
  elements_->setToolTip(tr("Link, joint or type of servo whose values the sliders change"));
  area_->setWidgetResizable(true);
  area_->setFrameShape(QFrame::NoFrame);
  area_->setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
  message_->setWordWrap(true);
  message_->setTextInteractionFlags(Qt::TextSelectableByMouse);
  message_->setContentsMargins(6, 2, 6, 2);
  message_->hide();
  effect_->setWordWrap(true);
  start_again_->setObjectName(QStringLiteral("start_again_plant"));
  start_again_->setToolTip(tr("Starts the simulation again with the values as they are now"));
  auto* below = new QWidget(this);
  auto* lines = new QVBoxLayout(below);
  lines->setContentsMargins(0, 0, 0, 0);
  lines->addWidget(make_entry_line());
  lines->addWidget(list_, 1);
  auto* split = new QSplitter(Qt::Vertical, this);
  split->addWidget(area_);
  split->addWidget(below);
  split->setStretchFactor(0, 3);
  split->setStretchFactor(1, 2);
  split->setChildrenCollapsible(false);
  auto* last = new QHBoxLayout;
  last->setContentsMargins(6, 2, 4, 4);
  last->addWidget(effect_, 1);
  last->addWidget(start_again_);
  auto* column = new QVBoxLayout(this);
  column->setContentsMargins(0, 0, 0, 0);
  column->setSpacing(2);
  column->addWidget(tools_);
  column->addWidget(offer_);
  column->addWidget(elements_);
  column->addWidget(split, 1);
  column->addWidget(message_);
  column->addLayout(last);
}

// --- The scenario

void PlantPanel::open(const std::filesystem::path& scenario, const std::filesystem::path& robot) {
  const bool is_open = document_ && document_->file() == std::filesystem::absolute(scenario);
  const std::string model = document_ ? document_->model().text() : std::string();
  try {
    if (is_open) {
      if (!modified() && document_->changed_on_disk() == DiskChange::kChanged) document_->reload();
      document_->set_robot(robot);
    } else {
      auto opened = std::make_unique<PlantDocument>(scenario, robot, recovery_folder_of_scenarios());
      if (!is_discarded_) keep_recovery();
      is_discarded_ = false;
      document_ = std::move(opened);
    }
  } catch (const std::exception& error) {
    show_message(QString::fromUtf8(error.what()), true);
    return;
  }
  show_message(QString::fromStdString(document_->problem()), true);
  if (document_->model().text() != model) fill_elements();  // else the sliders stay where they are scrolled
  follow_document();
  if (!is_open) offer_recovery();
  Q_EMIT title_changed();
}

void PlantPanel::set_running(const std::optional<std::vector<simulation::PlantSetting>>& settings) {
  running_ = settings;
  show_effect();
}

QString PlantPanel::differences() const {
  QStringList lines;
  if (running_ && document_)
    for (const PlantDocument::Entry& entry : document_->entries_of(*running_))
      lines << QString::fromStdString(entry.path + " = " + entry.shown);
  return lines.join(QLatin1Char('\n'));
}

// --- Edits

sim_board::Sides PlantPanel::sides() const {
  return both_sides_->isChecked() ? sim_board::Sides::kBoth : sim_board::Sides::kOne;
}

bool PlantPanel::attempt(const std::function<void()>& edit) {
  if (!document_) return false;
  const std::uint64_t revision = document_->revision();
  try {
    edit();
  } catch (const std::exception& error) {
    const bool is_dragged =
        std::ranges::any_of(rows_, [](const PlantRow* row) { return row->slider()->isSliderDown(); });
    show_message(QString::fromUtf8(error.what()), true, !is_dragged);
    follow_document();  // the old value again
    return false;
  }
  show_message(QString::fromStdString(document_->problem()), true);
  const bool is_edited = document_->revision() != revision;
  if (is_edited) is_discarded_ = false;
  follow_document();
  Q_EMIT title_changed();
  if (is_edited) Q_EMIT edited();
  return true;
}

void PlantPanel::edit(const PlantQuantity& quantity, double value, bool drags) {
  attempt([&] { document_->set(quantity, value, sides(), drags ? quantity.name() : std::string()); });
}

void PlantPanel::add_typed() {
  const std::string text = typed_->text().trimmed().toStdString();
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0 || equals + 1 == text.size())
    return show_message(tr("plant: found %1, expected KEY=VALUE, such as left_shank.mass=80g")
                            .arg(text.empty() ? tr("nothing") : QString::fromStdString(text)),
                        true);
  const auto part = [&](std::size_t begin, std::size_t end) {
    return QString::fromStdString(text.substr(begin, end)).trimmed().toStdString();
  };
  const std::vector<sim_board::ModelSetting> typed{{part(0, equals), part(equals + 1, std::string::npos)}};
  if (attempt([&] { document_->set(typed, sides()); })) typed_->clear();
}

bool PlantPanel::undo() {
  bool done = false;
  attempt([&] { done = document_->undo(); });
  return done;
}

bool PlantPanel::redo() {
  bool done = false;
  attempt([&] { done = document_->redo(); });
  return done;
}

bool PlantPanel::save() {
  if (!document_) return false;
  if (document_->changed_on_disk() == DiskChange::kChanged) {
    check_disk();
    show_message(tr("Not saved: another program has changed the file."), true);
    return false;
  }
  const bool saved = attempt([&] { document_->save(); });
  if (saved) show_message(tr("Saved %1.").arg(file_name_of(*document_)), false);
  return saved;
}

void PlantPanel::choose_file() {
  if (!document_) return;
  const QString file = QFileDialog::getSaveFileName(
      this, tr("Save the scenario in another file"),
      QString::fromStdString(document_->file().parent_path().string()), tr("Scenarios (*.yaml)"));
  if (!file.isEmpty()) save_as(std::filesystem::path(file.toStdString()));
}

bool PlantPanel::save_as(const std::filesystem::path& file) {
  if (!document_) return false;
  try {
    write_whole_file(file, document_->text_for(std::filesystem::absolute(file).parent_path()));
  } catch (const std::exception& error) {
    show_message(QString::fromUtf8(error.what()), true);
    return false;
  }
  discard();  // the other file has the changes
  Q_EMIT open_requested(QString::fromStdString(file.string()));
  return true;
}

// --- Elements and rows

void PlantPanel::fill_elements() {
  const QString kept = chosen();
  {
    const QSignalBlocker quiet(elements_);
    elements_->clear();
    std::string kind;
    for (const sim_board::ModelElement& element : plant_elements(document_->model())) {
      if (!kind.empty() && element.rule->name != kind) elements_->insertSeparator(elements_->count());
      kind = element.rule->name;
      elements_->addItem(QString::fromStdString(element.name));
    }
    elements_->setCurrentIndex(std::max(elements_->findText(kept), 0));
  }
  build_rows();
}

void PlantPanel::choose(const QString& element) {
  const int index = elements_->findText(element);
  if (index >= 0) elements_->setCurrentIndex(index);
}

QString PlantPanel::chosen() const { return elements_->currentText(); }

PlantRow* PlantPanel::row(const std::string& name) const {
  const auto found =
      std::ranges::find_if(rows_, [&](const PlantRow* row) { return row->quantity().name() == name; });
  return found == rows_.end() ? nullptr : *found;
}

void PlantPanel::build_rows() {
  rows_.clear();
  auto* content = new QWidget;
  auto* grid = new QGridLayout(content);
  grid->setContentsMargins(6, 2, 4, 2);
  grid->setHorizontalSpacing(6);
  grid->setVerticalSpacing(1);
  grid->setColumnStretch(1, 1);
  std::string group;
  const auto quantities =
      document_ ? plant_quantities(document_->model(), document_->plant(), chosen().toStdString())
                : std::vector<PlantQuantity>();
  for (const PlantQuantity& quantity : quantities) {
    if (quantity.group != group) add_heading(quantity.group, group.empty(), *grid);
    group = quantity.group;
    add_row(quantity, *grid, *content);
  }
  int width = 0;
  for (const PlantRow* row : rows_) width = std::max(width, row->box_width());
  for (const PlantRow* row : rows_) row->box()->setFixedWidth(width);
  grid->setRowStretch(grid->rowCount(), 1);
  area_->setWidget(content);
}

// The first heading also names the columns.
void PlantPanel::add_heading(const std::string& group, bool is_first, QGridLayout& grid) {
  const int line = grid.rowCount();
  auto* heading = new QLabel(QStringLiteral("<b>%1</b>").arg(QString::fromStdString(group).toHtmlEscaped()));
  heading->setProperty("verbatim", true);
  heading->setContentsMargins(0, 5, 0, 0);
  grid.addWidget(heading, line, 0, 1, 2);
  if (!is_first) return;
  grid.addWidget(new QLabel(tr("Simulated robot")), line, 2, Qt::AlignRight | Qt::AlignBottom);
  grid.addWidget(new QLabel(tr("Model")), line, 3, Qt::AlignRight | Qt::AlignBottom);
}

void PlantPanel::add_row(const PlantQuantity& quantity, QGridLayout& grid, QWidget& content) {
  auto* row = new PlantRow(quantity, grid, &content);
  connect(row, &PlantRow::edited, this,
          [this, row](double value, bool drags) { edit(row->quantity(), value, drags); });
  connect(row, &PlantRow::drag_ended, this, [this] {
    document_->end_drag();
    follow_document();
  });
  connect(row, &PlantRow::reset_wanted, this,
          [this, row] { attempt([&] { document_->erase(row->quantity().field.key(), sides()); }); });
  rows_.push_back(row);
}

void PlantPanel::choose_entry(std::size_t index) {
  const auto entries = document_->entries();
  if (index < entries.size())
    choose(QString::fromStdString(sim_board::path_words(entries[index].path).front()));
}

void PlantPanel::follow_document() {
  const bool is_open = document_ != nullptr;
  if (is_open) {
    const auto quantities = plant_quantities(document_->model(), document_->plant(), chosen().toStdString());
    for (std::size_t i = 0; i < std::min(quantities.size(), rows_.size()); ++i) rows_[i]->show(quantities[i]);
    list_->show_entries(document_->entries());
  }
  for (QWidget* widget : std::initializer_list<QWidget*>{elements_, area_, typed_, list_, both_sides_})
    widget->setEnabled(is_open);
  undo_->setEnabled(is_open && document_->history().can_undo());
  redo_->setEnabled(is_open && document_->history().can_redo());
  save_->setEnabled(is_open && document_->is_modified());
  reset_->setEnabled(is_open && !document_->settings().empty());
  show_effect();
}

// --- The sentences of the panel

void PlantPanel::show_effect() {
  const bool differs = document_ && running_ && !same_settings(*running_, document_->settings());
  start_again_->setEnabled(differs);
  if (!document_) {
    effect_->setText(tr("A scenario has to be open: it says what is simulated."));
  } else if (!running_) {
    effect_->setText(tr("Changes apply to the next simulation of %1.").arg(file_name_of(*document_)));
  } else if (differs) {
    effect_->setText(tr("A robot cannot change while it is simulated. Changes apply with Start again."));
  } else if (running_->empty()) {
    effect_->setText(tr("The simulated robot is as the firmware's model."));
  } else {
    effect_->setText(tr("The simulated robot has these values, and the firmware those of the model."));
  }
}

QString PlantPanel::effect() const { return effect_->text(); }

QString PlantPanel::message() const { return message_->text(); }

void PlantPanel::show_message(const QString& text, bool is_error, bool is_told) {
  if (!text.isEmpty() && is_told && text != message_->text())
    Q_EMIT told(text, is_error ? MessageKind::kError : MessageKind::kSuccess);
  message_->setText(text);
  message_->setVisible(!text.isEmpty());
  QPalette colours = palette();
  if (is_error) colours.setColor(QPalette::WindowText, colours_of(colours).error);
  message_->setPalette(colours);
}

// --- The file

void PlantPanel::keep_recovery() {
  if (!modified()) return;
  try {
    document_->autosave(QDateTime::currentSecsSinceEpoch());
    document_->keep_recovery();
  } catch (const std::exception& error) {
    show_message(QString::fromUtf8(error.what()), true);
  }
}

void PlantPanel::check_disk() {
  if (!document_) return;
  try {
    document_->autosave(QDateTime::currentSecsSinceEpoch());
  } catch (const std::exception& error) {
    show_message(QString::fromUtf8(error.what()), true);
  }
  if (document_->changed_on_disk() != DiskChange::kChanged || offer_->isVisible()) return;
  offer_->offer(tr("Another program has changed %1.").arg(file_name_of(*document_)),
                {{tr("Reload"), [this] { attempt([this] { document_->reload(); }); }},
                 {tr("Overwrite"), [this] { attempt([this] { document_->save(); }); }},
                 {tr("Later"), {}}});
}

void PlantPanel::offer_recovery() {
  for (const Recovery& recovery : find_recoveries(recovery_folder_of_scenarios())) {
    if (recovery.original != document_->file()) continue;
    const QString when =
        QDateTime::fromSecsSinceEpoch(recovery.time_unix_s).toString(QStringLiteral("yyyy-MM-dd hh:mm"));
    offer_->offer(tr("The editor ended without saving this scenario. Its text of %1 was kept.").arg(when),
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
