#pragma once

#include <cstddef>
#include <map>

#include "simulation/model/robot_model.h"
#include "simulation/motion_language/parse/source.h"

namespace koboshi::simulation {

// The joint of a move that comes closest to its speed limit, or exceeds it most.
struct FastestJoint {
  std::size_t joint = 0;
  double rad_per_s = 0.0;  // peak
  double share = 0.0;      // of its limit
};

// Checks that no move exceeds a joint's speed limit, with the peak speed of its interpolation. A joint's
// moves are not checked where its angle before is unknown: the first one, and those directly after a label, a
// call, or branches that end in different poses. A move with a least time takes the time that its joints
// need.
void check_speeds(const MotionSource& motion, const NamedModel& robot, Diagnostics& diagnostics);

// The same for other uses, by the moves of `motion`: those whose beginning is unknown, and those with a least
// time, are not in it.
[[nodiscard]] std::map<const StepSource*, FastestJoint> fastest_joints(const MotionSource& motion,
                                                                       const NamedModel& robot);

}  // namespace koboshi::simulation
