#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "firmware/robot/abilities.h"
#include "firmware/robot/model.h"

namespace koboshi::simulation {

// An ability that a robot lacks (robot::Ability), and what it needs for it.
struct LostAbility {
  robot::Ability ability{};
  std::string name;      // as in summary.json: "zmp"
  std::string found;     // "no load cells in the feet: the ZMP is not measured"
  std::string expected;  // "force_torque or koboshi:pressure_cells sensors in both ankles"
};

// Returns the lost abilities of a robot, by their bits.
[[nodiscard]] std::vector<LostAbility> find_lost_abilities(const robot::RobotModel& model);

}  // namespace koboshi::simulation
