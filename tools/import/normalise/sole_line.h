#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

namespace koboshi::tools {

// Returns the direction of a sole as seen from the side: the longest edge at the bottom of the convex hull of
// a foot's points, towards +x. The points are (forward, up). Nothing if that edge has less than 0.4 of the
// foot's length, as under a round foot, or is more than 35 degrees from level.
[[nodiscard]] std::optional<Eigen::Vector2d> sole_line(std::vector<Eigen::Vector2d> points);

}  // namespace koboshi::tools
