#pragma once

#include "sim_board/robot/load.h"

namespace koboshi::tools {

// The default robot, read once per program: that takes longer than most tests.
inline const sim::RobotDescription& koboshi_robot() {
  static const sim::RobotDescription robot = sim::load_robot(KOBOSHI_SOURCE_DIR "/robots/koboshi/robot.sdf");
  return robot;
}

}  // namespace koboshi::tools
