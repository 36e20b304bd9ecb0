#pragma once

#include <QMouseEvent>
#include <algorithm>
#include <optional>
#include <string>

#include "studio/motion_editor/motion_panel.h"
#include "tests/studio/window/window_fixture.h"
#include "view/render/camera.h"

namespace koboshi::studio {

// The studio's window with real events of the mouse in its view.
class ViewFixture : public QObject {
 protected:
  std::unique_ptr<MainWindow> window_;

  void show_window(const std::filesystem::path& robot = test::kRoot / "robots/koboshi/robot.sdf") {
    window_ = test::make_window(robot);
    QVERIFY(window_);
  }
  void open(const std::filesystem::path& file) { QVERIFY(test::open(*window_, file)); }
  // Opens a scenario of the repository with the stepper that takes the least time.
  void open_scenario(const char* name) {
    QSignalSpy opened(&window_->run(), &RunController::opened);
    const std::vector<Override> quick{{"physics.stepper", "lumped", "stepper"}};
    window_->run().open_scenario(test::kRoot / "scenarios" / name, quick);
    QVERIFY(opened.wait(test::kPatience_ms));
  }
  void run_to(std::uint64_t time_us) { QVERIFY(test::run_to(*window_, time_us)); }
  QAction* action(const char* text) { return test::action(*window_, text); }
  void save_picture(const char* name) { test::save_picture(*window_, name); }
  // The same of the view alone.
  void save_view(const char* name) {
    const QString pictures = qEnvironmentVariable("KOBOSHI_PICTURES");
    if (pictures.isEmpty()) return;
    QTest::qWait(500);
    window_->view().grab().save(pictures + u'/' + QLatin1String(name) + QStringLiteral(".png"));
  }
  // A place of the view at which there is the trunk: near its origin.
  std::optional<QPoint> trunk_place() {
    RobotView& view = window_->view();
    const auto& samples = window_->run().recording().samples;
    const auto& links = samples.empty() ? view.picture().posed() : samples.back().links;
    if (links.empty()) return std::nullopt;
    const Eigen::Vector3d trunk_m = links[0].p_WL_m.cast<double>();
    const Eigen::Vector2d place_px =
        view::project(view.picture().camera(), view.width(), view.height(), trunk_m);
    for (int dy = -60; dy <= 20; dy += 10)
      for (int dx = -20; dx <= 20; dx += 10) {
        const QPointF place(place_px.x() + dx, place_px.y() + dy);
        if (const auto hit = view.link_at(place); hit && hit->link == 0) return place.toPoint();
      }
    return std::nullopt;
  }
  // Drags in the view by real events of the mouse.
  void press_and_move(const QPoint& from, const QPoint& to,
                      Qt::KeyboardModifiers modifiers = Qt::NoModifier) {
    RobotView& view = window_->view();
    QTest::mousePress(&view, Qt::LeftButton, modifiers, from);
    constexpr int kMoves = 8;
    for (int i = 1; i <= kMoves; ++i) {
      const QPointF place = QPointF(from) + QPointF(to - from) * i / kMoves;
      QMouseEvent move(QEvent::MouseMove, place, view.mapToGlobal(place), Qt::NoButton, Qt::LeftButton,
                       modifiers);
      QApplication::sendEvent(&view, &move);
    }
  }
  void drag(const QPoint& from, const QPoint& by, Qt::KeyboardModifiers modifiers = Qt::NoModifier) {
    press_and_move(from, from + by, modifiers);
    QTest::mouseRelease(&window_->view(), Qt::LeftButton, modifiers, from + by);
  }
  // A place of the view at which this link of the edited robot is seen.
  std::optional<QPoint> place_of(const char* name) {
    RobotView& view = window_->view();
    const auto& links = view.picture().scene().links;
    const auto found = std::ranges::find(links, std::string(name), &view::Link::name);
    if (found == links.end() || view.picture().posed().empty()) return std::nullopt;
    const auto link = static_cast<std::size_t>(found - links.begin());
    const Eigen::Vector3d p_m = view.picture().posed()[link].p_WL_m.cast<double>();
    const Eigen::Vector2d place_px = view::project(view.picture().camera(), view.width(), view.height(), p_m);
    for (int reach = 0; reach <= 60; reach += 4)
      for (int dy = -reach; dy <= reach; dy += 4)
        for (int dx = -reach; dx <= reach; dx += 4) {
          const QPoint place = (QPointF(place_px.x() + dx, place_px.y() + dy)).toPoint();
          if (view.gizmo_handle_at(QPointF(place))) continue;  // a drag would grab that arrow or ring
          const auto hit = view.posable_at(QPointF(place));
          if (hit && hit->link == static_cast<int>(link)) return place;
        }
    return std::nullopt;
  }
  std::size_t link(const char* name) {
    const auto& links = window_->view().picture().scene().links;
    return static_cast<std::size_t>(std::ranges::find(links, std::string(name), &view::Link::name) -
                                    links.begin());
  }
  view::Pose pose_of(const char* name) { return window_->view().picture().posed().at(link(name)); }
  void hover(const QPoint& place) {
    RobotView& view = window_->view();
    QMouseEvent move(QEvent::MouseMove, QPointF(place), view.mapToGlobal(QPointF(place)), Qt::NoButton,
                     Qt::NoButton, Qt::NoModifier);
    QApplication::sendEvent(&view, &move);
  }
  std::size_t joint(const char* name) {
    const auto& names = window_->motion().editor().document().robot().model.joint_names;
    return static_cast<std::size_t>(std::ranges::find(names, name) - names.begin());
  }
};

}  // namespace koboshi::studio
