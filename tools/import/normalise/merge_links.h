#pragma once

#include "tools/import/robot/imported_robot.h"

namespace koboshi::tools {

// Makes a joint rigid at an angle.
void lock_joint(ImportedJoint& joint, double angle_rad);

// Merges the links of fixed joints into the links that carry them: masses, inertias and shapes. The name of
// each merged link stays as a frame.
[[nodiscard]] ImportedRobot merge_fixed_links(const ImportedRobot& robot);

// Adds a mass to a link, by the parallel axis theorem. `X_LC` is the pose of the other link in the link.
void add_mass(ImportedLink& link, const ImportedLink& other, const Eigen::Isometry3d& X_LC);

}  // namespace koboshi::tools
