#pragma once

#include <QString>
#include <QWidget>

#include "studio/view/sole_picture.h"

namespace koboshi::studio {

// The soles from above at the cursor, with the support polygon, the zero moment points, the centre of mass
// and the capture point, each with its way during the last second. Forward is up.
class SolePanel final : public QWidget {
  Q_OBJECT

 public:
  explicit SolePanel(QWidget* parent = nullptr);

  // The recording must outlive its use here; null: none. It may grow.
  void set_recording(const view::Recording* recording);
  void set_cursor(std::uint64_t time_us);
  // The present picture, computed when it is painted; nothing without soles.
  const std::optional<SolePicture>& picture() const { return picture_; }
  // Where a point of the picture is in the widget.
  QPointF place_of(const Eigen::Vector2d& p_m) const;

  QSize sizeHint() const override { return {320, 320}; }
  QSize minimumSizeHint() const override { return {180, 180}; }

 protected:
  void paintEvent(QPaintEvent* event) override;
  bool event(QEvent* event) override;

 private:
  void fit();
  void paint_grid(QPainter& painter) const;
  void paint_soles(QPainter& painter) const;
  void paint_point(QPainter& painter, const SolePoint& point) const;
  void paint_legend(QPainter& painter) const;
  QString name_of(const SolePoint& point) const;
  QColor colour_of(const SolePoint& point) const;
  QString tip_at(const QPointF& place) const;

  const view::Recording* recording_ = nullptr;
  std::uint64_t time_us_ = 0;
  std::optional<SolePicture> picture_;
  double px_per_m_ = 1000.0;
};

}  // namespace koboshi::studio
