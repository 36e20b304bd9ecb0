#pragma once

#include <span>
#include <vector>

#include "firmware/app/dictionary.h"
#include "simulation/scenario/operator_pc.h"

namespace koboshi::simulation {

// Converts the parameters of a scenario to SDO writes, rounded to the resolution of the object dictionary.
// Throws InputError for an unknown name and for a value outside the dictionary's range.
std::vector<SdoWrite> resolve_parameters(std::span<const ParameterSetting> settings);

// Returns the controller's values at the first command of the scenario: the neutral values, overridden by the
// robot's parameters and then by the scenario's. Throws InputError as resolve_parameters does.
[[nodiscard]] app::ControllerValues controller_values(const Scenario& scenario);
// The same for the robot's parameters only.
[[nodiscard]] app::ControllerValues controller_values(const RobotParameters& parameters);

}  // namespace koboshi::simulation
