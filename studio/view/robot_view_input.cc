#include <Eigen/Geometry>
#include <QApplication>
#include <QKeyEvent>
#include <QMouseEvent>
#include <QToolTip>
#include <QWheelEvent>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "base/text/user_units.h"
#include "studio/view/robot_view.h"

// Mouse and keyboard in the view, and the thing under the mouse.
namespace koboshi::studio {
namespace {

constexpr std::size_t kMaxNames = 3;  // of marks in one tooltip

Eigen::Vector2d pixels(const QPointF& point) { return {point.x(), point.y()}; }

QString frame_text(const RobotPicture& picture, std::size_t link) {
  const view::Pose& pose = picture.links()[link];
  const Eigen::Vector3d p_mm = kMmPerM * pose.p_WL_m.cast<double>();
  const Eigen::Matrix3d R = pose.q_WL.cast<double>().toRotationMatrix();
  const double roll_deg = kDegreesPerRad * std::atan2(R(2, 1), R(2, 2));
  const double pitch_deg = kDegreesPerRad * std::asin(std::clamp(-R(2, 0), -1.0, 1.0));
  const double yaw_deg = kDegreesPerRad * std::atan2(R(1, 0), R(0, 0));
  return RobotView::tr("Link %1: x %2, y %3, z %4 mm; roll %5°, pitch %6°, yaw %7°")
      .arg(QString::fromStdString(picture.scene().links[link].name))
      .arg(p_mm.x(), 0, 'f', 1)
      .arg(p_mm.y(), 0, 'f', 1)
      .arg(p_mm.z(), 0, 'f', 1)
      .arg(roll_deg, 0, 'f', 1)
      .arg(pitch_deg, 0, 'f', 1)
      .arg(yaw_deg, 0, 'f', 1);
}

QString axis_text(const RobotPicture& picture, const JointAxis& axis) {
  const view::Pose& pose = picture.links()[static_cast<std::size_t>(axis.link)];
  const Eigen::Vector3d p_mm = kMmPerM * (pose.p_WL_m.cast<double>() + pose.q_WL.cast<double>() * axis.p_L_m);
  return RobotView::tr("Joint %1: %2° of %3° to %4°; axis through x %5, y %6, z %7 mm")
      .arg(QString::fromStdString(axis.name))
      .arg(kDegreesPerRad * joint_angle_rad(axis, picture.links()), 0, 'f', 1)
      .arg(kDegreesPerRad * axis.lower_rad, 0, 'f', 1)
      .arg(kDegreesPerRad * axis.upper_rad, 0, 'f', 1)
      .arg(p_mm.x(), 0, 'f', 1)
      .arg(p_mm.y(), 0, 'f', 1)
      .arg(p_mm.z(), 0, 'f', 1);
}

}  // namespace

PicturePlace RobotView::at(const QPointF& place) const { return {width(), height(), pixels(place)}; }

std::optional<Handle> RobotView::gizmo_handle_at(const QPointF& place) const {
  return handles_.handle_at(picture_, at(place));
}

RobotView::Grabbed RobotView::grabbed_at(const QPointF& place, bool with_handles) const {
  return handles_.grabbed_at(picture_, at(place), with_handles);
}

// Marks are where the picture has them, which may be apart; their places are those of the robot.
QString RobotView::mark_text_at(const QPointF& place) const {
  QStringList lines;
  if (!picture_.can_be_drawn()) return {};
  const LinkLayers& layers = picture_.layers();
  for (const MarkName& mark :
       layers.at(picture_.drawn().links, picture_.camera(), width(), height(), pixels(place)))
    if (static_cast<std::size_t>(lines.size()) < kMaxNames)
      lines << (mark.kind == MarkName::Kind::kFrame ? frame_text(picture_, mark.index)
                                                    : axis_text(picture_, layers.axis(mark.index)));
  return lines.join(u'\n');
}

void RobotView::name_marks(const QPointF& place) {
  const QString text = mark_text_at(place);
  if (!text.isEmpty()) {
    QToolTip::showText(mapToGlobal(place).toPoint(), text, this);
  } else if (names_marks_) {
    QToolTip::hideText();
  }
  names_marks_ = !text.isEmpty();
}

void RobotView::hover(const QPointF& place) {
  const auto hit = link_at(place);
  const int link = hit ? hit->link : -1;
  if (std::exchange(hovered_, link) != link) Q_EMIT hovered(link);
  name_marks(place);
  if (handles_.hover(grabbed_at(place))) update();
}

// Where a mouse button that began a drag is released: a click chooses the link.
void RobotView::pick(const QPointF& place) {
  if ((place - drag_start_).manhattanLength() >= QApplication::startDragDistance()) return;
  if (const auto hit = picture_.link_near(at(place))) Q_EMIT picked(hit->link);
}

bool RobotView::begin_pose_drag(const QMouseEvent& event) {
  if (event.button() != Qt::LeftButton) return false;
  const bool rotates = event.modifiers() == (Qt::ControlModifier | Qt::ShiftModifier);
  if (event.modifiers() != Qt::NoModifier && !rotates) return false;
  PoseGrab grab{.rotates = rotates};
  const Grabbed grabbed = grabbed_at(event.position(), !rotates);
  grab.handle = grabbed.handle;
  const std::optional<Hit>& hit = grabbed.link;
  if (!grab.handle && !hit) return false;
  if (hit) handles_.choose(hit->link);
  const view::Pose& pose = picture_.posed()[static_cast<std::size_t>(handles_.link())];
  grab.p_W_m = hit ? Eigen::Vector3d(pose.p_WL_m.cast<double>() + pose.q_WL.cast<double>() * hit->p_L_m)
                   : gizmo()->p_W_m;
  if (grab.handle && grab.handle->kind == Handle::Kind::kRing)
    grab.turn.emplace(*gizmo(), grab.handle->axis, picture_.camera(), width(), height(),
                      pixels(event.position()));
  grab_ = grab;
  drag_ = Drag::kPose;
  Q_EMIT pose_drag_began(handles_.link(), grab.p_W_m);
  return true;
}

void RobotView::continue_pose_drag(const QPointF& place) {
  const Eigen::Vector2d drag_px = pixels(place - drag_start_);
  const Eigen::Vector3d none = Eigen::Vector3d::Zero();
  if (grab_->rotates) {
    const Eigen::Vector3d rotation = rotation_W_rad(picture_.camera(), height(), drag_px);
    Q_EMIT pose_dragged(none, rotation);
  } else if (grab_->turn) {
    grab_->turn->move_to(picture_.camera(), width(), height(), pixels(place));
    Q_EMIT pose_dragged(none, grab_->turn->rotation_W_rad());
  } else if (grab_->handle) {
    const Gizmo arrows{grab_->p_W_m, kGizmoShare * picture_.camera().distance_m};
    Q_EMIT pose_dragged(
        along_axis_W_m(arrows, grab_->handle->axis, picture_.camera(), width(), height(), drag_px), none);
  } else {
    Q_EMIT pose_dragged(displacement_W_m(picture_.camera(), height(), grab_->p_W_m, drag_px), none);
  }
}

void RobotView::mousePressEvent(QMouseEvent* event) {
  drag_start_ = drag_last_ = event->position();
  const bool control = event->modifiers().testFlag(Qt::ControlModifier);
  if (begin_pose_drag(*event)) return;
  if (event->button() == Qt::LeftButton && control) {
    const auto hit = pushable_ ? picture_.link_near(at(event->position())) : std::nullopt;
    if (!hit) return;
    push_ = {*hit};
    drag_ = Drag::kPush;
  } else if (event->button() == Qt::RightButton) {
    drag_ = Drag::kOrbit;
  } else if (event->button() == Qt::MiddleButton || event->modifiers().testFlag(Qt::ShiftModifier)) {
    drag_ = Drag::kPan;
  } else if (event->button() == Qt::LeftButton) {
    drag_ = Drag::kOrbit;
  }
}

void RobotView::mouseMoveEvent(QMouseEvent* event) {
  const Eigen::Vector2d step = pixels(event->position() - drag_last_);
  drag_last_ = event->position();
  switch (drag_) {
    case Drag::kNone:
      return hover(event->position());
    case Drag::kPose:
      continue_pose_drag(event->position());
      break;
    case Drag::kOrbit:
      picture_.orbit(step, height());
      break;
    case Drag::kPan:
      picture_.pan(step, height());
      break;
    case Drag::kPush: {
      const Eigen::Vector3d drag_m =
          displacement_W_m(picture_.camera(), height(), picture_.point_W_m(push_->hit),
                           pixels(event->position() - drag_start_));
      push_->force_W_N = kPush_N_per_m * drag_m;
      if (push_->force_W_N.norm() > kMaxPush_N) push_->force_W_N *= kMaxPush_N / push_->force_W_N.norm();
      break;
    }
  }
  redraw_moving();
}

void RobotView::mouseReleaseEvent(QMouseEvent* event) {
  if (drag_ != Drag::kNone) pick(event->position());
  const Drag drag = std::exchange(drag_, Drag::kNone);
  if (drag == Drag::kPose) {
    grab_.reset();
    Q_EMIT pose_drag_ended();
    return update();
  }
  if (drag != Drag::kPush) return;
  const PushDrag push = *std::exchange(push_, std::nullopt);
  update();
  if (!push.force_W_N.isZero()) Q_EMIT push_requested(push.hit.link, push.hit.p_L_m, push.force_W_N);
}

void RobotView::mouseDoubleClickEvent(QMouseEvent* event) {
  if (const auto hit = link_at(event->position())) {
    change().look_at(picture_.point_W_m(*hit));
  } else {
    look_at_robot();
  }
}

void RobotView::wheelEvent(QWheelEvent* event) {
  constexpr double kPerNotch = 1.15;
  constexpr double kUnitsPerNotch = 120.0;  // QWheelEvent::angleDelta
  picture_.zoom(std::pow(kPerNotch, event->angleDelta().y() / kUnitsPerNotch));
  redraw_moving();
}

void RobotView::keyPressEvent(QKeyEvent* event) {
  constexpr double kTurn_px = 20.0;
  Eigen::Vector2d turn = Eigen::Vector2d::Zero();
  switch (event->key()) {
    case Qt::Key_Left:
      turn.x() = kTurn_px;
      break;
    case Qt::Key_Right:
      turn.x() = -kTurn_px;
      break;
    case Qt::Key_Up:
      turn.y() = kTurn_px;
      break;
    case Qt::Key_Down:
      turn.y() = -kTurn_px;
      break;
    default:
      return QWidget::keyPressEvent(event);
  }
  picture_.orbit(turn, height());
  redraw_moving();
}

}  // namespace koboshi::studio
