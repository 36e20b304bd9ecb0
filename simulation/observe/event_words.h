#pragma once

#include <cstdint>
#include <string>

#include "firmware/behaviour/state.h"
#include "firmware/walk/velocity.h"
#include "simulation/observe/posture.h"
#include "simulation/observe/telemetry.h"
#include "simulation/scenario/scenario.h"

namespace koboshi::simulation {

// Texts of events and verdicts.

[[nodiscard]] std::string name_of(behaviour::State state);
[[nodiscard]] std::string name_of(behaviour::Reason reason);
// Returns whether the controller's state contradicts this lean of the trunk: beyond
// kFallen_rad in every state that should have detected a fall, beyond kUpAgain_rad only when standing. (A
// motion may bow.)
[[nodiscard]] constexpr bool has_not_noticed(behaviour::State state, double tilt_rad) {
  return tilt_rad > kFallen_rad ? behaviour::kMayFall.contains(state)
                                : tilt_rad > kUpAgain_rad && state == behaviour::State::kStanding;
}
inline constexpr const char* kNotNoticed = "its controller has not noticed";

// Formats seconds with a fixed number of decimals: "3.21 s".
[[nodiscard]] std::string seconds_text(std::uint64_t time_us, int decimals = 2);
// Formats a velocity: "0.15 m/s forward, 0.05 m/s left, 0.40 rad/s" or "in place".
[[nodiscard]] std::string velocity_text(const walk::Velocity& velocity);
// Returns the direction of the trunk's lean: front, back, left or right.
[[nodiscard]] std::string lean_direction(const Eigen::Vector3d& rpy_rad);
// Returns the direction of a vector in the world for a robot with this heading: forward, backward, left,
// right, up or down.
[[nodiscard]] std::string direction_text(const Eigen::Vector3d& v_W, double heading_rad);
// Describes a fault: "drive_silent of left_knee", "supply_drop to 3 V".
[[nodiscard]] std::string fault_text(const Fault& fault);
// Formats a count with its noun: "3 faults", "1 fault".
[[nodiscard]] std::string count_text(std::size_t count, const std::string& noun);

}  // namespace koboshi::simulation
