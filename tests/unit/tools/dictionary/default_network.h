#pragma once

#include <filesystem>

#include "sim_board/robot/load.h"
#include "tools/dictionary/network.h"

namespace koboshi::tools {

inline sim::RobotDescription default_robot() {
  return sim::load_robot(std::filesystem::path(KOBOSHI_SOURCE_DIR) / "robots/koboshi/robot.sdf");
}

inline const Network& default_network() {
  static const Network network = make_network(default_robot());
  return network;
}

}  // namespace koboshi::tools
