#pragma once

#include <cstddef>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "simulation/model/robot_model.h"
#include "tools/motion_check/trajectory.h"

namespace koboshi::tools {

// The paths that the check follows through a motion. The first one is that of neutral sensors. Each other one
// begins with an outcome of a condition on sensors that no earlier path has taken from this pose, and ends
// where it comes to a condition from a pose in which an earlier path was there: so every step is reached from
// every pose that precedes it, in any combination of outcomes, also in those that no robot measures.
struct SampledPaths {
  std::vector<Trajectory> paths{};
  bool cut = false;        // there are more outcomes than kMaxPaths
  bool endless = false;    // some loop lasts until a stop command
  double longest_s = 0.0;  // duration of the longest combination of paths, each loop that sensors end once
};

inline constexpr std::size_t kMaxPaths = 32;
// The pose is held after the end: the robot comes to rest.
inline constexpr std::size_t kHoldTicks = 50;
// A path that takes longer than this, 1,200 s, is cut. A path of half of it gets a stop command there, which
// ends a motion that jumps back without end.
inline constexpr std::size_t kMaxPathTicks = 120'000;
inline constexpr std::size_t kStopTick = kMaxPathTicks / 2;

// Plays the motion in the firmware's interpreter, 10 ms by 10 ms, from the pose `from_rad`. Endless loops run
// twice. Expected attitudes are met. A wait for a condition ends at once or at its time-out. `image` was
// compiled for this robot. Returns what it has, unusable, once `cancel` is set.
[[nodiscard]] SampledPaths sample_motion(std::span<const std::byte> image,
                                         const simulation::NamedModel& robot,
                                         std::span<const double> from_rad,
                                         const std::stop_token& cancel = {});

}  // namespace koboshi::tools
