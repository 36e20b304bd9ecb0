#pragma once

#include <Eigen/Core>
#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "tools/import/decide/decisions.h"
#include "tools/import/robot/imported_robot.h"
#include "tools/import/servo/servo_catalogue.h"

namespace koboshi::tools {

// A mesh file that a link shows: in m, in the link's frame.
struct LinkMesh {
  std::string file{};  // "meshes/left_thigh.stl"
  std::optional<std::array<float, 3>> colour{};
};

// The parts of a robot's file besides the robot.
struct RobotFileParts {
  std::string name{};  // of the robot
  std::string source{};
  std::map<std::string, std::vector<LinkMesh>> meshes{};  // by link
  std::string servo{};                                    // type of all joints but those in `servos`
  std::map<std::string, std::string> servos{};
  std::string imu_frame{};  // of the trunk; empty: at its centre of mass
  double friction = 0.8;
  double battery_V = 0.0;
};

// Asks for the parts that no file knows: name, IMU, friction and battery.
[[nodiscard]] RobotFileParts decide_parts(const ImportedRobot& robot, const ServoCatalogue& catalogue,
                                          Interview& interview, ImportReport& report);

// Returns the text of robot.sdf of an aligned robot.
[[nodiscard]] std::string robot_sdf(const ImportedRobot& robot, const RobotFileParts& parts,
                                    const ServoCatalogue& catalogue);

}  // namespace koboshi::tools
