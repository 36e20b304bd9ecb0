#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace koboshi::test {

// Returns the text of a slow random motion for the default robot: from standing to a random pose and back,
// each held for half a second, by linear moves or by minimum jerk, in 1.2 to 3 s. In three quarters of the
// motions the pose leans the trunk and shifts and lowers the hips on both flat feet, with both legs bent
// alike; 45 % of these then lift the foot that carries less. In one quarter the pose turns the trunk about
// all axes above both flat feet, which bends the legs differently, and puts the centre of mass uniformly
// within a box of 170 by 130 by 30 mm around the soles. Arms and head are anywhere. About four of ten poses
// are out of balance.
std::string random_motion(std::uint64_t seed);

// The text of a scenario in which the robot stands up from its stand and plays `motion`; it does not get up
// from a fall. `step_ms`: the time step of the physics.
std::string trial_scenario(const std::filesystem::path& motion, const std::string& stepper, double duration_s,
                           double step_ms = 1.0);
inline constexpr double kTrialPlay_s = 2.2;  // when the motion begins

}  // namespace koboshi::test
