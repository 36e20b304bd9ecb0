#pragma once

namespace koboshi::sim_board {

// Returns whether this program was built with MuJoCo. Without it, Stepper::kMujoco is not available.
[[nodiscard]] bool has_mujoco();

}  // namespace koboshi::sim_board
