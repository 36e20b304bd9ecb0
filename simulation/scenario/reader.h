#pragma once

#include <filesystem>
#include <span>
#include <vector>

#include "base/yaml/yaml_reader.h"
#include "simulation/scenario/scenario.h"

namespace koboshi::simulation {

// Reads the parameters of a robot from `parameters.yaml` in the folder of its file; empty if that does not
// exist. Throws InputError.
[[nodiscard]] RobotParameters read_robot_parameters(const std::filesystem::path& robot);
// Reads the contents of such a file. Throws InputError.
[[nodiscard]] RobotParameters read_robot_parameters(const YamlFile& yaml);

// Reads scenarios/*.yaml (docs/reference/scenario-format.md) with the overrides of the command line. Checks
// that referenced files exist, but not the names of joints and links, see check(). Throws InputError.
Scenario read_scenario(const std::filesystem::path& file, std::span<const Override> overrides = {});

// Reads the key `plant` of a scenario's document, in the order of the file; empty without the key. Throws
// InputError unless it is a map of texts, which may be nested; apply_plant() checks keys and values.
[[nodiscard]] std::vector<PlantSetting> read_plant_settings(const YamlMap& root);

// Reads the robot of a scenario and checks the scenario against it. Throws InputError.
sim_board::RobotDescription read_robot(const Scenario& scenario);

}  // namespace koboshi::simulation
