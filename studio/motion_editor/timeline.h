#pragma once

#include <QAbstractScrollArea>
#include <QItemSelectionModel>
#include <optional>
#include <vector>

#include "studio/motion_editor/motion_editor.h"
#include "studio/widgets/colours.h"

namespace koboshi::studio {

// The steps of the program or of one routine over time: a bar for each step with a diamond where a move
// reaches its pose, arrows of loops, jumps and branches, the stability margin as a band, and the curves of
// one joint: its angle, its speed and the torque of its servo. A diamond can be dragged; a drag of several
// selected ones scales their time.
class Timeline final : public QAbstractScrollArea {  // Large: one function per thing that it draws
  Q_OBJECT

 public:
  Timeline(MotionEditor& editor, QItemSelectionModel& selection, QWidget* parent = nullptr);

  // The joint whose curves are shown.
  void set_joint(std::optional<std::size_t> joint);
  // Multiplies the scale, around the current step if it is in view.
  void zoom(double factor);
  void fit();
  // The tooltip of this place of the viewport.
  QString tip_at(QPointF point) const;
  // Where the pose of a move is reached, or a step ends, in the viewport.
  QPointF key_point(std::size_t row) const;

 Q_SIGNALS:
  // The user looks at this time of the last check.
  void scrubbed(std::size_t tick);

 protected:
  void paintEvent(QPaintEvent* event) override;
  void resizeEvent(QResizeEvent* event) override;
  bool viewportEvent(QEvent* event) override;
  void mousePressEvent(QMouseEvent* event) override;
  void mouseMoveEvent(QMouseEvent* event) override;
  void mouseReleaseEvent(QMouseEvent* event) override;
  void mouseDoubleClickEvent(QMouseEvent* event) override;
  void wheelEvent(QWheelEvent* event) override;
  void keyPressEvent(QKeyEvent* event) override;
  void scrollContentsBy(int dx, int dy) override;

 private:
  enum class Mode { kNone, kScrub, kKey, kScale, kBox };
  // Vertical positions in the viewport.
  struct Lanes {
    int arrows, steps, otherwise, margin, curves, end;
    // The middle of the steps in as many `else`.
    int middle_of(int else_depth) const;
  };

  void follow_document();
  void follow_selection();
  void update_scroll_bar();
  void update_lanes();
  void zoom_at(double x, double factor);
  // The joint whose curves are shown: the chosen one, or that which moves most.
  std::optional<std::size_t> shown_joint() const { return joint_ ? joint_ : moving_joint_; }
  double duration_s() const;
  double x_of(double time_s) const;
  double time_at(double x) const;
  Lanes lanes() const;
  QRectF bar_of(const MotionRow& row) const;
  std::optional<std::size_t> row_at(QPointF point) const;
  bool is_key_at(std::size_t row, QPointF point) const;
  std::optional<std::size_t> tick_at(double time_s) const;
  std::vector<std::size_t> selected() const;
  void select(std::size_t row, Qt::KeyboardModifiers modifiers);
  void select_box();
  void drag_key(double x, bool is_fine);
  void drag_scale(double x);

  // timeline_paint.cc
  void paint_ruler(QPainter& painter, const Colours& colours) const;
  void paint_steps(QPainter& painter, const Colours& colours) const;
  void paint_step(QPainter& painter, const Colours& colours, std::size_t row, bool is_selected) const;
  void paint_arrows(QPainter& painter, const Colours& colours) const;
  void paint_loop(QPainter& painter, const Colours& colours, const MotionRow& row) const;
  void paint_scrub(QPainter& painter, const Colours& colours) const;

  // timeline_curves.cc
  void paint_margin(QPainter& painter, const Colours& colours) const;
  void paint_curves(QPainter& painter, const Colours& colours) const;
  void paint_speed(QPainter& painter, const Colours& colours, const QRectF& area) const;
  void paint_torque(QPainter& painter, const Colours& colours, const QRectF& area) const;
  // The ticks that a column of pixels shows, as a half-open range.
  std::pair<std::size_t, std::size_t> ticks_in(int x) const;

  MotionEditor& editor_;
  QItemSelectionModel& selection_;
  std::size_t section_ = 0;
  std::optional<std::size_t> joint_;
  std::optional<std::size_t> moving_joint_;
  int else_lanes_ = 0;
  double zoom_ = 1.0;
  double px_per_s_ = 100.0;
  std::optional<double> scrub_s_;

  Mode mode_ = Mode::kNone;
  bool has_moved_ = false;  // since the button was pressed
  std::size_t drag_row_ = 0;
  double drag_factor_ = 1.0;  // of kScale, applied at its end
  QPointF press_;
  QPointF pointer_;
};

}  // namespace koboshi::studio
