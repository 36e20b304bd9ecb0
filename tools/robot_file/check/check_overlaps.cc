#include <algorithm>

#include <fmt/format.h>

#include "base/text/user_units.h"
#include "sim_board/description/hinge_tree.h"
#include "sim_board/engine/common/model_constants.h"
#include "sim_board/world/box_overlap.h"
#include "tools/robot_file/check/checked_model.h"

namespace koboshi::tools {

double overlap_m(const sim_board::LinkDescription& a, const Eigen::Isometry3d& X_MA,
                 const sim_board::LinkDescription& b, const Eigen::Isometry3d& X_MB) {
  double depth_m = 0.0;
  for (const sim_board::BoxDescription& one : a.collisions)
    for (const sim_board::BoxDescription& other : b.collisions)
      depth_m = std::max(depth_m, sim_board::box_overlap_m(X_MA * one.X_LG, 0.5 * one.size_m,
                                                           X_MB * other.X_LG, 0.5 * other.size_m));
  return depth_m;
}

// Links with fewer joints between them may overlap: their boxes hold the same servo.
void check_overlaps(CheckedModel& model) {
  const mechanics::HingeTree tree = sim_board::hinge_tree(model.robot);
  for (std::size_t a = 0; a < model.robot.links.size(); ++a)
    for (std::size_t b = a + 1; b < model.robot.links.size(); ++b) {
      if (tree.distance(a, b) < sim_board::kMinJointsBetween) continue;
      const double depth_m = overlap_m(model.robot.links[a], model.robot.links[a].X_ML, model.robot.links[b],
                                       model.robot.links[b].X_ML);
      if (depth_m <= kTouchingBoxes_m) continue;
      model.warn("R007", model.places.of("link", model.robot.links[b].name),
                 fmt::format("{} and {} overlapping by {:.1f} mm at joint angles zero",
                             model.robot.links[a].name, model.robot.links[b].name, kMmPerM * depth_m),
                 "collision boxes apart from each other",
                 "Make a box smaller: the simulation leaves contacts of this pair out.");
    }
}

}  // namespace koboshi::tools
