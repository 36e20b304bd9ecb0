#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "firmware/policy/policy.h"
#include "firmware/robot/model.h"

namespace koboshi::simulation {

// Returns in words why the firmware refuses a policy.
[[nodiscard]] std::string describe(const policy::PolicyVerdict& verdict);

// Reads the image of a policy. Throws InputError, with the firmware's reason, if this robot cannot run it.
[[nodiscard]] std::vector<std::byte> read_policy_image(const std::filesystem::path& file,
                                                       const robot::RobotModel& model);

}  // namespace koboshi::simulation
