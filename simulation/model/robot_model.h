#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "base/text/error.h"
#include "firmware/robot/model.h"
#include "sim_board/description/description.h"

namespace koboshi::simulation {

// Returns the robot model image for the firmware. The same description gives the same bytes on every machine.
// The order of the joints is kept. Throws InputError with the robot's file for properties that a
// RobotModel cannot represent.
[[nodiscard]] std::vector<std::byte> make_robot_model(const sim_board::RobotDescription& robot);

// Returns everything for which make_robot_model() refuses the robot, with file and line.
[[nodiscard]] std::vector<InputError> find_model_errors(const sim_board::RobotDescription& robot);

// A robot model as the firmware loads it, plus the names and points that its image does not contain.
struct NamedModel {
  std::string robot;
  std::vector<std::string> joint_names;
  std::vector<std::string> joint_roles{};  // a joint without a stated role has its name here
  std::vector<std::byte> image;
  robot::RobotModel model;
  std::vector<double>
      encoder_steps_rad{};  // by joint: one count of the encoder, what a measured angle is off by
  // The tip of each hand (left, right) in the frame of the link that the elbow carries: the centre of that
  // face of the link's collision boxes which is farthest from the elbow. Empty: no elbow, or no box.
  std::array<std::optional<robot::Position>, 2> hands{};
};

// Makes the image and loads it as the firmware does. Throws InputError.
[[nodiscard]] NamedModel load_named_model(const sim_board::RobotDescription& robot);

// Describes why the firmware rejects an image, for example "a CRC-32 that does not fit".
[[nodiscard]] std::string describe(robot::ModelStatus status);

}  // namespace koboshi::simulation
