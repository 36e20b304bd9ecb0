#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "sim_board/description/description.h"
#include "simulation/model/robot_model.h"

namespace koboshi::studio {

// The robot whose motions are edited.
struct MotionRobot {
  std::shared_ptr<const sim_board::RobotDescription> description;  // joints in the order of `model`
  simulation::NamedModel model;
  // Joint angles by joint. A new motion begins with them, and so does the first step of the timeline.
  std::vector<double> standing_rad;
};

// The standing pose is the end of `motions/stand.yaml` beside the robot's file, zero without it. Throws
// InputError.
[[nodiscard]] std::shared_ptr<const MotionRobot> load_motion_robot(
    std::shared_ptr<const sim_board::RobotDescription> robot);
// The same for a robot's file (SDF).
[[nodiscard]] std::shared_ptr<const MotionRobot> load_motion_robot(const std::filesystem::path& robot_file);

}  // namespace koboshi::studio
