#pragma once

#include <numbers>

#include "firmware/behaviour/state.h"
#include "simulation/observe/ground_truth.h"

namespace koboshi::simulation {

// Whether a simulated robot has fallen, is on its feet, and stands still, by the ground truth: one definition
// for events, summary, experiments and tuning. The limits are those of the firmware
// (firmware/behaviour/posture.h), which judges by its estimates.

// Lean of the trunk beyond which the robot cannot recover its balance and counts as fallen.
inline constexpr double kFallen_rad = std::numbers::pi / 3.0;
// Lean below which a fallen trunk counts as up again. The hysteresis to kFallen_rad keeps a swaying trunk
// from being counted as several falls.
inline constexpr double kUpAgain_rad = std::numbers::pi / 6.0;
// The largest lean of a robot that stands still, and its largest rate.
inline constexpr double kUpright_rad = std::numbers::pi / 12.0;
inline constexpr double kStill_rad_per_s = 0.15;
// The least height of the trunk of a robot that stands, as a share of the height at the joints' targets: one
// that sits is lower.
inline constexpr double kMinStandingHeight = 0.8;

// Returns whether the robot stands, walks or plays a motion: its controller says so, and its trunk is up.
[[nodiscard]] inline bool is_on_its_feet(behaviour::State state, const GroundTruth& truth) {
  return truth.tilt_rad < kUpAgain_rad && behaviour::kOnItsFeet.contains(state);
}

// Returns whether the robot stands upright and still, whatever its controller says.
[[nodiscard]] inline bool stands_still(const GroundTruth& truth) {
  return truth.tilt_rad < kUpright_rad && truth.height_m > kMinStandingHeight * truth.pose_height_m &&
         truth.w_WB_W.norm() < kStill_rad_per_s;
}

}  // namespace koboshi::simulation
