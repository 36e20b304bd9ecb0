#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "firmware/robot/model.h"
#include "sim_board/robot/description.h"

namespace koboshi::simulation {

// The image by which the firmware knows the robot: the same bytes for the same description, on every machine.
// Joints keep their order. Throws sim::InputError, naming the robot's file, for what a RobotModel cannot
// express.
[[nodiscard]] std::vector<std::byte> make_robot_model(const sim::RobotDescription& robot);

// A robot as the firmware sees it, with the names that the firmware does without.
struct NamedModel {
  std::string robot;
  std::vector<std::string> joint_names;
  std::vector<std::byte> image;
  robot::RobotModel model;
};

// make_robot_model and what the firmware reads from it. Throws sim::InputError.
[[nodiscard]] NamedModel load_named_model(const sim::RobotDescription& robot);

// Why the firmware refuses an image, in words: "a CRC-32 that does not fit".
[[nodiscard]] std::string describe(robot::ModelStatus status);

}  // namespace koboshi::simulation
