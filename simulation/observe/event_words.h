#pragma once

#include <cstdint>
#include <string>

#include "firmware/behaviour/state.h"
#include "firmware/walk/velocity.h"
#include "sim_board/scenario/scenario.h"
#include "simulation/observe/ground_truth.h"
#include "simulation/observe/telemetry.h"

namespace koboshi::simulation {

// The words of events and verdicts, and what they mean.

// A trunk that leans less than this is up: half of kFallen_rad, so that one that sways about neither angle
// falls many times.
inline constexpr double kUpAgain_rad = 0.5 * kFallen_rad;

// On the way from lying to standing.
[[nodiscard]] constexpr bool gets_up(behaviour::State state) {
  return state == behaviour::State::kRighting || state == behaviour::State::kRolling ||
         state == behaviour::State::kRising || state == behaviour::State::kSteadying;
}

[[nodiscard]] std::string name_of(behaviour::State state);
[[nodiscard]] std::string name_of(behaviour::Reason reason);
// Whether a controller in this state has missed that the trunk leans so: a robot does not lie when it stands
// or walks, and one that stands does not even lean. (A motion may bow.)
[[nodiscard]] constexpr bool has_not_noticed(behaviour::State state, double tilt_rad) {
  return tilt_rad > kFallen_rad ? behaviour::kMayFall.contains(state)
                                : tilt_rad > kUpAgain_rad && state == behaviour::State::kStanding;
}
inline constexpr const char* kNotNoticed = "its controller has not noticed";

// Seconds with a fixed number of decimals: "3.21 s".
[[nodiscard]] std::string seconds_text(std::uint64_t time_us, int decimals = 2);
// "0.15 m/s forward, 0.05 m/s left, 0.40 rad/s"; "in place".
[[nodiscard]] std::string velocity_text(const walk::Velocity& velocity);
// Where the trunk leans to: front, back, left or right.
[[nodiscard]] std::string lean_direction(const Eigen::Vector3d& rpy_rad);
// Where a vector of the world points for a robot with this heading: forward, backward, left, right, up or
// down.
[[nodiscard]] std::string direction_text(const Eigen::Vector3d& v_W, double heading_rad);
// "drive_silent of left_knee", "supply_drop to 3 V".
[[nodiscard]] std::string fault_text(const sim::Fault& fault);
// "3 faults", "1 fault".
[[nodiscard]] std::string count_text(std::size_t count, const std::string& noun);

}  // namespace koboshi::simulation
