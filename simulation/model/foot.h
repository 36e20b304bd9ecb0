#pragma once

#include <Eigen/Core>
#include <vector>

#include "base/text/error.h"
#include "firmware/robot/model.h"
#include "sim_board/description/description.h"

namespace koboshi::simulation {

// The count at which sensor scales are given.
inline constexpr double kFullScaleCounts = 32768.0;

[[nodiscard]] robot::Position fixed_position(const Eigen::Vector3d& p_m);

// Height from the lowest to the highest corner of all collision boxes at joint angles zero.
[[nodiscard]] fixed::Length body_height(const sim_board::RobotDescription& robot);

// Sets the soles, from the collision boxes of the links below the ankle rolls, and the ankle sensors with
// their scales. Appends errors as model_fields() does.
void set_feet(const sim_board::RobotDescription& robot, robot::RobotModel& model,
              std::vector<InputError>& errors);

}  // namespace koboshi::simulation
