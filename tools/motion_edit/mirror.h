#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "simulation/motion_language/parse/joints.h"

namespace koboshi::tools {

// Returns the mirror image of a motion file: left and right are exchanged in joints, feet, hands and sensors,
// and everything about the axes x and z, or along y, changes its sign. Comments, order and layout stay;
// mirroring twice gives the same motion. `name`: of the result; without it, left and right are exchanged in
// the name as well. The text must be a motion without errors. Throws InputError for text that is no
// YAML.
[[nodiscard]] std::string mirror_motion(const std::filesystem::path& source, const std::string& text,
                                        const simulation::JointNames& joints,
                                        const std::optional<std::string>& name);

// Exchanges the words left and right anywhere in a name: "turn_left" becomes "turn_right".
[[nodiscard]] std::string exchange_left_and_right(const std::string& name);

// Returns a condition or number as the mirrored robot sees it: "-roll_mdeg > left_load_mN".
[[nodiscard]] std::string mirror_expression(std::string_view text, const simulation::JointNames& joints);

}  // namespace koboshi::tools
