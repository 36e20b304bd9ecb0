#include "studio/motion_editor/motion_panel.h"

#include <QAction>
#include <QDateTime>
#include <QDoubleSpinBox>
#include <QEvent>
#include <QHBoxLayout>
#include <QHeaderView>
#include <QLabel>
#include <QPushButton>
#include <QSplitter>
#include <QTableView>
#include <QToolBar>
#include <QVBoxLayout>
#include <algorithm>

#include "studio/motion_editor/joint_panel.h"
#include "studio/motion_editor/message_line.h"
#include "studio/motion_editor/offer_bar.h"
#include "studio/motion_editor/step_delegate.h"
#include "studio/motion_editor/step_model.h"
#include "studio/motion_editor/timeline.h"

namespace koboshi::studio {

namespace fs = std::filesystem;

MotionPanel::MotionPanel(QWidget* parent) : QWidget(parent) {
  setLocale(QLocale::c());
  editor_ = new MotionEditor(default_recovery_folder(), this);
  model_ = new StepModel(*editor_, this);
  model_->set_palette(palette());
  table_ = new QTableView(this);
  table_->setModel(model_);
  table_->setItemDelegate(new StepDelegate(table_));
  timeline_ = new Timeline(*editor_, *table_->selectionModel(), this);
  joints_ = new JointPanel(*editor_, this);
  messages_ = new MessageLine(*editor_, this);
  recovery_bar_ = new OfferBar(this);
  recovery_bar_->setObjectName(QStringLiteral("recovery"));
  disk_bar_ = new OfferBar(this);
  disk_bar_->setObjectName(QStringLiteral("disk"));
  tools_ = new QToolBar(this);
  build_actions();
  build_layout();
  setFocusProxy(table_);
  model_->set_selection([this] { return selected(); });

  connect(editor_, &MotionEditor::changed, this, &MotionPanel::follow_document);
  connect(editor_, &MotionEditor::edited, this, &MotionPanel::edited);
  connect(editor_, &MotionEditor::failed, this,
          [this](const QString& error) { Q_EMIT told(error, MessageKind::kError); });
  connect(editor_, &MotionEditor::saved, this, [this] {
    disk_bar_->hide();
    update_actions();
    Q_EMIT title_changed();
  });
  connect(editor_, &MotionEditor::changed_on_disk, this, &MotionPanel::offer_reload);
  connect(table_->selectionModel(), &QItemSelectionModel::currentRowChanged, this,
          &MotionPanel::follow_selection);
  connect(table_->selectionModel(), &QItemSelectionModel::selectionChanged, this,
          &MotionPanel::update_actions);
  connect(model_, &StepModel::rows_dropped, this, &MotionPanel::select_rows);
  connect(messages_, &MessageLine::row_wanted, this, &MotionPanel::show_row);
  connect(joints_, &JointPanel::joint_chosen, timeline_, &Timeline::set_joint);
  connect(timeline_, &Timeline::scrubbed, this, &MotionPanel::show_tick);
  update_actions();
}

MotionPanel::~MotionPanel() {
  // The views look at the editor until they are gone.
  for (QObject* const user : std::initializer_list<QObject*>{timeline_, joints_, messages_, table_, model_}) {
    disconnect(editor_, nullptr, user, nullptr);
    delete user;
  }
}

void MotionPanel::build_layout() {
  table_->setObjectName(QStringLiteral("steps"));
  table_->setSelectionBehavior(QAbstractItemView::SelectRows);
  table_->setSelectionMode(QAbstractItemView::ExtendedSelection);
  table_->setEditTriggers(QAbstractItemView::DoubleClicked | QAbstractItemView::EditKeyPressed |
                          QAbstractItemView::AnyKeyPressed);
  table_->setDragDropMode(QAbstractItemView::DragDrop);
  table_->setDragDropOverwriteMode(false);
  table_->setDefaultDropAction(Qt::MoveAction);
  table_->setShowGrid(false);
  table_->setAlternatingRowColors(true);
  table_->setWordWrap(false);
  table_->setFrameShape(QFrame::NoFrame);
  table_->setHorizontalScrollMode(QAbstractItemView::ScrollPerPixel);
  table_->setTabKeyNavigation(false);
  table_->verticalHeader()->setSectionResizeMode(QHeaderView::Fixed);
  table_->verticalHeader()->setDefaultSectionSize(fontMetrics().height() + 6);
  QHeaderView& header = *table_->horizontalHeader();
  header.setHighlightSections(false);
  header.setStretchLastSection(true);
  const std::array widths{220, 66, 66, 78, 68, 104, 120};
  for (int column = 0; column < StepModel::kColumns; ++column)
    header.resizeSection(column, widths.at(static_cast<std::size_t>(column)));

  tools_->setToolButtonStyle(Qt::ToolButtonTextOnly);
  tools_->setMovable(false);
  auto* const left = new QSplitter(Qt::Vertical, this);
  left->addWidget(table_);
  left->addWidget(timeline_);
  left->setStretchFactor(0, 1);
  left->setStretchFactor(1, 1);
  left->setChildrenCollapsible(false);
  auto* const middle = new QSplitter(Qt::Horizontal, this);
  middle->addWidget(left);
  middle->addWidget(joints_);
  middle->setStretchFactor(0, 1);
  middle->setStretchFactor(1, 0);
  middle->setCollapsible(0, false);
  middle->setSizes({920, 360});
  auto* const column = new QVBoxLayout(this);
  column->setContentsMargins(0, 0, 0, 0);
  column->setSpacing(0);
  for (QWidget* const widget :
       std::initializer_list<QWidget*>{tools_, recovery_bar_, disk_bar_, build_scale_bar()})
    column->addWidget(widget);
  column->addWidget(middle, 1);
  column->addWidget(messages_);
}

QWidget* MotionPanel::build_scale_bar() {
  scale_bar_ = new QWidget(this);
  auto* const row = new QHBoxLayout(scale_bar_);
  row->setContentsMargins(8, 3, 4, 3);
  scale_factor_ = new QDoubleSpinBox(scale_bar_);
  scale_factor_->setObjectName(QStringLiteral("scale"));
  scale_factor_->setRange(5.0, 2000.0);
  scale_factor_->setDecimals(1);
  scale_factor_->setSingleStep(5.0);
  scale_factor_->setValue(100.0);
  scale_factor_->setSuffix(tr(" %"));
  scale_factor_->setToolTip(tr("New duration of the selected steps in % of the present one"));
  auto* const apply = new QPushButton(tr("Scale"), scale_bar_);
  apply->setObjectName(QStringLiteral("apply_scale"));
  auto* const cancel = new QPushButton(tr("Cancel"), scale_bar_);
  row->addWidget(new QLabel(tr("Scale the time of the selected steps to"), scale_bar_));
  row->addWidget(scale_factor_);
  row->addWidget(apply);
  row->addWidget(cancel);
  row->addStretch(1);
  connect(apply, &QPushButton::clicked, this, &MotionPanel::scale_time);
  connect(cancel, &QPushButton::clicked, scale_bar_, &QWidget::hide);
  scale_bar_->hide();
  return scale_bar_;
}

// --- Files

std::optional<QString> MotionPanel::open(const fs::path& motion, const fs::path& robot) {
  recovery_bar_->hide();
  disk_bar_->hide();
  if (auto error = editor_->open(motion, robot)) {
    messages_->show_error(*error);
    return error;
  }
  Q_EMIT edited();
  if (model_->rowCount() > 0) show_row(0);
  offer_recovery();
  return std::nullopt;
}

bool MotionPanel::modified() const { return editor_->is_open() && editor_->document().is_modified(); }

fs::path MotionPanel::file() const { return editor_->is_open() ? editor_->document().file() : fs::path(); }

std::optional<QString> MotionPanel::set_robot(std::shared_ptr<const sim_board::RobotDescription> robot) {
  auto error = editor_->set_robot(std::move(robot));
  update_actions();
  if (!error) offer_recovery();
  return error;
}

std::string MotionPanel::text() const {
  return editor_->is_open() ? editor_->document().text() : std::string();
}

bool MotionPanel::report(const std::optional<QString>& error) {
  if (!error) return true;
  messages_->show_error(*error);
  Q_EMIT told(*error, MessageKind::kError);
  return false;
}

bool MotionPanel::save() {
  if (!editor_->is_open()) return false;
  if (file().empty()) return choose_file();
  if (const DiskChange change = editor_->document().changed_on_disk(); change == DiskChange::kChanged) {
    offer_reload(change);
    return report(tr("Not saved: another program has changed the file."));
  }
  return report(editor_->save());
}

void MotionPanel::keep_recovery() { editor_->keep_recovery(); }

bool MotionPanel::save_as(const fs::path& file) { return editor_->is_open() && report(editor_->save(file)); }

void MotionPanel::offer_recovery() {
  const auto found = editor_->recoveries();
  if (found.empty()) return;
  const Recovery& recovery = found.front();
  const QString when =
      QDateTime::fromSecsSinceEpoch(recovery.time_unix_s).toString(QStringLiteral("yyyy-MM-dd hh:mm"));
  const QString text =
      recovery.original.empty()
          ? tr("The editor ended without saving a new motion. Its text of %1 was kept.").arg(when)
          : tr("The editor ended without saving %1. Its text of %2 was kept.")
                .arg(QString::fromStdString(recovery.original.filename().string()), when);
  recovery_bar_->offer(text, {{tr("Restore"), [this, recovery] { restore(recovery); }},
                              {tr("Discard"), [recovery] { discard_recovery(recovery); }},
                              {tr("Later"), {}}});
}

void MotionPanel::restore(const Recovery& recovery) {
  replace([this, recovery] {
    if (!report(editor_->restore(recovery))) return;
    if (model_->rowCount() > 0) show_row(0);
    Q_EMIT edited();
  });
}

void MotionPanel::replace(const std::function<void()>& go_on) {
  if (guard_) return guard_(go_on);
  go_on();
}

void MotionPanel::offer_reload(DiskChange change) {
  if (change == DiskChange::kNone) {
    disk_bar_->hide();
    return;
  }
  const QString name = QString::fromStdString(editor_->document().file().filename().string());
  const auto overwrite = [this] { report(editor_->save()); };
  if (change == DiskChange::kGone) {
    disk_bar_->offer(tr("%1 was removed by another program.").arg(name),
                     {{tr("Save again"), overwrite}, {tr("Later"), {}}});
    return;
  }
  disk_bar_->offer(
      tr("%1 was changed by another program.").arg(name),
      {{modified() ? tr("Reload (can be undone)") : tr("Reload"), [this] { report(editor_->reload()); }},
       {tr("Overwrite"), overwrite},
       {tr("Later"), {}}});
}

// --- Following the document and the selection

void MotionPanel::follow_document() {
  if (!table_->currentIndex().isValid() && model_->rowCount() > 0) show_row(0);
  const QModelIndex current = table_->currentIndex();
  joints_->set_row(current.isValid() ? std::optional(static_cast<std::size_t>(current.row())) : std::nullopt);
  update_actions();
  show_pose();
  Q_EMIT title_changed();
}

void MotionPanel::follow_selection() {
  const QModelIndex current = table_->currentIndex();
  const bool is_valid =
      current.isValid() && static_cast<std::size_t>(current.row()) < editor_->rows().rows.size();
  const auto row = static_cast<std::size_t>(current.row());
  joints_->set_row(is_valid ? std::optional(row) : std::nullopt);
  if (is_valid) messages_->show_row(row);
  show_pose();
}

void MotionPanel::show_pose() {
  scrubbed_tick_.reset();
  const auto row = static_cast<std::size_t>(table_->currentIndex().row());
  if (table_->currentIndex().isValid() && row < editor_->rows().rows.size())
    Q_EMIT pose_changed(editor_->rows().rows[row].angles_rad);
}

void MotionPanel::show_tick(std::size_t tick) {
  scrubbed_tick_ = tick;
  const CheckResult& result = *editor_->checked();
  const auto begin = result.targets_rad.begin() + static_cast<std::ptrdiff_t>(tick * result.joints);
  Q_EMIT pose_changed({begin, begin + static_cast<std::ptrdiff_t>(result.joints)});
}

void MotionPanel::show_row(std::size_t row) {
  const QModelIndex index = model_->index(static_cast<int>(row), 0);
  table_->selectionModel()->setCurrentIndex(index,
                                            QItemSelectionModel::ClearAndSelect | QItemSelectionModel::Rows);
  table_->scrollTo(index);
}

void MotionPanel::changeEvent(QEvent* event) {
  QWidget::changeEvent(event);
  if (event->type() == QEvent::PaletteChange) model_->set_palette(palette());
}

}  // namespace koboshi::studio
