#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "firmware/robot/model.h"
#include "sim_board/robot/description.h"

namespace koboshi::simulation {

// Returns the robot model image for the firmware. The same description gives the same bytes on every machine.
// The order of the joints is kept. Throws sim::InputError with the robot's file for properties that a
// RobotModel cannot represent.
[[nodiscard]] std::vector<std::byte> make_robot_model(const sim::RobotDescription& robot);

// A robot model as the firmware loads it, plus the names that its image does not contain.
struct NamedModel {
  std::string robot;
  std::vector<std::string> joint_names;
  std::vector<std::byte> image;
  robot::RobotModel model;
};

// Makes the image and loads it as the firmware does. Throws sim::InputError.
[[nodiscard]] NamedModel load_named_model(const sim::RobotDescription& robot);

// Describes why the firmware rejects an image, for example "a CRC-32 that does not fit".
[[nodiscard]] std::string describe(robot::ModelStatus status);

}  // namespace koboshi::simulation
