#include "tools/motion_check/collision.h"

#include "sim_board/description/hinge_tree.h"
#include "sim_board/engine/common/model_constants.h"
#include "sim_board/world/box_overlap.h"

namespace koboshi::tools {

using Eigen::Isometry3d;
using Eigen::Vector3d;

CollisionPairs::CollisionPairs(const sim_board::RobotDescription& robot) {
  for (std::size_t link = 0; link < robot.links.size(); ++link) {
    for (const sim_board::BoxDescription& box : robot.links[link].collisions)
      boxes_.push_back({link, box.X_LG, 0.5 * box.size_m, 0.5 * box.size_m.norm()});
  }
  const mechanics::HingeTree tree = sim_board::hinge_tree(robot);
  const auto rest = tree.poses(Isometry3d::Identity(), std::vector<double>(robot.joints.size(), 0.0));
  for (std::size_t a = 0; a < boxes_.size(); ++a) {
    for (std::size_t b = a + 1; b < boxes_.size(); ++b) {
      const Pair pair{a, b};
      if (tree.distance(boxes_[a].link, boxes_[b].link) >= sim_board::kMinJointsBetween &&
          overlap_m(rest, pair) <= 0.0)
        pairs_.push_back(pair);
    }
  }
}

double CollisionPairs::overlap_m(std::span<const Isometry3d> X_WLs, const Pair& pair) const {
  const Box& a = boxes_[pair.box];
  const Box& b = boxes_[pair.other_box];
  const auto centre = [&](const Box& box) -> Vector3d { return X_WLs[box.link] * box.X_LG.translation(); };
  const double reach_m = a.radius_m + b.radius_m;
  if ((centre(b) - centre(a)).squaredNorm() >= reach_m * reach_m) return 0.0;
  return sim_board::box_overlap_m(X_WLs[a.link] * a.X_LG, a.half_m, X_WLs[b.link] * b.X_LG, b.half_m);
}

std::vector<Overlap> CollisionPairs::all(std::span<const Isometry3d> X_WLs) const {
  std::vector<Overlap> found;
  for (const Pair& pair : pairs_)
    if (const double depth_m = overlap_m(X_WLs, pair); depth_m > 0.0)
      found.push_back({depth_m, static_cast<std::uint16_t>(boxes_[pair.box].link),
                       static_cast<std::uint16_t>(boxes_[pair.other_box].link)});
  return found;
}

Overlap CollisionPairs::deepest(std::span<const Isometry3d> X_WLs) const {
  Overlap deepest;
  for (const Pair& pair : pairs_) {
    const double depth_m = overlap_m(X_WLs, pair);
    if (depth_m <= deepest.depth_m) continue;
    deepest = {depth_m, static_cast<std::uint16_t>(boxes_[pair.box].link),
               static_cast<std::uint16_t>(boxes_[pair.other_box].link)};
  }
  return deepest;
}

}  // namespace koboshi::tools
