#pragma once

#include <span>
#include <vector>

#include "sim_board/description/description.h"
#include "tools/motion_check/body.h"
#include "tools/motion_check/collision.h"
#include "view/recording/recording.h"
#include "view/render/marks.h"

namespace koboshi::studio {

// Finds the links of a robot that penetrate each other, of the pairs that may collide in the simulation.
class OverlapFinder {
 public:
  explicit OverlapFinder(const sim_board::RobotDescription& robot);

  // `links` are the poses of the robot's links. Ascending by link.
  [[nodiscard]] std::vector<int> links_in_overlap(std::span<const view::Pose> links) const;

 private:
  tools::CollisionPairs pairs_;
};

// Outlines the collision boxes of these links in red.
void add_outlines(view::Marks& marks, const view::Scene& scene, std::span<const view::Pose> links,
                  std::span<const int> outlined);

}  // namespace koboshi::studio
