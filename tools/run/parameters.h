#pragma once

#include <span>
#include <vector>

#include "firmware/walk/velocity.h"
#include "sim_board/scenario/operator_pc.h"

namespace koboshi::tools {

// The parameters that a scenario sets, as the controller's object dictionary has them: rounded to its
// resolution. Throws sim::InputError for a name that the controller does not have, and for a value out of the
// range that its dictionary allows.
std::vector<sim::SdoWrite> resolve_parameters(std::span<const sim::ParameterSetting> settings);

// The velocities that the controller obeys: those that it begins with, and what a scenario's parameters make
// of them (object 2111). Throws sim::InputError as resolve_parameters does.
[[nodiscard]] walk::VelocityLimits velocity_limits(const sim::Scenario& scenario);

}  // namespace koboshi::tools
