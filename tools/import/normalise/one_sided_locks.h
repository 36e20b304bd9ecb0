#pragma once

#include <Eigen/Core>

#include "tools/import/decide/decisions.h"
#include "tools/import/robot/imported_robot.h"
#include "tools/import/robot/report.h"

namespace koboshi::tools {

// Warns of each locked joint whose mirror image has a drive, and of each joint that lost its drive because
// its mirror image is locked. `source` is the robot before any joint was locked, `robot` that after; `R_MR`
// turns the axes of the root link to forward, left and up. The mirror image is found by the sides in the
// names, or else by place and axis.
void warn_of_one_sided_locks(const ImportedRobot& source, const ImportedRobot& robot,
                             const Eigen::Matrix3d& R_MR, const Interview& interview, ImportReport& report);

}  // namespace koboshi::tools
