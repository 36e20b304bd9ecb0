#pragma once

#include <Eigen/Core>
#include <map>
#include <string>

#include "tools/import/decide/decisions.h"
#include "tools/import/robot/imported_robot.h"
#include "tools/import/robot/report.h"

namespace koboshi::tools {

// Returns the rotation from the axes of the root link to x forward, y left, z up. Asks for both directions;
// the presets are those of find_up() and find_forward().
[[nodiscard]] Eigen::Matrix3d decide_axes(const ImportedRobot& robot, Interview& interview);

// Decides which joint is which: left_hip_yaw and so on, by the tree, the joints' places and their axes, not
// by their names. All joints must be hinges. `R_MR` is that of decide_axes(). The decisions are
// `taken.joints`; joints without a role are not in it. Throws InputError for names in import.yaml that the
// source does not have.
void decide_roles(const ImportedRobot& robot, const Eigen::Matrix3d& R_MR, Interview& interview,
                  ImportReport& report);

}  // namespace koboshi::tools
