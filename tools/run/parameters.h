#pragma once

#include <span>
#include <vector>

#include "sim_board/scenario/operator_pc.h"

namespace koboshi::tools {

// The parameters that a scenario sets, as the controller's object dictionary has them: rounded to its
// resolution. Throws sim::InputError for a name that the controller does not have, and for a value out of the
// range that its dictionary allows.
std::vector<sim::SdoWrite> resolve_parameters(std::span<const sim::ParameterSetting> settings);

}  // namespace koboshi::tools
