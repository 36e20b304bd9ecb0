#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <span>
#include <vector>

#include "sim_board/world/ground.h"

namespace koboshi::sim_board {

// Contacts of boxes with a height field. Replaces ODE's collider, which takes the first points found,
// wherever under the sole they are, and allocates memory in a step.
class HeightFieldContact {
 public:
  struct Point {
    Eigen::Vector3d p_W;
    Eigen::Vector3d n_W;  // unit normal, from the ground into the box
    double depth_m;       // distance along the normal to separation; negative: the gap
  };

  // The field must outlive this object. `largest_half_m` is half the size of the largest box.
  HeightFieldContact(const HeightField& field, const Eigen::Vector3d& largest_half_m);

  // Returns at most `most` points: corners of the box below the ground, each with the normal of its triangle,
  // and grid points inside the box, each with the normal of the face with the least penetration; also those
  // with a gap of less than `reach_m`, grid points below a face. Of more points, it selects the deepest and
  // then those farthest from the selected ones. Edge-edge contacts are omitted: on a grid finer than the box
  // there is a point nearby. Valid until the next call.
  std::span<const Point> touch(const Eigen::Isometry3d& X_WG, const Eigen::Vector3d& half_m, double reach_m,
                               std::size_t most);

 private:
  void add_corners(const Eigen::Isometry3d& X_FG, const Eigen::Vector3d& half_m, double reach_m);
  void add_grid_points(const Eigen::Isometry3d& X_FG, const Eigen::Vector3d& half_m, double reach_m);
  void add_grid_point(const Eigen::Vector3d& p_F, const Eigen::Isometry3d& X_FG,
                      const Eigen::Vector3d& half_m, double reach_m);
  // Moves the selected points to the front.
  void spread(std::size_t most);

  const HeightField& field_;
  Eigen::Isometry3d X_FW_;
  double highest_m_;
  std::vector<Point> points_;
};

}  // namespace koboshi::sim_board
