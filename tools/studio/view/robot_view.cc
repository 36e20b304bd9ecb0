#include "tools/studio/view/robot_view.h"

#include <Eigen/Geometry>
#include <QElapsedTimer>
#include <QKeyEvent>
#include <QMouseEvent>
#include <QOpenGLContext>
#include <QSurfaceFormat>
#include <QWheelEvent>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "tools/view/render/overlay.h"
#include "tools/view/render/playback.h"

namespace koboshi::studio {
namespace {

// Share of the distance between two links by which they are shown apart.
constexpr double kExplosion = 0.8;
constexpr int kRest_ms = 150;
constexpr double kFrame_s =
    1.0 / 40.0;  // of the picture alone, so that a window of several panels keeps its 25 frames/s
constexpr double kRadPerDegree = std::numbers::pi / 180.0;
constexpr double kArrowRadius_m = 0.004;

Eigen::Vector2d pixels(const QPointF& point) { return {point.x(), point.y()}; }

}  // namespace

QSurfaceFormat RobotView::format() {
  QSurfaceFormat format;
  format.setVersion(3, 3);
  format.setProfile(QSurfaceFormat::CoreProfile);
  format.setDepthBufferSize(24);
  return format;
}

RobotView::RobotView(QWidget* parent) : QOpenGLWidget(parent), resolution_(kFrame_s) {
  setFocusPolicy(Qt::StrongFocus);
  setMouseTracking(true);
  setMinimumSize(200, 150);
  setAccessibleName(tr("View of the robot"));
  setToolTip(tr(
      "Drag: turn. Shift+drag: move. Wheel: distance. Double click: look there. Ctrl+drag a link: push it.\n"
      "Edit a motion: drag hand, foot or trunk; Ctrl+Shift+drag: rotate it; right button: turn the view."));
  rest_.setSingleShot(true);
  rest_.setInterval(kRest_ms);
  connect(&rest_, &QTimer::timeout, this, [this] {
    moving_ = false;
    update();
  });
  picture_.camera.azimuth_rad = 50.0 * kRadPerDegree;
  picture_.camera.elevation_rad = 14.0 * kRadPerDegree;
}

RobotView::~RobotView() { release_gl(); }

void RobotView::release_gl() {
  if (!renderer_ && !framebuffer_) return;
  makeCurrent();
  renderer_.reset();
  framebuffer_.reset();
  doneCurrent();
}

void RobotView::set_scene(view::Scene scene, const sim::RobotDescription* robot) {
  scene_ = std::move(scene);
  picker_ = Picker(scene_);
  picture_.links.clear();
  picture_.ghost.clear();
  links_.clear();
  axes_ = robot == nullptr ? std::vector<JointAxis>() : joint_axes(*robot);
  overlaps_.reset();
  if (robot != nullptr) overlaps_.emplace(*robot);
  ghost_links_.clear();
  picture_.marks = {};
  scene_changed_ = true;
  framed_ = false;
  followed_W_m_.reset();
  push_.reset();
  gizmo_link_ = -1;
  update();
}

void RobotView::set_posable(std::vector<Posable> links) {
  if (links == posable_) return;
  posable_ = std::move(links);
  gizmo_link_ = -1;
  update();
}

void RobotView::set_limit_marks(view::Marks marks) {
  limit_marks_ = std::move(marks);
  update();
}

void RobotView::set_link_frames(bool frames) {
  link_frames_ = frames;
  update();
}

void RobotView::set_joint_axes(bool axes) {
  joint_axes_ = axes;
  update();
}

void RobotView::set_exploded(bool exploded) {
  exploded_ = exploded;
  picture_.links = apart(links_);
  picture_.ghost = apart(ghost_links_);
  update();
}

std::vector<view::Pose> RobotView::apart(const std::vector<view::Pose>& links) const {
  return exploded_ && links.size() == scene_.links.size() ? exploded(scene_, links, kExplosion) : links;
}

void RobotView::show_robot(std::vector<view::Pose> links, view::Marks marks) {
  links_ = std::move(links);
  picture_.links = apart(links_);
  picture_.marks = std::move(marks);
  if (!framed_) look_at_robot();
  follow_robot();
  redraw_moving();
}

void RobotView::show_ghost(std::vector<view::Pose> links) {
  ghost_links_ = std::move(links);
  picture_.ghost = apart(ghost_links_);
  redraw_moving();
}

void RobotView::set_collisions(bool collisions) {
  picture_.collisions = collisions;
  update();
}

void RobotView::set_follow(bool follow) {
  follow_ = follow;
  followed_W_m_.reset();
}

void RobotView::look_from(double azimuth_rad, double elevation_rad) {
  picture_.camera.azimuth_rad = azimuth_rad;
  picture_.camera.elevation_rad = elevation_rad;
  redraw_moving();
}

void RobotView::look_at_robot() {
  if (picture_.links.empty()) return;
  Eigen::AlignedBox3d box;
  for (const view::Pose& pose : picture_.links) box.extend(pose.p_WL_m.cast<double>());
  constexpr double kAroundOrigins_m = 0.06;  // limbs reach beyond the origins of their links
  picture_.camera.target_W_m = box.center();
  picture_.camera.distance_m =
      view::distance_to_fit(picture_.camera, std::max(1.0, double(width()) / std::max(height(), 1)),
                            0.5 * box.diagonal().norm() + kAroundOrigins_m);
  framed_ = true;
  followed_W_m_.reset();
  update();
}

Eigen::Vector3d RobotView::robot_W_m() const { return picture_.links.front().p_WL_m.cast<double>(); }

// Moves the camera along the ground as the trunk does.
void RobotView::follow_robot() {
  if (!follow_ || picture_.links.empty()) return;
  const Eigen::Vector3d now_m = robot_W_m();
  if (followed_W_m_) picture_.camera.target_W_m.head<2>() += (now_m - *followed_W_m_).head<2>();
  followed_W_m_ = now_m;
}

void RobotView::redraw_moving() {
  moving_ = true;
  rest_.start();
  update();
}

void RobotView::initializeGL() {
  // The context is made anew when the widget moves to another window.
  connect(context(), &QOpenGLContext::aboutToBeDestroyed, this, &RobotView::release_gl);
  scene_changed_ = true;
}

void RobotView::paintGL() {
  if (!error_.isEmpty() || picture_.links.size() != scene_.links.size() || scene_.links.empty()) {
    const QColor background = palette().color(QPalette::Mid);
    glClearColor(background.redF(), background.greenF(), background.blueF(), 1.0F);
    glClear(GL_COLOR_BUFFER_BIT);
    return;
  }
  const double ratio = devicePixelRatioF();
  const int width_px = std::max(1, static_cast<int>(std::lround(width() * ratio)));
  const int height_px = std::max(1, static_cast<int>(std::lround(height() * ratio)));
  try {
    if (scene_changed_) {
      renderer_ = std::make_unique<view::Renderer>(scene_);
      scene_changed_ = false;
    }
    if (!framebuffer_) framebuffer_ = std::make_unique<ScaledFramebuffer>();
    QElapsedTimer timer;
    timer.start();
    const double scale = moving_ ? resolution_.scale() : 1.0;
    const int scaled_width_px = std::max(1, static_cast<int>(std::lround(width_px * scale)));
    const int scaled_height_px = std::max(1, static_cast<int>(std::lround(height_px * scale)));
    framebuffer_->bind(scaled_width_px, scaled_height_px);
    view::Marks marks = marks_with_push();
    std::swap(picture_.marks, marks);
    renderer_->draw(picture_, scaled_width_px, scaled_height_px);
    std::swap(picture_.marks, marks);
    framebuffer_->stretch_into(defaultFramebufferObject(), width_px, height_px);
    glFinish();  // otherwise the time is not that of the picture
    if (moving_) resolution_.drawn_in(1e-9 * static_cast<double>(timer.nsecsElapsed()));
    ++frames_;
  } catch (const std::runtime_error& error) {
    error_ = QString::fromUtf8(error.what());
    Q_EMIT failed(error_);
  }
}

view::Marks RobotView::marks_with_push() const {
  view::Marks marks = picture_.marks;
  marks.flat.insert(marks.flat.end(), limit_marks_.flat.begin(), limit_marks_.flat.end());
  marks.solid.insert(marks.solid.end(), limit_marks_.solid.begin(), limit_marks_.solid.end());
  if (picture_.collisions && overlaps_ && !exploded_)
    add_outlines(marks, scene_, picture_.links, overlaps_->links_in_overlap(picture_.links));
  if (link_frames_) add_link_frames(marks, picture_.links);
  if (joint_axes_) add_joint_axes(marks, picture_.links, axes_);
  if (const auto arrows = gizmo())
    add_gizmo(marks, *arrows, grab_ && !grab_->rotates ? grab_->axis : gizmo_axis_);
  if (push_) {
    const Eigen::Vector3d tip_m = point_W_m(push_->hit);
    view::add_arrow(marks, tip_m, tip_m + view::kForceScale_m_per_N * push_->force_W_N, kArrowRadius_m,
                    view::kPushColour);
  }
  return marks;
}

Eigen::Vector3d RobotView::point_W_m(const Hit& hit) const {
  const view::Pose& pose = picture_.links[static_cast<std::size_t>(hit.link)];
  return pose.q_WL.cast<double>() * hit.p_L_m + pose.p_WL_m.cast<double>();
}

std::optional<Hit> RobotView::link_at(const QPointF& place) const {
  return picker_.pick(picture_.links, ray_through(picture_.camera, width(), height(), pixels(place)));
}

std::optional<Hit> RobotView::posable_at(const QPointF& place) const {
  if (posable_.empty()) return std::nullopt;
  const auto hit = picker_.pick(posed(), ray_through(picture_.camera, width(), height(), pixels(place)));
  return hit && std::ranges::find(posable_, hit->link, &Posable::link) != posable_.end() ? hit : std::nullopt;
}

std::optional<Gizmo> RobotView::gizmo() const {
  const auto found = std::ranges::find(posable_, gizmo_link_, &Posable::link);
  const auto link = static_cast<std::size_t>(gizmo_link_);
  if (found == posable_.end() || link >= posed().size()) return std::nullopt;
  const Eigen::Vector3d p_W_m =
      posed()[link].p_WL_m.cast<double>() + posed()[link].q_WL.cast<double>() * found->p_L_m;
  return Gizmo{p_W_m, kGizmoShare * picture_.camera.distance_m};
}

std::optional<int> RobotView::gizmo_axis_at(const QPointF& place) const {
  const auto arrows = gizmo();
  return arrows ? pick_axis(*arrows, picture_.camera, width(), height(), pixels(place)) : std::nullopt;
}

void RobotView::hover(const QPointF& place) {
  const auto hit = link_at(place);
  const int link = hit ? hit->link : -1;
  if (std::exchange(hovered_, link) != link) Q_EMIT hovered(link);
  const auto axis = gizmo_axis_at(place);
  if (std::exchange(gizmo_axis_, axis) != axis) update();
  if (axis) return;
  const auto posable = posable_at(place);
  if (posable && std::exchange(gizmo_link_, posable->link) != posable->link) update();
}

bool RobotView::begin_pose_drag(const QMouseEvent& event) {
  if (event.button() != Qt::LeftButton) return false;
  const bool rotates = event.modifiers() == (Qt::ControlModifier | Qt::ShiftModifier);
  if (event.modifiers() != Qt::NoModifier && !rotates) return false;
  PoseGrab grab{.rotates = rotates};
  if (!rotates) grab.axis = gizmo_axis_at(event.position());
  const auto hit = grab.axis ? std::nullopt : posable_at(event.position());
  if (!grab.axis && !hit) return false;
  if (hit) gizmo_link_ = hit->link;
  const view::Pose& pose = posed()[static_cast<std::size_t>(gizmo_link_)];
  grab.p_W_m = hit ? Eigen::Vector3d(pose.p_WL_m.cast<double>() + pose.q_WL.cast<double>() * hit->p_L_m)
                   : gizmo()->p_W_m;
  grab_ = grab;
  drag_ = Drag::kPose;
  Q_EMIT pose_drag_began(gizmo_link_, grab.p_W_m);
  return true;
}

void RobotView::continue_pose_drag(const QPointF& place) {
  const Eigen::Vector2d drag_px = pixels(place - drag_start_);
  const Eigen::Vector3d none = Eigen::Vector3d::Zero();
  if (grab_->rotates) {
    const Eigen::Vector3d rotation = rotation_W_rad(picture_.camera, height(), drag_px);
    Q_EMIT pose_dragged(none, rotation);
  } else if (grab_->axis) {
    const Gizmo arrows{grab_->p_W_m, kGizmoShare * picture_.camera.distance_m};
    Q_EMIT pose_dragged(along_axis_W_m(arrows, *grab_->axis, picture_.camera, width(), height(), drag_px),
                        none);
  } else {
    Q_EMIT pose_dragged(displacement_W_m(picture_.camera, height(), grab_->p_W_m, drag_px), none);
  }
}

void RobotView::mousePressEvent(QMouseEvent* event) {
  drag_start_ = drag_last_ = event->position();
  const bool control = event->modifiers().testFlag(Qt::ControlModifier);
  if (begin_pose_drag(*event)) return;
  if (event->button() == Qt::LeftButton && control) {
    const auto hit = pushable_ ? link_at(event->position()) : std::nullopt;
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
      orbit(picture_.camera, step, height());
      break;
    case Drag::kPan:
      pan(picture_.camera, step, height());
      break;
    case Drag::kPush: {
      const Eigen::Vector3d drag_m = displacement_W_m(picture_.camera, height(), point_W_m(push_->hit),
                                                      pixels(event->position() - drag_start_));
      push_->force_W_N = kPush_N_per_m * drag_m;
      if (push_->force_W_N.norm() > kMaxPush_N) push_->force_W_N *= kMaxPush_N / push_->force_W_N.norm();
      break;
    }
  }
  redraw_moving();
}

void RobotView::mouseReleaseEvent(QMouseEvent* /*event*/) {
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
    picture_.camera.target_W_m = point_W_m(*hit);
    update();
  } else {
    look_at_robot();
  }
}

void RobotView::wheelEvent(QWheelEvent* event) {
  constexpr double kPerNotch = 1.15;
  constexpr double kUnitsPerNotch = 120.0;  // QWheelEvent::angleDelta
  zoom(picture_.camera, std::pow(kPerNotch, event->angleDelta().y() / kUnitsPerNotch));
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
      return QOpenGLWidget::keyPressEvent(event);
  }
  orbit(picture_.camera, turn, height());
  redraw_moving();
}

}  // namespace koboshi::studio
