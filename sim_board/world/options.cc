#include "sim_board/world/options.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

namespace koboshi::sim_board {

// Indexed by the enumeration.
const std::vector<std::string>& stepper_names() {
  static const std::vector<std::string> names{"world", "lumped", "mujoco"};
  return names;
}

std::string_view name_of(Stepper stepper) { return stepper_names()[static_cast<std::size_t>(stepper)]; }

std::optional<Stepper> stepper_named(std::string_view name) {
  const auto& names = stepper_names();
  const auto found = std::ranges::find(names, name);
  if (found == names.end()) return std::nullopt;
  return static_cast<Stepper>(found - names.begin());
}

WorldOptions checked(WorldOptions options, const RobotDescription& robot) {
  const double steps_a_ms = 0.001 / options.step_s;
  if (!(options.step_s > 0.0) || std::abs(steps_a_ms - std::round(steps_a_ms)) > 1e-9 || steps_a_ms < 0.5)
    throw std::invalid_argument("a step of " + std::to_string(options.step_s) + " s does not divide 1 ms");
  check(options.ground);
  if (options.joint_positions_rad.empty()) options.joint_positions_rad.assign(robot.joints.size(), 0.0);
  if (options.joint_positions_rad.size() != robot.joints.size())
    throw std::invalid_argument("not as many starting positions as joints");
  return options;
}

WorldOptions with_follower_positions(WorldOptions options, const RobotDescription& robot) {
  options.joint_positions_rad = robot.hinge_positions_rad(std::move(options.joint_positions_rad));
  return options;
}

}  // namespace koboshi::sim_board
