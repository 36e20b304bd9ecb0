#include "tools/studio/window/pose_ghost.h"

#include <Eigen/Geometry>
#include <cmath>

#include "sim_board/robot/load.h"
#include "sim_board/world/ground.h"
#include "tools/motion/view/placement.h"
#include "tools/view/capture/scene.h"

namespace koboshi::studio {

PoseGhost::PoseGhost(const std::filesystem::path& robot_file)
    : robot_(std::make_shared<const sim::RobotDescription>(sim::load_robot(robot_file))) {}

view::Scene PoseGhost::scene() const { return view::make_scene(*robot_, sim::GroundDescription()); }

std::vector<view::Pose> PoseGhost::stand(std::span<const double> angles_rad, const view::Pose* trunk) const {
  tools::Placement placement(*robot_);
  placement.place(angles_rad);
  std::vector<view::Pose> links = placement.links();
  if (trunk == nullptr) return links;
  const Eigen::Vector3f x_W = trunk->q_WL * Eigen::Vector3f::UnitX();
  const Eigen::Quaternionf turn(Eigen::AngleAxisf(std::atan2(x_W.y(), x_W.x()), Eigen::Vector3f::UnitZ()));
  const Eigen::Vector3f shift_m(trunk->p_WL_m.x(), trunk->p_WL_m.y(), 0.0F);
  for (view::Pose& link : links) link = {turn * link.p_WL_m + shift_m, turn * link.q_WL};
  return links;
}

}  // namespace koboshi::studio
