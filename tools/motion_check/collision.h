#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <span>
#include <vector>

#include "sim_board/description/description.h"

namespace koboshi::tools {

// Penetration of two links' collision boxes.
struct Overlap {
  double depth_m = 0.0;  // 0: no pair overlaps
  std::uint16_t link = 0;
  std::uint16_t other_link = 0;
};

// The pairs of collision boxes that may touch each other: those of links with at least
// sim_board::kMinJointsBetween joints between them, as in the simulation, unless they overlap at joint angles
// zero.
class CollisionPairs {
 public:
  explicit CollisionPairs(const sim_board::RobotDescription& robot);

  // Returns the deepest overlap of links at these poses, by separating axes of their boxes.
  Overlap deepest(std::span<const Eigen::Isometry3d> X_WLs) const;
  // All of them, in the order of the boxes; a pair of links comes once for each pair of its boxes.
  std::vector<Overlap> all(std::span<const Eigen::Isometry3d> X_WLs) const;
  std::size_t size() const { return pairs_.size(); }

 private:
  struct Box {
    std::size_t link;
    Eigen::Isometry3d X_LG;
    Eigen::Vector3d half_m;
    double radius_m;
  };
  struct Pair {
    std::size_t box;
    std::size_t other_box;
  };

  double overlap_m(std::span<const Eigen::Isometry3d> X_WLs, const Pair& pair) const;

  std::vector<Box> boxes_;
  std::vector<Pair> pairs_;
};

}  // namespace koboshi::tools
