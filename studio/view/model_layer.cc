#include "studio/view/model_layer.h"

namespace koboshi::studio {

void ModelLayer::set_robot(const sim_board::RobotDescription* robot) {
  ellipsoids_ = robot == nullptr ? std::vector<InertiaEllipsoid>() : inertia_ellipsoids(*robot);
  axes_ = robot == nullptr ? std::vector<JointAxis>() : joint_axes(*robot);
}

void ModelLayer::add(view::Marks& marks, std::span<const view::Pose> links) const {
  if (links.size() != ellipsoids_.size()) return;
  if (inertias) add_inertia_ellipsoids(marks, links, ellipsoids_);
  if (chosen_link < 0 || static_cast<std::size_t>(chosen_link) >= links.size()) return;
  add_link_frames(marks, links.subspan(static_cast<std::size_t>(chosen_link), 1));
  for (const JointAxis& axis : axes_)
    if (axis.link == chosen_link) add_joint_axes(marks, links, std::span(&axis, 1));
}

}  // namespace koboshi::studio
