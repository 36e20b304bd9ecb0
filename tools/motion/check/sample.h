#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "simulation/model/robot_model.h"
#include "tools/motion/check/trajectory.h"

namespace koboshi::tools {

// The paths that the check follows through a motion.
struct SampledPaths {
  std::vector<Trajectory> paths{};  // the first one is that of neutral sensors
  bool cut = false;                 // there are more outcomes of branches than paths
  bool endless = false;             // some loop lasts until a stop command
};

inline constexpr std::size_t kMaxPaths = 32;
// The pose is held after the end: the robot comes to rest.
inline constexpr std::size_t kHoldTicks = 50;

// Plays the motion in the firmware's interpreter, 10 ms by 10 ms, from the pose `from_rad`. Endless loops run
// twice. Expected attitudes are met. `image` was compiled for this robot.
[[nodiscard]] SampledPaths sample_motion(std::span<const std::byte> image,
                                         const simulation::NamedModel& robot,
                                         std::span<const double> from_rad);

}  // namespace koboshi::tools
