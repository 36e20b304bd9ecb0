#pragma once

#include <Eigen/Core>
#include <vector>

#include "tools/import/decide/decisions.h"
#include "tools/import/robot/imported_robot.h"
#include "tools/import/robot/report.h"

namespace koboshi::tools {

// Returns the angles of the source's joints at which the robot stands straight, by joint: legs upright, feet
// forward, arms hanging (docs/design/frames.md). Joints without a role keep their zero. import.yaml's
// `zero_deg` wins. Axes that are straight within the tolerance of align_robot() are left to it.
[[nodiscard]] std::vector<double> decide_zero_pose(const ImportedRobot& robot, const Eigen::Matrix3d& R_MR,
                                                   Interview& interview, ImportReport& report);

}  // namespace koboshi::tools
