#pragma once

#include <cstddef>

#include "tools/import/decide/decisions.h"
#include "tools/import/robot/imported_robot.h"
#include "tools/import/robot/report.h"

namespace koboshi::tools {

// Whether two joints, of which one mimics the other, each carry a limb of its own, as both hip yaws of a
// robot with one motor for them do. A finger that mimics another one carries no limb, and the two axes of a
// knee are one behind the other.
[[nodiscard]] bool are_limbs_of_one_motor(const ImportedRobot& robot, std::size_t joint, std::size_t other);

// Marks the joints that follow another one (ImportedJoint::is_follower), after a question if there are any. A
// joint that `interview` locks neither follows nor leads.
void decide_followers(ImportedRobot& robot, Interview& interview, ImportReport& report);

// Keeps the followers whose roles are both hip yaws, the only ones that the firmware walks with; locks the
// others with their leaders, and warns.
void lock_other_followers(ImportedRobot& robot, Interview& interview, ImportReport& report);

// Narrows the range of each leader to angles at which its follower is within its own, and gives the follower
// the range that is left.
void limit_followers(ImportedRobot& robot, ImportReport& report);

}  // namespace koboshi::tools
