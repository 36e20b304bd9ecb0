#include <stdexcept>

#include "sim_board/engine/mujoco/has_mujoco.h"
#include "sim_board/engine/mujoco/mujoco_world.h"

namespace koboshi::sim_board {

// Replaces the rest of this folder if MuJoCo is not installed.

bool has_mujoco() { return false; }

std::unique_ptr<World> make_mujoco_world(const RobotDescription&, const WorldOptions&) {
  throw std::invalid_argument("this program was built without MuJoCo");
}

}  // namespace koboshi::sim_board
