#pragma once

#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "sim_board/description/description.h"
#include "view/recording/recording.h"

namespace koboshi::studio {

// A robot with given joint angles, standing on its soles without physics.
class PoseGhost {
 public:
  explicit PoseGhost(std::shared_ptr<const sim_board::RobotDescription> robot) : robot_(std::move(robot)) {}

  const sim_board::RobotDescription& robot() const { return *robot_; }
  // The robot on level ground.
  view::Scene scene() const;
  // The poses of all links; joint angles by the robot's order of joints. The trunk is above the origin of the
  // world, or where this trunk is, with its heading.
  std::vector<view::Pose> stand(std::span<const double> angles_rad, const view::Pose* trunk = nullptr) const;
  // The poses of all links with this link at this place.
  std::vector<view::Pose> hold(std::span<const double> angles_rad, int link, const view::Pose& at) const;
  // The joint angles of a robot with these poses of its links, within their limits; by joint.
  std::vector<double> angles_of(std::span<const view::Pose> links) const;

 private:
  std::shared_ptr<const sim_board::RobotDescription> robot_;
};

}  // namespace koboshi::studio
