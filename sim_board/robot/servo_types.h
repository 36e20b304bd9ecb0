#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "sim_board/robot/description.h"

namespace koboshi::sim {

using ServoTypes = std::map<std::string, ServoDescription>;

// Reads the servo types of a file, by name: those that a robot file (SDF) defines or imports, or those of a
// library such as robots/servos/bam.xml. Throws InputError with the line.
ServoTypes read_servo_types(const std::filesystem::path& file);

}  // namespace koboshi::sim
