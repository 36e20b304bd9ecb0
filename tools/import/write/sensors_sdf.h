#pragma once

#include <string>

namespace koboshi::tools {

// Returns the <sensor> elements of an imported robot: those of the default robot, robots/koboshi/robot.sdf,
// which says where their values come from. `pose`: six numbers in the trunk's frame.
[[nodiscard]] std::string imu_sdf(const std::string& pose);
// Ranges in proportion to the robot's weight. `side`: left or right.
[[nodiscard]] std::string ankle_sensor_sdf(const std::string& side, double weight_N);

}  // namespace koboshi::tools
