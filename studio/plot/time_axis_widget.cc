#include "studio/plot/time_axis_widget.h"

#include <QApplication>
#include <QMouseEvent>
#include <QPainter>
#include <QWheelEvent>
#include <algorithm>
#include <cmath>

#include "studio/plot/plot_style.h"

namespace koboshi::studio {
namespace {

constexpr double kCursorGrab_px = 4.0;
constexpr double kZoomPerDegree = 0.0128;  // of the wheel: a notch of 15 degrees changes the range by a fifth
constexpr double kZoomPerKey = 1.25;
constexpr std::uint64_t kTick_us = 10'000;

}  // namespace

TimeAxisWidget::TimeAxisWidget(TimeView& view, QWidget* parent) : QWidget(parent), view_(view) {
  setFocusPolicy(Qt::StrongFocus);
  setMouseTracking(true);
  setAttribute(Qt::WA_OpaquePaintEvent);
  connect(&view_, &TimeView::cursor_changed, this, qOverload<>(&QWidget::update));
}

double TimeAxisWidget::x_of(double time_us) const {
  return kAxisWidth + (time_us - view_.from_us()) / view_.range_us() * (width() - kAxisWidth - kRightMargin);
}

double TimeAxisWidget::time_at(double x) const {
  return view_.from_us() +
         (x - kAxisWidth) / std::max(1, width() - kAxisWidth - kRightMargin) * view_.range_us();
}

std::optional<std::uint64_t> TimeAxisWidget::neighbour_us(std::uint64_t time_us, bool forward) const {
  if (forward) return time_us + kTick_us;
  return time_us > kTick_us ? time_us - kTick_us : 0;
}

std::optional<std::pair<double, double>> TimeAxisWidget::selection() const {
  if (drag_ != Drag::kSelect) return std::nullopt;
  const double left = kAxisWidth;
  const double right = width() - kRightMargin;
  return std::pair{std::clamp(std::min(press_x_, last_x_), left, right),
                   std::clamp(std::max(press_x_, last_x_), left, right)};
}

void TimeAxisWidget::draw_cursor(QPainter& painter, double top, double bottom) const {
  if (!view_.cursor_us()) return;
  const double x = x_of(static_cast<double>(*view_.cursor_us()));
  if (x < kAxisWidth - 0.5 || x > width() - kRightMargin + 0.5) return;
  painter.setRenderHint(QPainter::Antialiasing, false);
  painter.setPen(QPen(PlotStyle(palette()).cursor, hasFocus() ? 2.0 : 1.0));
  painter.drawLine(QPointF(std::floor(x), top), QPointF(std::floor(x), bottom));
}

void TimeAxisWidget::draw_selection(QPainter& painter, double top, double bottom) const {
  const auto range = selection();
  if (!range) return;
  QColor colour = palette().color(QPalette::Highlight);
  painter.setPen(colour);
  colour.setAlphaF(0.22F);
  painter.setBrush(colour);
  painter.drawRect(QRectF(range->first, top, range->second - range->first, bottom - top));
}

bool TimeAxisWidget::is_at_cursor(double x) const {
  return view_.cursor_us() && std::abs(x - x_of(static_cast<double>(*view_.cursor_us()))) <= kCursorGrab_px;
}

void TimeAxisWidget::mousePressEvent(QMouseEvent* event) {
  if (event->button() != Qt::LeftButton && event->button() != Qt::MiddleButton)
    return QWidget::mousePressEvent(event);
  press_x_ = last_x_ = event->position().x();
  if (event->button() == Qt::MiddleButton) {
    drag_ = Drag::kPan;
  } else if (event->modifiers().testFlag(Qt::ShiftModifier)) {
    drag_ = Drag::kSelect;
  } else {
    drag_ = is_at_cursor(press_x_) ? Drag::kCursor : Drag::kPress;
  }
}

void TimeAxisWidget::mouseMoveEvent(QMouseEvent* event) {
  const double x = event->position().x();
  if (drag_ == Drag::kNone) setCursor(is_at_cursor(x) ? Qt::SplitHCursor : Qt::ArrowCursor);
  if (drag_ == Drag::kPress && std::abs(x - press_x_) >= QApplication::startDragDistance())
    drag_ = Drag::kPan;
  if (drag_ == Drag::kPan) {
    setCursor(Qt::ClosedHandCursor);
    view_.pan(time_at(last_x_) - time_at(x));
  }
  if (drag_ == Drag::kCursor) view_.move_cursor(time_at(x));
  if (drag_ == Drag::kSelect) update();
  if (drag_ != Drag::kPress) last_x_ = x;
}

void TimeAxisWidget::mouseReleaseEvent(QMouseEvent* event) {
  const Drag drag = drag_;
  const auto range = selection();
  drag_ = Drag::kNone;
  unsetCursor();
  update();
  if (drag == Drag::kPress) view_.move_cursor(time_at(event->position().x()));
  if (range && range->second - range->first >= QApplication::startDragDistance())
    view_.set_range(time_at(range->first), time_at(range->second));
}

void TimeAxisWidget::mouseDoubleClickEvent(QMouseEvent* event) {
  if (event->button() == Qt::LeftButton) view_.show_all();
}

void TimeAxisWidget::wheelEvent(QWheelEvent* event) {
  const QPointF degrees = QPointF(event->angleDelta()) / 8.0;
  const bool is_shift = event->modifiers().testFlag(Qt::ShiftModifier);
  if (is_shift || std::abs(degrees.x()) > std::abs(degrees.y())) {
    view_.pan(-(degrees.x() + degrees.y()) / 150.0 * view_.range_us());  // a notch: a tenth of the range
  } else {
    view_.zoom(std::exp(-kZoomPerDegree * degrees.y()), time_at(event->position().x()));
  }
  event->accept();
}

void TimeAxisWidget::step_cursor(bool forward, Qt::KeyboardModifiers modifiers) {
  const double tenth_us = (forward ? 0.1 : -0.1) * view_.range_us();
  if (modifiers.testFlag(Qt::ControlModifier)) return view_.pan(tenth_us);
  const auto now_us = static_cast<std::uint64_t>(std::max(0.0, view_.from_us()));
  const std::uint64_t cursor_us = view_.cursor_us().value_or(now_us);
  if (modifiers.testFlag(Qt::ShiftModifier))
    return view_.move_cursor(static_cast<double>(cursor_us) + tenth_us);
  if (const auto time_us = neighbour_us(cursor_us, forward)) view_.move_cursor(static_cast<double>(*time_us));
}

void TimeAxisWidget::keyPressEvent(QKeyEvent* event) {
  const double about_us = view_.cursor_us() ? static_cast<double>(*view_.cursor_us()) : view_.to_us();
  switch (event->key()) {
    case Qt::Key_Left:
    case Qt::Key_Right:
      return step_cursor(event->key() == Qt::Key_Right, event->modifiers());
    case Qt::Key_Plus:
    case Qt::Key_Equal:
      return view_.zoom(1.0 / kZoomPerKey, about_us);
    case Qt::Key_Minus:
      return view_.zoom(kZoomPerKey, about_us);
    case Qt::Key_Home:
      return view_.move_cursor(view_.begin_us());
    case Qt::Key_End:
      return view_.move_cursor(view_.end_us());
    case Qt::Key_0:
      return view_.show_all();
    default:
      return QWidget::keyPressEvent(event);
  }
}

}  // namespace koboshi::studio
