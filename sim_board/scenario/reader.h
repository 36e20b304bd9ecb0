#pragma once

#include <filesystem>
#include <span>

#include "sim_board/input/yaml_reader.h"
#include "sim_board/scenario/scenario.h"

namespace koboshi::sim {

// The parameters of the robot in this file: those of `parameters.yaml` in the same folder; none without one.
// Throws InputError.
[[nodiscard]] RobotParameters read_robot_parameters(const std::filesystem::path& robot);

// Reads scenarios/*.yaml (docs/reference/scenario-format.md), with the overrides of the command line. The
// files that it names exist; names of joints and links are not yet checked, see check(). Throws InputError.
Scenario read_scenario(const std::filesystem::path& file, std::span<const Override> overrides = {});

// Reads the robot of a scenario and checks the scenario against it. Throws InputError.
RobotDescription read_robot(const Scenario& scenario);

}  // namespace koboshi::sim
