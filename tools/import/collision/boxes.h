#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "sim_board/world/box_overlap.h"
#include "tools/import/robot/imported_robot.h"

namespace koboshi::tools {

// The collision boxes of an aligned robot in a pose. Each link has one box or none. Refers to the robot,
// whose tree must not change; its boxes may.
class Boxes {
 public:
  explicit Boxes(ImportedRobot& robot);

  struct Turn {
    std::size_t joint = 0;
    double angle_rad = 0.0;
  };

  // Sets the joint angles; all joints that are not listed are at zero.
  void pose(std::span<const Turn> turns);

  // Returns whether two links have boxes and make contacts in the simulation: at least
  // sim_board::kMinJointsBetween joints lie between them.
  bool may_touch(std::size_t a, std::size_t b) const;
  // Returns whether a link moves with `above`, or is it.
  bool is_below(std::size_t link, int above) const;
  // Returns the number of joints between two links.
  int distance(std::size_t a, std::size_t b) const;

  // In the present pose.
  double overlap_m(std::size_t a, std::size_t b) const;
  sim_board::BoxSeparation separation(std::size_t a, std::size_t b) const;
  // Returns whether even the balls around two boxes are farther apart than `gap_m`, which is quick to find.
  bool are_far(std::size_t a, std::size_t b, double gap_m) const;
  // Height of the lowest corner of a box above the sole of a foot, across the sole.
  double height_above_sole_m(std::size_t link, std::size_t foot) const;
  // Bounds along the model's axes, in the zero pose only.
  Eigen::AlignedBox3d bounds(std::size_t link) const;

  ImportedShape& box(std::size_t link) const { return robot_.links[link].collisions.front(); }
  bool has_box(std::size_t link) const { return !robot_.links[link].collisions.empty(); }
  std::size_t size() const { return robot_.links.size(); }
  ImportedRobot& robot() const { return robot_; }

 private:
  ImportedRobot& robot_;
  std::vector<std::size_t> order_;
  std::vector<int> parent_;  // by link
  std::vector<int> depth_;
  std::vector<Eigen::Isometry3d> X_ML_;
};

// Cuts a slice off a box at one end of an axis; `at_max`: the end of the larger coordinate.
void cut_slice(ImportedShape& box, int axis, bool at_max, double depth_m);

// Makes boxes smaller, each as its mirror image. Feet keep their soles. No side becomes shorter than a share
// of what it was at the beginning, below which the box is no image of its link.
class BoxCutter {
 public:
  explicit BoxCutter(Boxes& boxes);

  // Cuts a slice off a box at one end of an axis; `at_max`: the end of the larger coordinate. Returns false,
  // and cuts nothing, if the side would become too short.
  bool cut(std::size_t link, int axis, bool at_max, double depth_m);
  // Shrinks a box about its centre by a step; false as above.
  bool shrink(std::size_t link);
  // Returns what cut() may still take off a side; 0 for a foot.
  double spare_m(std::size_t link, int axis) const;
  double original_m(std::size_t link, int axis) const { return original_m_[link][axis]; }
  // Returns the smallest ratio of a side to what it was at the beginning.
  double smallest_share(std::size_t link) const;

 private:
  // Whether a box of the middle is its own mirror image; a cut at its left end then is one at its right end.
  bool is_own_image(std::size_t link) const;

  Boxes& boxes_;
  ImportedRobot& robot_;
  std::vector<Eigen::Vector3d> original_m_;
};

}  // namespace koboshi::tools
