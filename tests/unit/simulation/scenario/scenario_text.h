#pragma once

#include <string>
#include <vector>

#include "base/text/error.h"
#include "simulation/scenario/reader.h"
#include "tests/unit/simulation/scenario/temporary_tree.h"

// Scenarios as text, for the tests of their reader.
namespace koboshi::simulation::scenario_text {

inline constexpr const char* kShort =
    "version: 1\n"
    "robot: robots/box/robot.sdf\n"
    "duration_s: 20\n";

inline constexpr const char* kFull = R"(version: 1
robot: robots/box/robot.sdf
motions: [robots/box/motions/bow.yaml, ../robots/box/motions/squat.yaml]
duration_s: 12.5
seed: 7
noise: 0.5
controller: {computing_time_us: 800, tick_jitter_us: 300}
teleop: true
physics: {step_ms: 0.25, stepper: world, friction: rows}
ground: {friction: 0.6, stiffness_N_per_m: 3000, damping_N_s_per_m: 20, tilt_deg: [1, -2]}
initial: {drop_m: 0.01, fixed_base: true, joints_deg: {left_knee: 40, right_knee: -20}}
commands:
  - {at_s: 4, play: squat}
  - {at_s: 1.5, enable: true}
  - {at_s: 9, stop: true}
  - {at_s: 9, emergency_stop: true}
  - {at_s: 10, reset: true}
pushes:
  - {at_s: 6, duration_s: 0.1, link: trunk, force_N: [3, -1, 0.5], at_m: [0, 0, 0.05], shape: half-sine}
  - {at_s: 7, duration_s: 0.2, link: trunk, force_N: [0, 2, 0]}
faults:
  - {at_s: 8, kind: drive_silent, target: left_knee}
  - {at_s: 8.5, kind: ankle_stop, target: right}
  - {at_s: 8.6, kind: bus_unacknowledged}
world: {name: rough, seed: 11}
)";

inline Scenario read(const TemporaryTree& tree, const std::string& text,
                     const std::vector<std::string>& settings = {}) {
  std::vector<Override> overrides;
  for (const std::string& setting : settings) overrides.push_back(parse_override(setting));
  return read_scenario(tree.write("scenarios/test.yaml", text), overrides);
}

// The message with which a text is refused; empty if it is not.
inline std::string refusal(const std::string& text, const std::vector<std::string>& settings = {}) {
  const TemporaryTree tree;
  try {
    read(tree, text, settings);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

}  // namespace koboshi::simulation::scenario_text
