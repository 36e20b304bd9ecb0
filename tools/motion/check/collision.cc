#include "tools/motion/check/collision.h"

#include <Eigen/Geometry>

#include "sim_board/engine/common/model_constants.h"
#include "sim_board/world/box_overlap.h"
#include "sim_board/world/link_tree.h"

namespace koboshi::tools {

using Eigen::Isometry3d;
using Eigen::Vector3d;

CollisionPairs::CollisionPairs(const sim_board::RobotDescription& robot, const Body& body) {
  for (std::size_t link = 0; link < robot.links.size(); ++link) {
    for (const sim_board::BoxDescription& box : robot.links[link].collisions)
      boxes_.push_back(
          {link, box.X_LG.linear(), box.X_LG.translation(), 0.5 * box.size_m, 0.5 * box.size_m.norm()});
  }
  const sim_board::LinkTree tree(robot);
  LinkPlaces rest;
  body.place(std::vector<double>(robot.joints.size(), 0.0), rest);
  for (std::size_t a = 0; a < boxes_.size(); ++a) {
    for (std::size_t b = a + 1; b < boxes_.size(); ++b) {
      const int joints = tree.distance(static_cast<int>(boxes_[a].link), static_cast<int>(boxes_[b].link));
      const Pair pair{a, b};
      if (joints >= sim_board::kMinJointsBetween && overlap_m(rest, pair) <= 0.0) pairs_.push_back(pair);
    }
  }
}

double CollisionPairs::overlap_m(const LinkPlaces& places, const Pair& pair) const {
  const Box& a = boxes_[pair.box];
  const Box& b = boxes_[pair.other_box];
  const auto centre = [&](const Box& box) -> Vector3d {
    return places.p_BL[box.link] + places.R_BL[box.link] * box.p_LG;
  };
  const Vector3d centre_a = centre(a);
  const Vector3d centre_b = centre(b);
  const double reach_m = a.radius_m + b.radius_m;
  if ((centre_b - centre_a).squaredNorm() >= reach_m * reach_m) return 0.0;
  const auto pose = [&](const Box& box, const Vector3d& p) {
    Isometry3d X = Isometry3d::Identity();
    X.linear() = places.R_BL[box.link] * box.R_LG;
    X.translation() = p;
    return X;
  };
  return sim_board::box_overlap_m(pose(a, centre_a), a.half_m, pose(b, centre_b), b.half_m);
}

std::vector<Overlap> CollisionPairs::all(const LinkPlaces& places) const {
  std::vector<Overlap> found;
  for (const Pair& pair : pairs_)
    if (const double depth_m = overlap_m(places, pair); depth_m > 0.0)
      found.push_back({depth_m, static_cast<std::uint16_t>(boxes_[pair.box].link),
                       static_cast<std::uint16_t>(boxes_[pair.other_box].link)});
  return found;
}

Overlap CollisionPairs::deepest(const LinkPlaces& places) const {
  Overlap deepest;
  for (const Pair& pair : pairs_) {
    const double depth_m = overlap_m(places, pair);
    if (depth_m <= deepest.depth_m) continue;
    deepest = {depth_m, static_cast<std::uint16_t>(boxes_[pair.box].link),
               static_cast<std::uint16_t>(boxes_[pair.other_box].link)};
  }
  return deepest;
}

}  // namespace koboshi::tools
