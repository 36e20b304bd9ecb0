#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "tools/import/robot/report.h"

namespace koboshi::tools {

// Points and axes of all joints in the zero pose, in axes parallel to the base's.
struct JointAnchors {
  std::vector<std::string> names{};  // in robot.sdf
  std::vector<Eigen::Vector3d> axes{};
  std::vector<Eigen::Vector3d> points_m{};
};

// Moves the anchors as align_robot() says. Returns the origin of the base, from which they are measured
// afterwards, in the frame from which they were measured before.
[[nodiscard]] Eigen::Vector3d align_anchors(JointAnchors& anchors, double max_miss_m, ImportReport& report);

}  // namespace koboshi::tools
