#pragma once

#include <cstddef>
#include <vector>

#include "firmware/robot/model.h"
#include "simulation/scenario/scenario.h"

namespace koboshi::simulation {

// Compiles the robot's parameters to the firmware's image (app/factory_parameters.h). The same file gives the
// same bytes on every machine; without parameters the image is empty. Throws InputError with file and
// line for an unknown key, for a value outside the range of its object, and for the errors that
// check_robot_parameters finds.
[[nodiscard]] std::vector<std::byte> compile_robot_parameters(const RobotParameters& parameters,
                                                              const robot::RobotModel& model);

// Checks the parameters against each other and the robot's body. Throws InputError for: an incomplete
// gait; a posture or step out of the legs' reach; soles that touch; a fall limit at which the centre of mass
// is still above the feet, or beyond the lean at which the robot counts as down; a touchdown load above the
// weight; supply limits in the wrong order.
void check_robot_parameters(const RobotParameters& parameters, const robot::RobotModel& model);

}  // namespace koboshi::simulation
