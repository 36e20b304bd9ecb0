#pragma once

#include <filesystem>

#include "bus/dictionary/network.h"
#include "sim_board/description/load.h"

namespace koboshi::bus {

inline sim_board::RobotDescription default_robot() {
  return sim_board::load_robot(std::filesystem::path(KOBOSHI_SOURCE_DIR) / "robots/koboshi/robot.sdf");
}

inline const Network& default_network() {
  static const Network network = make_network(default_robot());
  return network;
}

}  // namespace koboshi::bus
