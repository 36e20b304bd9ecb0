#include "studio/view/link_layers.h"

namespace koboshi::studio {

void LinkLayers::set_robot(const sim_board::RobotDescription* robot) {
  axes_.clear();
  overlaps_.reset();
  if (robot == nullptr) return;
  axes_ = joint_axes(*robot);
  overlaps_.emplace(*robot);
}

void LinkLayers::add(view::Marks& marks, const view::Scene& scene, std::span<const view::Pose> links) const {
  if (overlaps && overlaps_) add_outlines(marks, scene, links, overlaps_->links_in_overlap(links));
  if (frames) add_link_frames(marks, links);
  if (axes) add_joint_axes(marks, links, axes_);
}

std::vector<MarkName> LinkLayers::at(std::span<const view::Pose> links, const view::Camera& camera,
                                     int width_px, int height_px, const Eigen::Vector2d& pixel) const {
  return marks_near(frames ? links : std::span<const view::Pose>(), links,
                    axes ? std::span<const JointAxis>(axes_) : std::span<const JointAxis>(), camera, width_px,
                    height_px, pixel);
}

}  // namespace koboshi::studio
