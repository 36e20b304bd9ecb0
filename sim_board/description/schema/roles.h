#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace koboshi::sim_board {

// The places of joints in a humanoid: all values of <koboshi:role>. The firmware uses those of
// robot::JointRole; motions may use any.
const std::vector<std::string>& role_names();

// Exchanges the prefixes left_ and right_; returns other names as they are.
std::string other_side(std::string_view name);

}  // namespace koboshi::sim_board
