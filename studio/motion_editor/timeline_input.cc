#include <QHelpEvent>
#include <QKeyEvent>
#include <QMouseEvent>
#include <QScrollBar>
#include <QToolTip>
#include <QWheelEvent>
#include <algorithm>
#include <cmath>
#include <utility>

#include "base/text/user_units.h"
#include "studio/motion_editor/timeline.h"
#include "studio/motion_editor/timeline_layout.h"

// Mouse and keyboard in the timeline.
namespace koboshi::studio {

using InputKind = simulation::StepSource::Kind;

std::vector<std::size_t> Timeline::selected() const {
  std::vector<std::size_t> rows;
  for (const QModelIndex& index : selection_.selectedRows())
    rows.push_back(static_cast<std::size_t>(index.row()));
  std::ranges::sort(rows);
  return rows;
}

void Timeline::select(std::size_t row, Qt::KeyboardModifiers modifiers) {
  const QModelIndex index = selection_.model()->index(static_cast<int>(row), 0);
  using Selection = QItemSelectionModel;
  if (modifiers.testFlag(Qt::ControlModifier)) {
    selection_.select(index, Selection::Toggle | Selection::Rows);
    selection_.setCurrentIndex(index, Selection::NoUpdate);
  } else if (modifiers.testFlag(Qt::ShiftModifier) && selection_.currentIndex().isValid()) {
    const int from = std::min(selection_.currentIndex().row(), index.row());
    const int to = std::max(selection_.currentIndex().row(), index.row());
    const auto* const model = selection_.model();
    selection_.select({model->index(from, 0), model->index(to, 0)},
                      Selection::ClearAndSelect | Selection::Rows);
  } else if (!selection_.isRowSelected(index.row())) {
    selection_.setCurrentIndex(index, Selection::ClearAndSelect | Selection::Rows);
  } else {
    selection_.setCurrentIndex(index, Selection::NoUpdate);
  }
}

void Timeline::mousePressEvent(QMouseEvent* event) {
  if (event->button() != Qt::LeftButton || !editor_.is_open()) return;
  press_ = pointer_ = event->position();
  has_moved_ = false;
  if (press_.y() < kRuler || press_.y() >= lanes().margin) {
    mode_ = Mode::kScrub;
    mouseMoveEvent(event);
    return;
  }
  const auto row = row_at(press_);
  if (!row) {
    mode_ = Mode::kBox;
    return;
  }
  select(*row, event->modifiers());
  const MotionRow& step = editor_.rows().rows[*row];
  const bool has_time = step.kind == InputKind::kMove || step.kind == InputKind::kWait;
  if (!has_time || !is_key_at(*row, press_) || event->modifiers().testFlag(Qt::ControlModifier)) return;
  drag_row_ = *row;
  drag_factor_ = 1.0;
  mode_ = selected().size() > 1 ? Mode::kScale : Mode::kKey;
}

void Timeline::mouseMoveEvent(QMouseEvent* event) {
  pointer_ = event->position();
  if (mode_ == Mode::kScrub) {
    scrub_s_ = std::max(0.0, time_at(pointer_.x()));
    if (const auto tick = tick_at(*scrub_s_)) Q_EMIT scrubbed(*tick);
  }
  has_moved_ = has_moved_ || std::abs(pointer_.x() - press_.x()) >= kDragBegin_px;
  if (mode_ == Mode::kKey && has_moved_) drag_key(pointer_.x(), event->modifiers().testFlag(Qt::AltModifier));
  if (mode_ == Mode::kScale && has_moved_) drag_scale(pointer_.x());
  if (mode_ == Mode::kNone) {
    const auto row = row_at(pointer_);
    viewport()->setCursor(row && is_key_at(*row, pointer_) ? Qt::SizeHorCursor : Qt::ArrowCursor);
    return;
  }
  viewport()->update();
}

void Timeline::drag_key(double x, bool is_fine) {
  const MotionRow& step = editor_.rows().rows[drag_row_];
  const double grid_s = is_fine ? 0.001 : 0.01;
  const double wish_s = time_at(x) - step.start_s;
  const double time_s = std::max(kShortestMove_s, std::round(wish_s / grid_s) * grid_s);
  if (step.time_s && std::abs(*step.time_s - time_s) < 0.0005) return;
  const std::size_t rows[]{drag_row_};
  editor_.edit([&](MotionDocument& document) {
    document.set_time(rows, time_s, "timeline " + std::to_string(rows[0]));
  });
}

void Timeline::drag_scale(double x) {
  const std::vector<std::size_t> rows = selected();
  if (rows.empty()) return;
  const double begin_s = editor_.rows().rows[rows.front()].start_s;
  const double old_s = time_at(press_.x()) - begin_s;
  drag_factor_ = old_s > 0.0 ? std::clamp((time_at(x) - begin_s) / old_s, 0.05, 20.0) : 1.0;
}

void Timeline::select_box() {
  const double begin_s = time_at(std::min(press_.x(), pointer_.x()));
  const double end_s = time_at(std::max(press_.x(), pointer_.x()));
  QItemSelection rows;
  const MotionSection& section = editor_.rows().sections[section_];
  for (std::size_t i = section.first_row; i < section.first_row + section.row_count; ++i) {
    const MotionRow& row = editor_.rows().rows[i];
    const double key_s = row.start_s + row.duration_s - row.pause_s;
    if (row.kind == InputKind::kLoop || row.kind == InputKind::kIf || key_s < begin_s || key_s > end_s)
      continue;
    const QModelIndex index = selection_.model()->index(static_cast<int>(i), 0);
    rows.select(index, index);
  }
  if (rows.isEmpty()) return;
  selection_.select(rows, QItemSelectionModel::ClearAndSelect | QItemSelectionModel::Rows);
  selection_.setCurrentIndex(rows.indexes().front(), QItemSelectionModel::NoUpdate);
}

void Timeline::mouseReleaseEvent(QMouseEvent* event) {
  const Mode mode = std::exchange(mode_, Mode::kNone);
  pointer_ = event->position();
  if (mode == Mode::kKey) editor_.end_drag();
  if (mode == Mode::kBox) select_box();
  if (mode == Mode::kScale && !has_moved_) {  // a click on one of several selected steps selects it alone
    selection_.clearSelection();
    select(drag_row_, Qt::NoModifier);
  }
  if (mode == Mode::kScale && std::abs(drag_factor_ - 1.0) > 0.001) {
    const std::vector<std::size_t> rows = selected();
    const double factor = drag_factor_;
    editor_.edit([&](MotionDocument& document) { document.scale_time(rows, factor); });
  }
  update_scroll_bar();
  viewport()->update();
}

void Timeline::mouseDoubleClickEvent(QMouseEvent* event) {
  if (row_at(event->position())) return;
  zoom_ = 1.0;
  update_scroll_bar();
  viewport()->update();
}

void Timeline::wheelEvent(QWheelEvent* event) {
  if (event->modifiers().testFlag(Qt::ControlModifier)) {
    zoom_at(event->position().x(), std::pow(1.25, event->angleDelta().y() / 120.0));
  } else {
    const QPoint delta = event->angleDelta();
    horizontalScrollBar()->setValue(horizontalScrollBar()->value() - delta.x() - delta.y());
  }
  event->accept();
}

void Timeline::keyPressEvent(QKeyEvent* event) {
  const int step = event->key() == Qt::Key_Left ? -1 : event->key() == Qt::Key_Right ? 1 : 0;
  const int row = selection_.currentIndex().row() + step;
  if (step == 0 || row < 0 || row >= selection_.model()->rowCount()) {
    QAbstractScrollArea::keyPressEvent(event);
    return;
  }
  selection_.setCurrentIndex(selection_.model()->index(row, 0),
                             QItemSelectionModel::ClearAndSelect | QItemSelectionModel::Rows);
}

void Timeline::scrollContentsBy(int, int) { viewport()->update(); }

void Timeline::resizeEvent(QResizeEvent* event) {
  QAbstractScrollArea::resizeEvent(event);
  update_scroll_bar();
}

// --- Tooltips

QString Timeline::tip_at(QPointF point) const {
  if (const auto row = row_at(point)) {
    const MotionRow& step = editor_.rows().rows[*row];
    QString tip = tr("%1: %2\n%3 s to %4 s")
                      .arg(*row + 1)
                      .arg(QString::fromStdString(step.text))
                      .arg(step.start_s, 0, 'f', 2)
                      .arg(step.start_s + step.duration_s, 0, 'f', 2);
    for (const RowFinding* const finding : editor_.findings_of(*row))
      tip += u'\n' + finding->code + u' ' + finding->text;
    return tip;
  }
  const auto tick = tick_at(time_at(point.x()));
  if (!tick || point.y() < lanes().margin) return {};
  const CheckResult& result = *editor_.checked();
  const CheckedTick& checked = result.ticks[*tick];
  const double time_s = editor_.shown_s()[*tick];
  if (point.y() < lanes().curves)
    return std::isnan(checked.margin_m) ? tr("%1 s: balance is not judged").arg(time_s, 0, 'f', 2)
                                        : tr("%1 s: stability margin %2 mm")
                                              .arg(time_s, 0, 'f', 2)
                                              .arg(checked.margin_m * kMmPerM, 0, 'f', 1);
  QString tip = tr("%1 s").arg(time_s, 0, 'f', 2);
  if (const auto joint = shown_joint(); joint && *joint < result.joints) {
    tip += tr("\n%1: %2°")
               .arg(QString::fromStdString(editor_.document().robot().model.joint_names[*joint]))
               .arg(result.targets_rad[*tick * result.joints + *joint] * kDegreesPerRad, 0, 'f', 1);
    if (checked.loads != nullptr)
      tip += tr(", %1 N m of %2 N m that the servo has at the lowest supply")
                 .arg(checked.loads->at(*joint).torque_Nm, 0, 'f', 2)
                 .arg(checked.loads->at(*joint).available_Nm, 0, 'f', 2);
  }
  if (!std::isnan(checked.torque_share))
    tip +=
        tr("\nmost loaded: %1, with %2 % of what its servo has")
            .arg(QString::fromStdString(editor_.document().robot().model.joint_names[checked.torque_joint]))
            .arg(100.0 * checked.torque_share, 0, 'f', 0);
  return tip;
}

bool Timeline::viewportEvent(QEvent* event) {
  if (event->type() == QEvent::ToolTip && editor_.is_open()) {
    const auto* const help = static_cast<QHelpEvent*>(event);
    QToolTip::showText(help->globalPos(), tip_at(help->pos()), viewport());
    return true;
  }
  return QAbstractScrollArea::viewportEvent(event);
}

}  // namespace koboshi::studio
