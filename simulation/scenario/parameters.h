#pragma once

#include <span>
#include <vector>

#include "firmware/app/dictionary.h"
#include "sim_board/scenario/operator_pc.h"

namespace koboshi::simulation {

// The parameters that a scenario sets, as the controller's object dictionary has them: rounded to its
// resolution. Throws sim::InputError for a name that the controller does not have, and for a value out of the
// range that its dictionary allows.
std::vector<sim::SdoWrite> resolve_parameters(std::span<const sim::ParameterSetting> settings);

// The controller's values when a scenario's first command comes: neutral, with the robot's parameters, and on
// top of them the scenario's. Throws sim::InputError as resolve_parameters does.
[[nodiscard]] app::ControllerValues controller_values(const sim::Scenario& scenario);
// The same of a robot alone.
[[nodiscard]] app::ControllerValues controller_values(const sim::RobotParameters& parameters);

}  // namespace koboshi::simulation
