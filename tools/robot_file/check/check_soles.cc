#include <algorithm>
#include <limits>
#include <optional>

#include <fmt/format.h>

#include "base/text/user_units.h"
#include "sim_board/world/foot.h"
#include "tools/robot_file/check/checked_model.h"

namespace koboshi::tools {
namespace {

constexpr double kLevel_m = 0.0005;        // between the corners of the soles
constexpr std::size_t kCornersOfABox = 4;  // of its underside, in Foot::corners_L

struct Heights {
  double lowest_m = std::numeric_limits<double>::infinity();
  double highest_m = -std::numeric_limits<double>::infinity();

  void take(double height_m) {
    lowest_m = std::min(lowest_m, height_m);
    highest_m = std::max(highest_m, height_m);
  }
};

// The heights of the sole, the underside of a foot's lowest box; a box above it may be of any shape.
Heights sole_of(const sim_board::RobotDescription& robot, const sim_board::Foot& foot) {
  const Eigen::Isometry3d& X_ML = robot.links[static_cast<std::size_t>(foot.link)].X_ML;
  Heights sole;
  for (std::size_t first = 0; first + kCornersOfABox <= foot.corners_L.size(); first += kCornersOfABox) {
    Heights box;
    for (std::size_t i = 0; i < kCornersOfABox; ++i) box.take((X_ML * foot.corners_L[first + i]).z());
    if (box.lowest_m < sole.lowest_m) sole = box;
  }
  return sole;
}

}  // namespace

void check_soles(CheckedModel& model) {
  Heights soles;
  int first_link = -1;
  for (const std::optional<sim_board::Foot>& foot : sim_board::feet_of(model.robot)) {
    if (!foot) return;
    if (first_link < 0) first_link = foot->link;
    const Heights sole = sole_of(model.robot, *foot);
    soles.take(sole.lowest_m);
    soles.take(sole.highest_m);
  }
  const double difference_m = soles.highest_m - soles.lowest_m;
  if (difference_m <= kLevel_m) return;
  model.warn("R008", model.places.of("link", model.robot.links[static_cast<std::size_t>(first_link)].name),
             fmt::format("corners of the soles whose heights differ by {:.1f} mm at joint angles zero",
                         kMmPerM * difference_m),
             fmt::format("level soles at one height, to {:.1f} mm", kMmPerM * kLevel_m),
             "Set the feet's boxes, or where joint zero is.");
}

}  // namespace koboshi::tools
