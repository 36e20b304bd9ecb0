#include <QPainter>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/text/user_units.h"
#include "firmware/fixed/host/convert.h"
#include "studio/motion_editor/timeline.h"
#include "studio/motion_editor/timeline_layout.h"
#include "tools/motion_check/report.h"

// The curves of the check's results, below the steps of the timeline.
namespace koboshi::studio {
namespace {

// The band of the margin shows at least these, and more where the motion has more.
constexpr double kMostMargin_mm = 20.0;
constexpr double kLeastMargin_mm = 10.0;
constexpr double kMarginLimit_mm = 100.0;

}  // namespace

std::pair<std::size_t, std::size_t> Timeline::ticks_in(int x) const {
  const std::vector<double>& shown = editor_.shown_s();
  const auto begin = std::ranges::lower_bound(shown, time_at(x));
  const auto end = std::lower_bound(begin, shown.end(), time_at(x + 1));
  const auto first = static_cast<std::size_t>(begin - shown.begin());
  const auto last = static_cast<std::size_t>(end - shown.begin());
  if (first == last && first > 0 && first < shown.size()) return {first - 1, first};  // wide ticks
  return {first, last};
}

void Timeline::paint_margin(QPainter& painter, const Colours& colours) const {
  const Lanes lane = lanes();
  const double height = kMargin - 6.0;
  const double top = lane.margin + 3.0;
  double most_mm = kMostMargin_mm;
  for (std::size_t i = 0; editor_.checked() != nullptr && i < editor_.checked()->ticks.size(); ++i) {
    const double margin_mm = editor_.checked()->ticks[i].margin_m * kMmPerM;
    if (margin_mm > most_mm) most_mm = std::min(margin_mm, kMarginLimit_mm);
  }
  const double least_mm = -std::max(kLeastMargin_mm, most_mm / 4.0);
  const auto y_of = [&](double margin_mm) {
    const double share = (std::clamp(margin_mm, least_mm, most_mm) - least_mm) / (most_mm - least_mm);
    return top + height * (1.0 - share);
  };
  const double zero = y_of(0.0);
  painter.save();
  painter.setClipping(false);
  painter.setPen(colours.dim);
  painter.drawText(QRectF(4, lane.margin + 1, kLeft - 8, 14), Qt::AlignLeft, tr("margin"));
  painter.drawText(QRectF(4, zero - 8, kLeft - 12, 16), Qt::AlignRight | Qt::AlignVCenter, tr("0 mm"));
  painter.restore();
  painter.setRenderHint(QPainter::Antialiasing, false);
  const auto is_judged = [&] {
    return editor_.checked() != nullptr && section_ == 0 && editor_.document().compiled() != nullptr;
  };
  for (int x = kLeft; is_judged() && x < viewport()->width(); ++x) {
    const auto [first, last] = ticks_in(x);
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = first; i < last; ++i) {
      const double margin = editor_.checked()->ticks[i].margin_m;
      if (!std::isnan(margin)) least = std::min(least, margin);
    }
    if (std::isinf(least)) continue;
    QColor colour = least >= tools::CheckLimits::kClose_m     ? colours.stable
                    : least >= -tools::CheckLimits::kBeyond_m ? colours.close
                                                              : colours.unstable;
    const double y = y_of(least * kMmPerM);
    painter.setPen(colour);
    painter.drawLine(QPointF(x, y), QPointF(x, y + 1));
    colour.setAlpha(editor_.is_checking() ? 50 : 110);
    painter.setPen(colour);
    painter.drawLine(QPointF(x, std::min(y, zero)), QPointF(x, std::max(y, zero)));
  }
  painter.setPen(colours.dim);
  painter.drawLine(QPointF(kLeft, zero), QPointF(viewport()->width(), zero));
  painter.setRenderHint(QPainter::Antialiasing);
  if (!is_judged() && section_ == 0)
    painter.drawText(QRectF(kLeft + 8, top, 400, 16),
                     editor_.is_checking() ? tr("checking…") : tr("no result: the motion has errors"));
  if (section_ != 0)
    painter.drawText(QRectF(kLeft + 8, top, 500, 16), tr("A routine is checked where the program calls it."));
}

void Timeline::paint_curves(QPainter& painter, const Colours& colours) const {
  const Lanes lane = lanes();
  const MotionRobot& robot = editor_.document().robot();
  const auto shown = shown_joint();
  if (!shown || *shown >= robot.model.joint_names.size()) return;
  const robot::Joint& joint = robot.model.model.joints[*shown];
  const double lower_deg = fixed::to_double(joint.lower) * kDegreesPerRad;
  const double upper_deg = fixed::to_double(joint.upper) * kDegreesPerRad;
  const QRectF area(kLeft, lane.curves + 18.0, viewport()->width() - kLeft, lane.end - lane.curves - 24.0);
  const auto y_of = [&](double angle_deg) {
    return area.bottom() - (angle_deg - lower_deg) / (upper_deg - lower_deg) * area.height();
  };
  paint_speed(painter, colours, area);
  paint_torque(painter, colours, area);
  painter.setPen(QPen(colours.angle, 1, Qt::DashLine));
  for (const double limit_deg : {lower_deg, upper_deg})
    painter.drawLine(QPointF(area.left(), y_of(limit_deg)), QPointF(area.right(), y_of(limit_deg)));
  QPolygonF curve;
  const CheckResult* const result = editor_.checked();
  if (result != nullptr && section_ == 0 && *shown < result->joints) {
    std::size_t drawn = editor_.shown_s().size();
    for (int x = kLeft; x < viewport()->width(); ++x) {
      const auto [first, last] = ticks_in(x);
      if (first < last && first != std::exchange(drawn, first))
        curve << QPointF(x, y_of(result->targets_rad[first * result->joints + *shown] * kDegreesPerRad));
    }
  } else {
    const MotionSection& section = editor_.rows().sections[section_];
    curve << QPointF(x_of(0.0), y_of(robot.standing_rad.at(*shown) * kDegreesPerRad));
    for (std::size_t i = section.first_row; i < section.first_row + section.row_count; ++i) {
      const MotionRow& row = editor_.rows().rows[i];
      const bool has_body =
          row.kind == simulation::StepSource::Kind::kLoop || row.kind == simulation::StepSource::Kind::kIf;
      if (row.angles_rad.size() > *shown && !has_body && else_depth(editor_.rows(), row) == 0)
        curve << QPointF(x_of(row.start_s + row.duration_s), y_of(row.angles_rad[*shown] * kDegreesPerRad));
    }
  }
  painter.setPen(QPen(colours.angle, 1.8));
  painter.drawPolyline(curve);
  painter.save();
  painter.setClipping(false);
  painter.setPen(colours.angle);
  const auto label = [&](double angle_deg) {
    painter.drawText(QRectF(0, y_of(angle_deg) - 8, kLeft - 4, 16), Qt::AlignRight | Qt::AlignVCenter,
                     tr("%1°").arg(angle_deg, 0, 'f', 0));
  };
  label(lower_deg);
  label(upper_deg);
  if (lower_deg < -8 && upper_deg > 8 && area.height() > 60) label(0.0);
  double x = kLeft + 4;
  const auto legend = [&](const QString& text, const QColor& colour) {
    painter.setPen(colour);
    painter.drawText(QPointF(x, lane.curves + 13), text);
    x += painter.fontMetrics().horizontalAdvance(text) + 18;
  };
  const QString name = QString::fromStdString(robot.model.joint_names[*shown]).replace(u'_', u' ');
  legend(tr("%1, with its limits").arg(name), colours.angle);
  legend(tr("its speed, % of the limit"), colours.speed);
  if (result != nullptr && *shown < result->stall_torques_Nm.size())
    legend(tr("its torque, dotted: available; top: %1 N m").arg(result->stall_torques_Nm[*shown], 0, 'f', 2),
           colours.torque);
  painter.restore();
}

void Timeline::paint_speed(QPainter& painter, const Colours& colours, const QRectF& area) const {
  const CheckResult* const result = editor_.checked();
  if (result == nullptr || section_ != 0 || *shown_joint() >= result->joints) return;
  const double limit =
      fixed::to_double(editor_.document().robot().model.model.joints[*shown_joint()].max_speed);
  QColor fill = colours.speed;
  fill.setAlpha(90);
  painter.setPen(fill);
  for (int x = kLeft; x < viewport()->width(); ++x) {
    const auto [first, last] = ticks_in(x);
    double speed = 0.0;
    for (std::size_t i = std::max<std::size_t>(first, 1); i < last; ++i) {
      const std::size_t at = i * result->joints + *shown_joint();
      speed = std::max(speed, std::abs(result->targets_rad[at] - result->targets_rad[at - result->joints]) /
                                  tools::kTick_s / limit);
    }
    const double y = area.bottom() - std::min(speed, 1.0) * area.height();
    if (speed > 0.0) painter.drawLine(QPointF(x, area.bottom()), QPointF(x, y));
  }
}

// The torque of the joint's servo and, dashed, what it has at that speed; the top is its stall torque. Where
// several ticks share a column, the highest torque and the lowest available one.
void Timeline::paint_torque(QPainter& painter, const Colours& colours, const QRectF& area) const {
  const CheckResult* const result = editor_.checked();
  if (result == nullptr || section_ != 0 || *shown_joint() >= result->stall_torques_Nm.size()) return;
  const double top_Nm = result->stall_torques_Nm[*shown_joint()];
  const auto y_of = [&](double torque_Nm) {
    return area.bottom() - std::clamp(torque_Nm / top_Nm, 0.0, 1.0) * area.height();
  };
  QPolygonF torques;
  QPolygonF available;
  const auto finish = [&] {
    painter.setPen(QPen(colours.torque, 1.0, Qt::DotLine));
    painter.drawPolyline(std::exchange(available, {}));
    painter.setPen(QPen(colours.torque, 1.4));
    painter.drawPolyline(std::exchange(torques, {}));
  };
  for (int x = kLeft; x < viewport()->width(); ++x) {
    const auto [first, last] = ticks_in(x);
    double torque_Nm = -1.0;
    double available_Nm = top_Nm;
    for (std::size_t i = first; i < last; ++i) {
      if (result->ticks[i].loads == nullptr) continue;
      const tools::ServoLoad& load = result->ticks[i].loads->at(*shown_joint());
      torque_Nm = std::max(torque_Nm, std::abs(static_cast<double>(load.torque_Nm)));
      available_Nm = std::min(available_Nm, static_cast<double>(load.available_Nm));
    }
    if (torque_Nm < 0.0) {
      if (first < last) finish();  // not judged
      continue;
    }
    torques << QPointF(x, y_of(torque_Nm));
    available << QPointF(x, y_of(available_Nm));
  }
  finish();
}

}  // namespace koboshi::studio
