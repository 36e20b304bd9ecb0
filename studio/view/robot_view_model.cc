// The part of the view for the model editor.

#include <QApplication>
#include <utility>

#include "studio/view/robot_view.h"

namespace koboshi::studio {

void RobotView::set_shapes(view::Scene scene, const sim_board::RobotDescription& robot) {
  if (scene.links.size() != scene_.links.size()) return set_scene(std::move(scene), &robot);
  scene_ = std::move(scene);
  picker_ = Picker(scene_);
  layers_.set_robot(&robot);
  model_.set_robot(&robot);
  scene_changed_ = true;
  update();
}

void RobotView::set_chosen_link(int link) {
  model_.chosen_link = link;
  update();
}

void RobotView::set_inertias(bool inertias) {
  model_.inertias = inertias;
  update();
}

// Where a mouse button that began a drag is released: a click chooses the link.
void RobotView::pick(const QPointF& place) {
  if ((place - drag_start_).manhattanLength() >= QApplication::startDragDistance()) return;
  if (const auto hit = link_near(place)) Q_EMIT picked(hit->link);
}

}  // namespace koboshi::studio
