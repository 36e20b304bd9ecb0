#include "studio/view/robot_view.h"

#include <QElapsedTimer>
#include <QPainter>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "view/render/overlay.h"

// Draws the view. robot_view_input.cc handles mouse and keyboard in it.
namespace koboshi::studio {
namespace {

constexpr int kRest_ms = 150;
constexpr double kFrame_s =
    1.0 / 40.0;  // of the picture alone, so that a window of several panels keeps its 25 frames/s
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
}

RobotPicture& RobotView::change() {
  update();
  return picture_;
}

void RobotView::set_scene(view::Scene scene, const sim_board::RobotDescription* robot) {
  change().set_scene(std::move(scene), robot);
  push_.reset();
  handles_.hide();
}

void RobotView::set_posable(std::vector<Posable> links) {
  if (handles_.set_links(std::move(links))) update();
}

void RobotView::show_robot(std::vector<view::Pose> links, view::Marks marks) {
  picture_.show_robot(std::move(links), std::move(marks), aspect());
  redraw_moving();
}

void RobotView::show_ghost(std::vector<view::Pose> links) {
  picture_.show_ghost(std::move(links));
  redraw_moving();
}

void RobotView::show_onion(std::vector<view::Ghost> poses) {
  if (poses.empty() && !picture_.has_onion()) return;
  picture_.show_onion(std::move(poses));
  redraw_moving();
}

void RobotView::look_from(double azimuth_rad, double elevation_rad) {
  picture_.look_from(azimuth_rad, elevation_rad);
  redraw_moving();
}

void RobotView::look_at_robot() { change().look_at_robot(aspect()); }

double RobotView::aspect() const { return double(width()) / std::max(height(), 1); }

void RobotView::redraw_moving() {
  moving_ = true;
  rest_.start();
  update();
}

void RobotView::paintEvent(QPaintEvent* /*event*/) {
  QPainter painter(this);
  const bool has_picture = error_.isEmpty() && picture_.can_be_drawn();
  if (has_picture) draw();
  if (!has_picture || !error_.isEmpty()) return painter.fillRect(rect(), palette().color(QPalette::Mid));
  painter.setRenderHint(QPainter::SmoothPixmapTransform);
  painter.drawImage(rect(), image_);
}

// Draws the picture into image_, or sets the error.
void RobotView::draw() {
  try {
    QElapsedTimer timer;
    timer.start();
    const double scale = devicePixelRatioF() * (moving_ ? resolution_.scale() : 1.0);
    const auto pixels = [&](int length) {
      return std::max(1, static_cast<int>(std::lround(length * scale)));
    };
    image_ = surface_.draw(picture_, all_marks(), {pixels(width()), pixels(height())});
    if (moving_) resolution_.drawn_in(1e-9 * static_cast<double>(timer.nsecsElapsed()));
    ++frames_;
  } catch (const std::runtime_error& error) {
    error_ = QString::fromUtf8(error.what());
    Q_EMIT failed(error_);
  }
}

// During a drag, the rings make room for what is dragged.
view::Marks RobotView::all_marks() const {
  view::Marks marks = picture_.marks();
  if (grab_ && grab_->turn) {
    grab_->turn->add(marks, picture_.camera());
  } else if (auto handles = gizmo()) {
    if (grab_) handles->rotates = false;
    add_gizmo(marks, *handles, picture_.camera(), grab_ ? grab_->handle : handles_.hovered());
  }
  if (push_) {
    const Eigen::Vector3d tip_m = picture_.point_W_m(push_->hit);
    view::add_arrow(marks, tip_m, tip_m + view::kForceScale_m_per_N * push_->force_W_N, kArrowRadius_m,
                    view::kPushColour);
  }
  return marks;
}

}  // namespace koboshi::studio
