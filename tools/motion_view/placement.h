#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <span>
#include <vector>

#include "sim_board/description/description.h"
#include "tools/motion_check/body.h"
#include "view/recording/recording.h"

namespace koboshi::tools {

// Places a robot without physics: at rest on its soles, with the support foot where it was in the pose
// before. The first pose has the trunk above the world's origin, heading along the x axis.
class Placement {
 public:
  // The robot must outlive this.
  explicit Placement(const sim_board::RobotDescription& robot) : body_(robot) {}

  // Returns X_WB, the pose of the trunk, with these joint angles.
  Eigen::Isometry3d place(std::span<const double> angles_rad);
  // The poses of all links at the last place.
  std::vector<view::Pose> links() const;
  // A point of GroundAxes on the ground of the world.
  Eigen::Vector2d on_ground(const Eigen::Vector2d& p_m) const;

  const Body& body() const { return body_; }
  const Stance& stance() const { return stance_; }

 private:
  Eigen::Isometry3d foot(const Eigen::Isometry3d& X_GB, std::size_t side) const;

  Body body_;
  Stance stance_;
  bool has_anchor_ = false;
  std::size_t side_ = 0;
  Eigen::Isometry3d X_WF_ = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d X_WG_ = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d X_WB_ = Eigen::Isometry3d::Identity();
};

}  // namespace koboshi::tools
