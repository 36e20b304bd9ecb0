#include "studio/tuning/compared_robots.h"

#include <QColor>
#include <QEvent>
#include <QLabel>
#include <QVBoxLayout>
#include <vector>

#include "studio/view/robot_view.h"
#include "view/render/camera.h"
#include "view/render/playback.h"

namespace koboshi::studio {
namespace {

constexpr double kApart_m = 0.45;       // the robots are 0.25 m wide
constexpr double kNameHeight_m = 0.17;  // above the trunk's origin
// The first two colours of plots (plot_style.h).
constexpr std::array<view::Colour, Comparison::kRuns> kRunColours{
    {{0.0F, 0.447F, 0.698F}, {0.835F, 0.369F, 0.0F}}};

}  // namespace

QColor colour_of_run(std::size_t run) {
  return QColor::fromRgbF(kRunColours[run].red, kRunColours[run].green, kRunColours[run].blue);
}

ComparedRobots::ComparedRobots(QWidget* parent) : QWidget(parent), view_(new RobotView(this)) {
  auto* layout = new QVBoxLayout(this);
  layout->setContentsMargins(0, 0, 0, 0);
  layout->addWidget(view_);
  view_->setMinimumSize(200, 120);
  view_->installEventFilter(this);
  for (std::size_t run = 0; run < names_.size(); ++run) {
    names_[run] = new QLabel(view_);
    names_[run]->setAttribute(Qt::WA_TransparentForMouseEvents);
    names_[run]->setStyleSheet(
        QStringLiteral("background: %1; color: white; padding: 1px 5px; border-radius: 4px;")
            .arg(colour_of_run(run).name()));
    names_[run]->hide();
  }
}

void ComparedRobots::set_scenes(const Comparison& comparison,
                                const std::array<QString, Comparison::kRuns>& names) {
  view_->set_scene(scene_of_both(comparison.recording(0).scene, comparison.recording(1).scene, kRunColours));
  for (std::size_t run = 0; run < names_.size(); ++run) names_[run]->setText(names[run]);
}

void ComparedRobots::show_time(const Comparison& comparison, std::uint64_t time_us) {
  view_->show_robot(poses_of_both(view::poses_at(comparison.recording(0), time_us),
                                  view::poses_at(comparison.recording(1), time_us), kApart_m),
                    {});
  place_names();
}

void ComparedRobots::place_names() {
  const std::vector<view::Pose>& links = view_->picture().posed();
  for (std::size_t run = 0; run < names_.size(); ++run) {
    const std::size_t trunk = run * (links.size() / names_.size());
    if (trunk >= links.size()) return;
    const Eigen::Vector3d above_m =
        links[trunk].p_WL_m.cast<double>() + Eigen::Vector3d(0.0, 0.0, kNameHeight_m);
    const Eigen::Vector2d place_px =
        view::project(view_->picture().camera(), view_->width(), view_->height(), above_m);
    QLabel& name = *names_[run];
    name.adjustSize();
    name.move(static_cast<int>(place_px.x()) - name.width() / 2,
              static_cast<int>(place_px.y()) - name.height());
    name.show();
  }
}

// The names follow the camera, which the view turns after this.
bool ComparedRobots::eventFilter(QObject* watched, QEvent* event) {
  const QEvent::Type type = event->type();
  if (type == QEvent::Resize || type == QEvent::MouseMove || type == QEvent::Wheel)
    QMetaObject::invokeMethod(this, &ComparedRobots::place_names, Qt::QueuedConnection);
  return QWidget::eventFilter(watched, event);
}

}  // namespace koboshi::studio
