#pragma once

#include <cstddef>
#include <vector>

#include "firmware/robot/model.h"
#include "sim_board/scenario/scenario.h"

namespace koboshi::simulation {

// The image by which the firmware knows the parameters of the robot (app/factory_parameters.h): the same
// bytes for the same file, on every machine; empty for a robot without parameters. Throws sim::InputError,
// naming file and line, for an unknown key, for a value beyond the range of its object, and for what
// check_robot_parameters finds.
[[nodiscard]] std::vector<std::byte> compile_robot_parameters(const sim::RobotParameters& parameters,
                                                              const robot::RobotModel& model);

// Throws sim::InputError for parameters that contradict each other or the body of the robot: half a gait; a
// posture or a step that the legs do not reach; soles that touch; a fall limit at which the centre of mass is
// still over the feet, or beyond the lean at which the robot counts as down; a touchdown load above the
// weight; supply limits out of order.
void check_robot_parameters(const sim::RobotParameters& parameters, const robot::RobotModel& model);

}  // namespace koboshi::simulation
