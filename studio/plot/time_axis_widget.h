#pragma once

#include <QWidget>
#include <optional>

#include "studio/plot/time_view.h"

namespace koboshi::studio {

// A widget over a common time axis. The mouse and the keys move the range and the cursor:
//   click: place the cursor                     drag the cursor's line: move it
//   drag: shift the range                       Shift + drag: zoom into a range
//   wheel: zoom about the pointer               Shift + wheel, horizontal wheel: shift the range
//   double click: show everything               Left, Right: cursor to the neighbouring sample (Shift: tenth
//   of the range) Ctrl + Left, Right: shift the range         +, -: zoom about the cursor Home, End: cursor
//   to the start or the end   0: show everything
class TimeAxisWidget : public QWidget {
  Q_OBJECT

 public:
  static constexpr int kAxisWidth =
      66;  // labels of the value axis; the same for all, so that their times are aligned
  static constexpr int kRightMargin = 10;

  // The view outlives the widget.
  TimeAxisWidget(TimeView& view, QWidget* parent);

  TimeView& view() { return view_; }
  const TimeView& view() const { return view_; }
  double x_of(double time_us) const;
  double time_at(double x) const;

 protected:
  // The time of the next (or, if not forward, of the previous) sample, for the arrow keys.
  virtual std::optional<std::uint64_t> neighbour_us(std::uint64_t time_us, bool forward) const;
  // The range that is being selected, as pixels left and right.
  std::optional<std::pair<double, double>> selection() const;
  void draw_cursor(QPainter& painter, double top, double bottom) const;
  void draw_selection(QPainter& painter, double top, double bottom) const;

  void mousePressEvent(QMouseEvent* event) override;
  void mouseMoveEvent(QMouseEvent* event) override;
  void mouseReleaseEvent(QMouseEvent* event) override;
  void mouseDoubleClickEvent(QMouseEvent* event) override;
  void wheelEvent(QWheelEvent* event) override;
  void keyPressEvent(QKeyEvent* event) override;

 private:
  enum class Drag { kNone, kCursor, kPress, kPan, kSelect };

  bool is_at_cursor(double x) const;
  void step_cursor(bool forward, Qt::KeyboardModifiers modifiers);

  TimeView& view_;
  Drag drag_ = Drag::kNone;
  double press_x_ = 0.0;
  double last_x_ = 0.0;
};

}  // namespace koboshi::studio
