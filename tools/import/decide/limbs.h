#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <vector>

#include "tools/import/robot/imported_robot.h"

namespace koboshi::tools {

// The joints of a limb or a head, from the trunk outwards.
struct Limb {
  std::vector<std::size_t> joints{};
  Eigen::Vector3d first_m = Eigen::Vector3d::Zero();  // anchor of its first joint
  Eigen::Vector3d last_m = Eigen::Vector3d::Zero();   // anchor of its last joint

  Eigen::Vector3d length_m() const { return last_m - first_m; }
};

// Returns the limbs of a robot, in its source's zero pose and in axes that `R_MR` turns from those of the
// root link. A limb begins above the joints that several limbs share, such as a waist; of the fingers of a
// hand only the one with the most joints belongs to the limb. All joints must be hinges.
[[nodiscard]] std::vector<Limb> limbs_of(const ImportedRobot& robot, const Eigen::Matrix3d& R_MR);

// Returns 1 if `one` is the name of the left one of two joints and `other` that of the right one, -1 the
// other way round, 0 if their names do not differ by a side alone: left and right, or one letter l and r.
[[nodiscard]] int side_in_names(const std::string& one, const std::string& other);

// Two directions along axes of the root link, unit vectors.
struct Directions {
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  Eigen::Vector3d forward = Eigen::Vector3d::UnitX();
};

// Returns the direction in which the body points up: against the way from hip to ankle. A direction in which
// two equal limbs hang side by side, lower than all others, is preferred, z first: arms that point forward
// hang, too, where the file's z points forward. `limbs` are those in the axes of the root link.
[[nodiscard]] Eigen::Vector3d find_up(const std::vector<Limb>& limbs);

// Returns the direction in which the body points forward, across the way from one leg to the other. Its sign
// is that of the sides in the names of the legs' joints, of the toes, and of the direction in which the knees
// bend; x where these say nothing.
[[nodiscard]] Eigen::Vector3d find_forward(const ImportedRobot& robot, const std::vector<Limb>& limbs,
                                           const Eigen::Vector3d& up);

}  // namespace koboshi::tools
