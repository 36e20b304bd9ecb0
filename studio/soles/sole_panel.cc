#include "studio/soles/sole_panel.h"

#include <QHelpEvent>
#include <QPainter>
#include <QPainterPath>
#include <QToolTip>
#include <algorithm>
#include <array>
#include <cmath>

#include "base/text/user_units.h"

namespace koboshi::studio {
namespace {

// Half the width that is shown: the first that holds soles and support polygon with a margin.
constexpr std::array kReaches_m{0.08, 0.12, 0.18, 0.25, 0.4, 0.7};
constexpr double kGrid_m = 0.05;
constexpr double kPoint_px = 6.0;
constexpr double kHit_px = 9.0;
constexpr int kLegend_px = 16;  // height of a line
constexpr QRgb kCaptureColour = 0xff7b4fc4;

QColor colour_of_mark(const view::Colour& colour) {
  return QColor::fromRgbF(colour.red, colour.green, colour.blue);
}

QColor faint(QColor colour, double opacity) {
  colour.setAlphaF(static_cast<float>(opacity));
  return colour;
}

}  // namespace

SolePanel::SolePanel(QWidget* parent) : QWidget(parent) {
  setAccessibleName(tr("Soles from above"));
  setSizePolicy(QSizePolicy::Expanding, QSizePolicy::Expanding);
}

void SolePanel::set_recording(const view::Recording* recording) {
  recording_ = recording;
  time_us_ = 0;
  update();
}

void SolePanel::set_cursor(std::uint64_t time_us) {
  time_us_ = time_us;
  update();
}

QString SolePanel::name_of(const SolePoint& point) const {
  switch (point.kind) {
    case SolePoint::Kind::kCom:
      return tr("centre of mass");
    case SolePoint::Kind::kCapturePoint:
      return tr("capture point");
    case SolePoint::Kind::kZmp:
      break;
  }
  const std::array names{tr("planned ZMP"), tr("measured ZMP"), tr("true ZMP")};
  return names.at(static_cast<std::size_t>(point.mark - view::kZmpMarks.data()));
}

// On a dark palette, the true ZMP is as light as text.
QColor SolePanel::colour_of(const SolePoint& point) const {
  if (point.kind == SolePoint::Kind::kCom) return colour_of_mark(view::kComColour);
  if (point.kind == SolePoint::Kind::kCapturePoint) return QColor::fromRgb(kCaptureColour);
  if (point.mark == &view::kZmpMarks.back()) return palette().color(QPalette::Text);
  return colour_of_mark(point.mark->colour);
}

void SolePanel::fit() {
  double reach_m = 0.0;
  const auto include = [&](const std::vector<Eigen::Vector2d>& points_m) {
    for (const Eigen::Vector2d& p_m : points_m) reach_m = std::max(reach_m, p_m.lpNorm<Eigen::Infinity>());
  };
  for (const auto& sole_m : picture_->soles_m) include(sole_m);
  include(picture_->support_m);
  const auto holds = [&](double half_m) { return half_m > 1.1 * reach_m; };
  const auto found = std::ranges::find_if(kReaches_m, holds);
  const double half_m = found == kReaches_m.end() ? kReaches_m.back() : *found;
  const auto lines = static_cast<int>(picture_->points.size()) + 1;
  const double height_px = std::max(60, height() - lines * kLegend_px);
  px_per_m_ = 0.5 * std::min<double>(width(), height_px) / half_m;
}

QPointF SolePanel::place_of(const Eigen::Vector2d& p_m) const {
  const auto lines = picture_ ? static_cast<int>(picture_->points.size()) + 1 : 0;
  const QPointF centre(0.5 * width(), 0.5 * (height() - lines * kLegend_px));
  return centre + px_per_m_ * QPointF(-p_m.y(), -p_m.x());
}

void SolePanel::paint_grid(QPainter& painter) const {
  QColor line = palette().color(QPalette::Text);
  line.setAlphaF(0.1F);
  painter.setPen(line);
  const int count = static_cast<int>(std::ceil(std::max(width(), height()) / (px_per_m_ * kGrid_m)));
  for (int i = -count; i <= count; ++i) {
    const QPointF place = place_of({i * kGrid_m, -i * kGrid_m});
    painter.drawLine(QPointF(0, std::round(place.y()) + 0.5), QPointF(width(), std::round(place.y()) + 0.5));
    painter.drawLine(QPointF(std::round(place.x()) + 0.5, 0), QPointF(std::round(place.x()) + 0.5, height()));
  }
  painter.setPen(palette().color(QPalette::PlaceholderText));
  painter.drawText(QRectF(6, 2, width() - 12, kLegend_px), Qt::AlignLeft, tr("forward ↑"));
  painter.drawText(QRectF(6, 2, width() - 12, kLegend_px), Qt::AlignRight, tr("grid 50 mm"));
}

void SolePanel::paint_soles(QPainter& painter) const {
  const auto polygon = [&](const std::vector<Eigen::Vector2d>& points_m) {
    QPolygonF places;
    for (const Eigen::Vector2d& p_m : points_m) places << place_of(p_m);
    return places;
  };
  for (std::size_t side = 0; side < 2; ++side) {
    const QColor colour = colour_of_mark(view::kSideColours[side]);
    painter.setPen(QPen(colour, 1.4, picture_->carry[side] ? Qt::SolidLine : Qt::DashLine));
    painter.setBrush(faint(colour, picture_->carry[side] ? 0.22 : 0.05));
    painter.drawPolygon(polygon(picture_->soles_m[side]));
  }
  if (picture_->support_m.size() < 3) return;
  const QColor colour = colour_of_mark(view::kMeasuredColour);
  painter.setPen(QPen(colour, 1.6));
  painter.setBrush(faint(colour, 0.08));
  painter.drawPolygon(polygon(picture_->support_m));
}

void SolePanel::paint_point(QPainter& painter, const SolePoint& point) const {
  const QColor colour = colour_of(point);
  const auto count = point.trail_m.size();
  for (std::size_t i = 1; i < count; ++i) {
    if (!point.trail_m[i - 1].allFinite() || !point.trail_m[i].allFinite()) continue;
    const double age = 1.0 - static_cast<double>(i) / static_cast<double>(count);
    painter.setPen(QPen(faint(colour, 0.75 * (1.0 - age) + 0.05), 1.4));
    painter.drawLine(place_of(point.trail_m[i - 1]), place_of(point.trail_m[i]));
  }
  if (!point.now_m.allFinite()) return;
  const QPointF place = place_of(point.now_m);
  painter.setPen(QPen(palette().color(QPalette::Base), 1.0));
  painter.setBrush(colour);
  if (point.kind == SolePoint::Kind::kZmp) {
    // Rings in each other, as in the view, so that coincident points look like a target.
    const double radius_px = kPoint_px * point.mark->radius_m / view::kZmpMarks[1].radius_m;
    const double inner_px = kPoint_px * point.mark->inner_radius_m / view::kZmpMarks[1].radius_m;
    QPainterPath ring;
    ring.addEllipse(place, radius_px, radius_px);
    ring.addEllipse(place, inner_px, inner_px);
    painter.setPen(Qt::NoPen);
    painter.drawPath(ring);
  } else if (point.kind == SolePoint::Kind::kCom) {
    painter.drawRect(
        QRectF(place - QPointF(kPoint_px - 1, kPoint_px - 1), place + QPointF(kPoint_px - 1, kPoint_px - 1)));
  } else {
    painter.drawPolygon(
        QPolygonF({place + QPointF(0, -kPoint_px - 1), place + QPointF(kPoint_px + 1, kPoint_px),
                   place + QPointF(-kPoint_px - 1, kPoint_px)}));
  }
}

void SolePanel::paint_legend(QPainter& painter) const {
  const auto lines = static_cast<int>(picture_->points.size()) + 1;
  double y = height() - lines * kLegend_px - 2.0;
  painter.fillRect(QRectF(0, y - 2, width(), height() - y + 2), palette().color(QPalette::Base));
  const auto line = [&](const QColor& colour, const QString& name, const QString& value) {
    painter.setPen(Qt::NoPen);
    painter.setBrush(colour);
    painter.drawEllipse(QPointF(12, y + 0.5 * kLegend_px), 3.5, 3.5);
    painter.setPen(palette().color(QPalette::Text));
    painter.drawText(QRectF(22, y, width() - 28, kLegend_px), Qt::AlignLeft | Qt::AlignVCenter, name);
    painter.drawText(QRectF(22, y, width() - 28, kLegend_px), Qt::AlignRight | Qt::AlignVCenter, value);
    y += kLegend_px;
  };
  for (const SolePoint& point : picture_->points)
    line(colour_of(point), name_of(point),
         point.now_m.allFinite() ? tr("%1, %2 mm")
                                       .arg(kMmPerM * point.now_m.x(), 0, 'f', 1)
                                       .arg(kMmPerM * point.now_m.y(), 0, 'f', 1)
                                 : tr("unknown"));
  line(colour_of_mark(view::kMeasuredColour), tr("support polygon"),
       picture_->margin_m ? tr("ZMP %1 mm %2")
                                .arg(kMmPerM * std::abs(*picture_->margin_m), 0, 'f', 1)
                                .arg(*picture_->margin_m >= 0.0 ? tr("inside") : tr("outside"))
                          : tr("no ground contact"));
}

void SolePanel::paintEvent(QPaintEvent* /*event*/) {
  QPainter painter(this);
  painter.fillRect(rect(), palette().color(QPalette::Base));
  picture_ = recording_ != nullptr ? sole_picture(*recording_, time_us_) : std::nullopt;
  if (!picture_) {
    painter.setPen(palette().color(QPalette::PlaceholderText));
    painter.drawText(rect(), Qt::AlignCenter, tr("A run shows its soles here."));
    return;
  }
  fit();
  painter.setRenderHint(QPainter::Antialiasing);
  paint_grid(painter);
  paint_soles(painter);
  for (const SolePoint& point : picture_->points) paint_point(painter, point);
  paint_legend(painter);
}

QString SolePanel::tip_at(const QPointF& place) const {
  if (!picture_) return {};
  for (const SolePoint& point : picture_->points) {
    if (!point.now_m.allFinite()) continue;
    const QPointF offset = place_of(point.now_m) - place;
    if (std::hypot(offset.x(), offset.y()) < kHit_px)
      return tr("%1: %2 mm forward, %3 mm to the left of the middle between the soles")
          .arg(name_of(point))
          .arg(kMmPerM * point.now_m.x(), 0, 'f', 1)
          .arg(kMmPerM * point.now_m.y(), 0, 'f', 1);
  }
  return {};
}

bool SolePanel::event(QEvent* event) {
  if (event->type() == QEvent::ToolTip) {
    const auto* help = static_cast<QHelpEvent*>(event);
    QToolTip::showText(help->globalPos(), tip_at(QPointF(help->pos())), this);
    return true;
  }
  return QWidget::event(event);
}

}  // namespace koboshi::studio
