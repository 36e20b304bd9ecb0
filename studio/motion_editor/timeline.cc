#include "studio/motion_editor/timeline.h"

#include <QScrollBar>
#include <algorithm>
#include <cmath>

#include "studio/motion_editor/timeline_layout.h"

namespace koboshi::studio {

using Kind = simulation::StepSource::Kind;

Timeline::Timeline(MotionEditor& editor, QItemSelectionModel& selection, QWidget* parent)
    : QAbstractScrollArea(parent), editor_(editor), selection_(selection) {
  setFrameShape(QFrame::NoFrame);
  setVerticalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
  setFocusPolicy(Qt::StrongFocus);
  viewport()->setMouseTracking(true);
  connect(&editor, &MotionEditor::opened, this, &Timeline::fit);
  connect(&editor, &MotionEditor::changed, this, &Timeline::follow_document);
  connect(&editor, &MotionEditor::findings_changed, this, [this] { viewport()->update(); });
  connect(&selection, &QItemSelectionModel::selectionChanged, this, &Timeline::follow_selection);
  connect(&selection, &QItemSelectionModel::currentRowChanged, this, &Timeline::follow_selection);
}

// --- Geometry

void Timeline::follow_document() {
  if (section_ >= editor_.rows().sections.size()) section_ = 0;
  update_lanes();
  update_scroll_bar();
  viewport()->update();
}

void Timeline::follow_selection() {
  const auto row = static_cast<std::size_t>(selection_.currentIndex().row());
  if (selection_.currentIndex().isValid() && row < editor_.rows().rows.size()) {
    const MotionRow& step = editor_.rows().rows[row];
    if (step.section != section_) {
      section_ = step.section;
      update_lanes();
      update_scroll_bar();
    }
    const double x = x_of(step.start_s);
    if (zoom_ > 1.0 && mode_ == Mode::kNone && (x < 0 || x > viewport()->width()))
      horizontalScrollBar()->setValue(horizontalScrollBar()->value() +
                                      static_cast<int>(x - viewport()->width() / 2.0));
  }
  scrub_s_.reset();
  viewport()->update();
}

void Timeline::update_lanes() {
  else_lanes_ = 0;
  moving_joint_.reset();
  if (!editor_.is_open() || section_ >= editor_.rows().sections.size()) return;
  const MotionSection& section = editor_.rows().sections[section_];
  std::vector<double> least = editor_.document().robot().standing_rad;
  std::vector<double> most = least;
  for (std::size_t i = section.first_row; i < section.first_row + section.row_count; ++i) {
    const MotionRow& row = editor_.rows().rows[i];
    else_lanes_ = std::max(else_lanes_, else_depth(editor_.rows(), row));
    for (std::size_t j = 0; j < std::min(least.size(), row.angles_rad.size()); ++j) {
      least[j] = std::min(least[j], row.angles_rad[j]);
      most[j] = std::max(most[j], row.angles_rad[j]);
    }
  }
  double widest_rad = -1.0;
  for (std::size_t j = 0; j < least.size(); ++j) {
    if (most[j] - least[j] <= widest_rad) continue;
    widest_rad = most[j] - least[j];
    moving_joint_ = j;
  }
  setMinimumHeight(lanes().curves + kLeastCurves + horizontalScrollBar()->sizeHint().height());
}

void Timeline::set_joint(std::optional<std::size_t> joint) {
  if (joint_ == joint) return;
  joint_ = joint;
  viewport()->update();
}

double Timeline::duration_s() const {
  if (!editor_.is_open() || section_ >= editor_.rows().sections.size()) return kShortest_s;
  double end_s = std::max(editor_.rows().sections[section_].duration_s, kShortest_s);
  if (section_ == 0 && !editor_.shown_s().empty() && zoom_ == 1.0)
    end_s = std::max(end_s, std::min(editor_.shown_s().back(), end_s + kShownRest_s));
  return end_s;
}

void Timeline::update_scroll_bar() {
  if (mode_ != Mode::kNone) return;  // a drag keeps the scale
  const double width = viewport()->width() - kLeft - kRight;
  px_per_s_ = std::max(1.0, width) / duration_s() * zoom_;
  horizontalScrollBar()->setRange(0, std::max(0, static_cast<int>(width * (zoom_ - 1.0))));
  horizontalScrollBar()->setPageStep(viewport()->width());
  horizontalScrollBar()->setSingleStep(20);
}

void Timeline::zoom(double factor) {
  double x = viewport()->width() / 2.0;
  const auto row = static_cast<std::size_t>(selection_.currentIndex().row());
  if (selection_.currentIndex().isValid() && row < editor_.rows().rows.size()) {
    const double current = x_of(editor_.rows().rows[row].start_s);
    if (current >= kLeft && current < viewport()->width()) x = current;
  }
  zoom_at(x, factor);
}

// The time at `x` stays there.
void Timeline::zoom_at(double x, double factor) {
  const double time_s = time_at(x);
  zoom_ = std::clamp(zoom_ * factor, 1.0, kMostZoom);
  update_scroll_bar();
  horizontalScrollBar()->setValue(static_cast<int>(kLeft + time_s * px_per_s_ - x));
  viewport()->update();
}

void Timeline::fit() {
  zoom_ = 1.0;
  section_ = 0;
  scrub_s_.reset();
  update_lanes();
  update_scroll_bar();
  viewport()->update();
}

double Timeline::x_of(double time_s) const {
  return kLeft + time_s * px_per_s_ - horizontalScrollBar()->value();
}

double Timeline::time_at(double x) const { return (x - kLeft + horizontalScrollBar()->value()) / px_per_s_; }

Timeline::Lanes Timeline::lanes() const {
  const int steps = kRuler + kArrows;
  const int margin = steps + kSteps + std::max(1, else_lanes_) * kOtherwise;
  return {kRuler, steps, steps + kSteps, margin, margin + kMargin, viewport()->height()};
}

int Timeline::Lanes::middle_of(int depth) const {
  return depth == 0 ? steps + kSteps / 2 : otherwise + (2 * depth - 1) * kOtherwise / 2;
}

QRectF Timeline::bar_of(const MotionRow& row) const {
  const int depth = else_depth(editor_.rows(), row);
  const double height = depth > 0 ? kOtherwise - 3.0 : kSteps - 6.0;
  const double x = x_of(row.start_s);
  double end_s = row.start_s + row.duration_s;
  if (row.kind == Kind::kLoop || row.kind == Kind::kIf) end_s = row.start_s;
  return {x, lanes().middle_of(depth) - height / 2.0, std::max(x_of(end_s) - x, 0.0), height};
}

QPointF Timeline::key_point(std::size_t row) const {
  const MotionRow& step = editor_.rows().rows.at(row);
  const QRectF bar = bar_of(step);
  return {x_of(step.start_s + step.duration_s - step.pause_s), bar.center().y()};
}

bool Timeline::is_key_at(std::size_t row, QPointF point) const {
  const QPointF key = key_point(row);
  return std::abs(key.x() - point.x()) <= kKeyReach_px && std::abs(key.y() - point.y()) <= kOtherwise / 2.0;
}

std::optional<std::size_t> Timeline::row_at(QPointF point) const {
  const Lanes lane = lanes();
  if (!editor_.is_open() || point.y() < lane.arrows || point.y() >= lane.margin) return std::nullopt;
  const MotionSection& section = editor_.rows().sections[section_];
  std::optional<std::size_t> found;
  double nearest = kKeyReach_px + 1;
  for (std::size_t i = section.first_row; i < section.first_row + section.row_count; ++i) {
    const MotionRow& row = editor_.rows().rows[i];
    if (row.kind == Kind::kLoop && point.y() < lane.steps && point.x() >= x_of(row.start_s) &&
        point.x() <= x_of(row.start_s + row.duration_s))
      found = i;  // the innermost is the last
    if (point.y() < lane.steps || row.kind == Kind::kLoop || row.kind == Kind::kIf) continue;
    if (is_key_at(i, point)) {
      const double distance = std::abs(key_point(i).x() - point.x());
      if (distance <= nearest) {
        nearest = distance;
        found = i;
      }
    } else if (nearest > kKeyReach_px && bar_of(row).contains(point)) {
      found = i;
    }
  }
  return found;
}

std::optional<std::size_t> Timeline::tick_at(double time_s) const {
  const std::vector<double>& shown = editor_.shown_s();
  if (shown.empty() || section_ != 0) return std::nullopt;
  const auto after = std::ranges::upper_bound(shown, time_s);
  return after == shown.begin() ? 0 : static_cast<std::size_t>(after - shown.begin()) - 1;
}

}  // namespace koboshi::studio
