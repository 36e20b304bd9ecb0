#pragma once

#include "sim_board/description/load.h"

namespace koboshi::tools {

// The default robot, read once per program: that takes longer than most tests.
inline const sim_board::RobotDescription& koboshi_robot() {
  static const sim_board::RobotDescription robot =
      sim_board::load_robot(KOBOSHI_SOURCE_DIR "/robots/koboshi/robot.sdf");
  return robot;
}

}  // namespace koboshi::tools
