#pragma once

#include <Eigen/Core>

#include "firmware/robot/model.h"
#include "sim_board/robot/description.h"

namespace koboshi::simulation {

// Sensor scales are given for this count.
inline constexpr double kFullScaleCounts = 32768.0;

[[nodiscard]] robot::Position fixed_position(const Eigen::Vector3d& p_m);

// From the lowest to the highest corner of all collision boxes at joint zero.
[[nodiscard]] fixed::Length body_height(const sim::RobotDescription& robot);

// Soles from the collision boxes of the links below the ankle rolls, ankle sensors, and their scales. Throws
// sim::InputError.
void set_feet(const sim::RobotDescription& robot, robot::RobotModel& model);

}  // namespace koboshi::simulation
