#pragma once

#include <optional>
#include <span>

#include "base/edit/xml_document.h"
#include "sim_board/description/description.h"
#include "simulation/scenario/scenario.h"

namespace koboshi::simulation {

// Changes the text of the robot's file as `plant` says, one setting after the other. Throws InputError,
// naming the setting's source, for a key or a value that does not fit, and changes nothing then. The result
// may still not load.
void apply_plant(XmlDocument& robot, std::span<const PlantSetting> plant);

// Returns the robot in the world: the scenario's robot with the values of `plant`, which the firmware's model
// does not have. Empty if the scenario changes nothing. Throws InputError, naming the scenario's line, for a
// key or a value that does not fit.
[[nodiscard]] std::optional<sim_board::RobotDescription> read_plant(const Scenario& scenario);
// Returns the robot in the world in any case. Throws InputError as read_robot() does, too.
[[nodiscard]] sim_board::RobotDescription robot_in_world(const Scenario& scenario);

}  // namespace koboshi::simulation
