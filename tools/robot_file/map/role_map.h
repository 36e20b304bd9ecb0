#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "sim_board/description/description.h"
#include "sim_board/description/edit/robot_text.h"

namespace koboshi::tools {

// The roles of a robot's joints, which names say only if their author used ours.
struct RoleMap {
  struct Joint {
    std::string role{};  // of sim_board::role_names(); empty: none
    std::size_t mirror = 0;
    double carried_kg = 0.0;  // mass of all links that the joint moves
  };
  std::vector<Joint> joints{};               // by index of RobotDescription::joints
  std::array<std::optional<int>, 2> feet{};  // links, by hal::Side
};

// Proposes roles from the tree, the axes and the masses at joint angles zero. Legs are the lowest pair of
// chains whose ends and masses are mirror images, arms the longest pair of the others, the head is the
// highest end in the middle. Within a chain, the order of pitch, roll and yaw axes decides. Names have no
// influence; a <koboshi:role> or <koboshi:mirror> of the file has precedence.
[[nodiscard]] RoleMap propose_roles(const sim_board::RobotDescription& robot);

// Applies ROLE=JOINT: the joint gets the role, and another joint that had it gets none. An empty joint leaves
// the role to nobody. Throws InputError for an unknown role or joint.
void correct_role(const sim_board::RobotDescription& robot, const std::string& correction, RoleMap& map);

// Returns the map as YAML, with axes and masses as comments, the maker's servos, soles and inertial unit.
[[nodiscard]] std::string role_map_text(const sim_board::RobotDescription& robot, const RoleMap& map);

// Returns the settings that make the robot's file state the map; none for what it already states.
[[nodiscard]] std::vector<sim_board::ModelSetting> role_settings(const sim_board::RobotDescription& robot,
                                                                 const RoleMap& map);

}  // namespace koboshi::tools
