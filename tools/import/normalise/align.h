#pragma once

#include <Eigen/Core>
#include <vector>

#include "tools/import/decide/decisions.h"
#include "tools/import/robot/imported_robot.h"
#include "tools/import/robot/report.h"

namespace koboshi::tools {

// Returns the robot as the firmware wants it (docs/design/frames.md), renamed by `taken.joints`:
// - every link's frame is at its joint's anchor and parallel to the base's in the zero pose `angles_rad`;
// - axes within 0.5 degrees of an axis of the base are that axis, and joints with a role turn about +x, +y or
// +z;
// - anchors slide along their own hinge, so that the axes of hip and ankle meet where they miss each other by
// at
//   most the answer to `max_miss_mm`, and hip, knee and ankle lie in one plane;
// - the mid-plane of the legs is y = 0, and the anchors of both sides are mirror images within the same
// distance;
// - the base's frame is midway between the hips; anchors are multiples of 1 um, which a file can hold.
// Each change is a line of `normalised`. A miss that is too large is a warning and stays.
[[nodiscard]] ImportedRobot align_robot(const ImportedRobot& robot, const Eigen::Matrix3d& R_MR,
                                        const std::vector<double>& angles_rad, Interview& interview,
                                        ImportReport& report);

}  // namespace koboshi::tools
