#pragma once

#include <filesystem>
#include <map>
#include <span>
#include <string>

#include "base/xml/xml_reader.h"
#include "sim_board/description/description.h"

namespace koboshi::sim_board {

using ServoTypes = std::map<std::string, ServoDescription>;

// Says which servo type is expected instead of an unknown one: those that the robot's file defines or
// includes, and how it includes others.
[[nodiscard]] std::string expected_servo_type(const std::string& misspelt,
                                              std::span<const std::string> known);

// The libraries of servo types that a robot's file includes. Each is read and parsed once.
class ServoLibraries {
 public:
  // Throws InputError if the file cannot be read or violates its schema.
  const XmlFile& open(const std::filesystem::path& file);

 private:
  std::map<std::filesystem::path, XmlFile> files_;
};

// Returns the servo as the joint sees it behind a stage of this ratio: turns of the servo's output shaft per
// turn of the joint. The stage has no mass, friction or backlash of its own.
[[nodiscard]] ServoDescription behind_gear(ServoDescription servo, double ratio);

// Reads the servo types of a file, by name: those that a robot file (SDF) defines or imports, or those of a
// library such as robots/servos/bam.xml. Throws InputError with the line.
ServoTypes read_servo_types(const std::filesystem::path& file);

}  // namespace koboshi::sim_board
