#include "studio/view/robot_view.h"

#include <Eigen/Geometry>
#include <QElapsedTimer>
#include <QPainter>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "view/render/overlay.h"
#include "view/render/playback.h"

namespace koboshi::studio {
namespace {

// Share of the distance between two links by which they are shown apart.
constexpr double kExplosion = 0.8;
constexpr int kRest_ms = 150;
constexpr double kFrame_s =
    1.0 / 40.0;  // of the picture alone, so that a window of several panels keeps its 25 frames/s
constexpr double kRadPerDegree = std::numbers::pi / 180.0;
constexpr double kArrowRadius_m = 0.004;

}  // namespace

RobotView::RobotView(QWidget* parent) : QWidget(parent), resolution_(kFrame_s) {
  setFocusPolicy(Qt::StrongFocus);
  setMouseTracking(true);
  setMinimumSize(200, 150);
  setAccessibleName(tr("View of the robot"));
  setToolTip(tr(
      "Drag: turn. Shift+drag: move. Wheel: distance. Double click: look there. Ctrl+drag a link: push it.\n"
      "Edit a motion: drag hand, foot or trunk, or an arrow or ring at it: along or about the world's axis x "
      "(red), y (green) or z (blue).\nCtrl+Shift+drag: rotate foot or trunk freely. Right button: turn the "
      "view."));
  rest_.setSingleShot(true);
  rest_.setInterval(kRest_ms);
  connect(&rest_, &QTimer::timeout, this, [this] {
    moving_ = false;
    update();
  });
  picture_.camera.azimuth_rad = 50.0 * kRadPerDegree;
  picture_.camera.elevation_rad = 14.0 * kRadPerDegree;
}

// Objects of OpenGL must be destroyed while its context is current.
RobotView::~RobotView() {
  try {
    if (gl_) gl_->make_current();
  } catch (const std::runtime_error&) {
    return;  // the display has gone, and everything with it
  }
}

void RobotView::set_scene(view::Scene scene, const sim_board::RobotDescription* robot) {
  scene_ = std::move(scene);
  picker_ = Picker(scene_);
  picture_.links.clear();
  links_.clear();
  layers_.set_robot(robot);
  model_.set_robot(robot);
  ghost_links_.clear();
  onion_.clear();
  tints_.clear();
  update_ghosts();
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

void RobotView::show_limits(view::Marks marks, std::vector<view::Tint> tints) {
  limit_marks_ = std::move(marks);
  tints_ = std::move(tints);
  update_ghosts();
  update();
}

void RobotView::set_link_frames(bool frames) {
  layers_.frames = frames;
  update();
}

void RobotView::set_joint_axes(bool axes) {
  layers_.axes = axes;
  update();
}

void RobotView::set_exploded(bool exploded) {
  exploded_ = exploded;
  picture_.links = apart(links_);
  update_ghosts();
  update_overlaps();
  update();
}

// Links that are shown apart penetrate nothing.
void RobotView::update_overlaps() { layers_.overlaps = picture_.collisions && !exploded_; }

void RobotView::update_ghosts() {
  ghost_ = apart(ghost_links_);
  picture_.ghosts.clear();
  picture_.tints = ghost_.empty() ? tints_ : std::vector<view::Tint>();
  if (!ghost_.empty()) picture_.ghosts.push_back({.links = ghost_, .tints = tints_});
  for (const view::Ghost& pose : onion_) {
    if (pose.links.size() != scene_.links.size()) continue;
    picture_.ghosts.push_back(pose);
    picture_.ghosts.back().links = apart(pose.links);
  }
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
  update_ghosts();
  redraw_moving();
}

void RobotView::show_onion(std::vector<view::Ghost> poses) {
  if (poses.empty() && onion_.empty()) return;
  onion_ = std::move(poses);
  update_ghosts();
  redraw_moving();
}

void RobotView::set_collisions(bool collisions) {
  picture_.collisions = collisions;
  update_overlaps();
  update();
}

void RobotView::set_follow(bool follow) {
  follow_ = follow;
  followed_W_m_.reset();
}

void RobotView::look_from(double azimuth_rad, double elevation_rad) {
  picture_.camera.azimuth_rad = azimuth_rad;
  picture_.camera.elevation_rad = elevation_rad;
  raise_above(picture_.camera, scene_.planes);
  redraw_moving();
}

void RobotView::look_at_robot() {
  if (picture_.links.empty()) return;
  Eigen::AlignedBox3d box;
  for (const view::Pose& pose : picture_.links) box.extend(pose.p_WL_m.cast<double>());
  constexpr double kAroundOrigins_m = 0.06;            // limbs reach beyond the origins of their links
  constexpr double kLowest_rad = 6.0 * kRadPerDegree;  // that of the view from the front
  picture_.camera.target_W_m = box.center();
  picture_.camera.elevation_rad = std::max(picture_.camera.elevation_rad, kLowest_rad);
  picture_.camera.distance_m =
      view::distance_to_fit(picture_.camera, std::max(1.0, double(width()) / std::max(height(), 1)),
                            0.5 * box.diagonal().norm() + kAroundOrigins_m);
  raise_above(picture_.camera, scene_.planes);
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
  lift_above(picture_.camera, scene_.planes);
}

void RobotView::redraw_moving() {
  moving_ = true;
  rest_.start();
  update();
}

void RobotView::paintEvent(QPaintEvent* /*event*/) {
  QPainter painter(this);
  const bool has_picture =
      error_.isEmpty() && !scene_.links.empty() && picture_.links.size() == scene_.links.size();
  if (has_picture) draw();
  if (!has_picture || !error_.isEmpty()) return painter.fillRect(rect(), palette().color(QPalette::Mid));
  painter.setRenderHint(QPainter::SmoothPixmapTransform);
  painter.drawImage(rect(), image_);
}

// Draws the picture into image_, or sets the error.
void RobotView::draw() {
  try {
    if (!gl_) gl_ = std::make_unique<GlContext>();
    gl_->make_current();
    if (scene_changed_) {
      renderer_ = std::make_unique<view::Renderer>(scene_);
      scene_changed_ = false;
    }
    if (!framebuffer_) framebuffer_ = std::make_unique<ScaledFramebuffer>();
    QElapsedTimer timer;
    timer.start();
    const double scale = devicePixelRatioF() * (moving_ ? resolution_.scale() : 1.0);
    const int width_px = std::max(1, static_cast<int>(std::lround(width() * scale)));
    const int height_px = std::max(1, static_cast<int>(std::lround(height() * scale)));
    framebuffer_->bind(width_px, height_px);
    view::Marks marks = all_marks();
    std::swap(picture_.marks, marks);
    renderer_->draw(picture_, width_px, height_px);
    std::swap(picture_.marks, marks);
    QImage drawn(width_px, height_px, QImage::Format_RGB32);
    framebuffer_->read({drawn.bits(), static_cast<std::size_t>(drawn.sizeInBytes())});
    image_ = drawn.mirrored();
    if (moving_) resolution_.drawn_in(1e-9 * static_cast<double>(timer.nsecsElapsed()));
    ++frames_;
  } catch (const std::runtime_error& error) {
    error_ = QString::fromUtf8(error.what());
    Q_EMIT failed(error_);
  }
}

view::Marks RobotView::all_marks() const {
  view::Marks marks = picture_.marks;
  marks.flat.insert(marks.flat.end(), limit_marks_.flat.begin(), limit_marks_.flat.end());
  marks.solid.insert(marks.solid.end(), limit_marks_.solid.begin(), limit_marks_.solid.end());
  layers_.add(marks, scene_, picture_.links);
  model_.add(marks, picture_.links);
  add_handles(marks);
  if (push_) {
    const Eigen::Vector3d tip_m = point_W_m(push_->hit);
    view::add_arrow(marks, tip_m, tip_m + view::kForceScale_m_per_N * push_->force_W_N, kArrowRadius_m,
                    view::kPushColour);
  }
  return marks;
}

}  // namespace koboshi::studio
