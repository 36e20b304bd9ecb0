#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <span>
#include <vector>

#include "sim_board/world/ground.h"

namespace koboshi::sim {

// Where boxes touch a height field. ODE's own collider is not used: it takes the first points that it finds,
// wherever below the sole they lie, and asks for memory while the world steps.
class HeightFieldContact {
 public:
  struct Point {
    Eigen::Vector3d p_W;
    Eigen::Vector3d n_W;  // unit normal, out of the ground and into the box
    double depth_m;       // how far the box has to go along it
  };

  // The field must outlive it. No box is larger than the one given by half its size.
  HeightFieldContact(const HeightField& field, const Eigen::Vector3d& largest_half_m);

  // At most `most` points: corners of the box below the ground, each with the normal of its triangle, and
  // points of the grid inside the box, each with the normal of the face through which it gets out soonest. Of
  // more, the deepest and those farthest from the ones taken before. Edges that cross are not looked for: on
  // a grid finer than the box a point is near. Valid until the next call.
  std::span<const Point> touch(const Eigen::Isometry3d& X_WG, const Eigen::Vector3d& half_m,
                               std::size_t most);

 private:
  void add_corners(const Eigen::Isometry3d& X_FG, const Eigen::Vector3d& half_m);
  void add_grid_points(const Eigen::Isometry3d& X_FG, const Eigen::Vector3d& half_m);
  void add_grid_point(const Eigen::Vector3d& p_F, const Eigen::Isometry3d& X_FG,
                      const Eigen::Vector3d& half_m);
  // Moves the points to keep to the front.
  void spread(std::size_t most);

  const HeightField& field_;
  Eigen::Isometry3d X_FW_;
  double highest_m_;
  std::vector<Point> points_;
};

}  // namespace koboshi::sim
