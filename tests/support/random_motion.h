#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace koboshi::test {

// Returns the text of a slow random motion for the default robot: from standing to a random pose and back,
// each held for half a second, by linear moves or by minimum jerk in ten pieces, in 1.2 to 3 s. The pose
// leans the trunk and shifts and lowers the hips on both flat feet; a third of the motions then lift the foot
// that carries less. Arms and head are anywhere. Four of ten poses are out of balance.
std::string random_motion(std::uint64_t seed);

// The text of a scenario in which the robot stands up from its stand and plays `motion`; it does not get up
// from a fall.
std::string trial_scenario(const std::filesystem::path& motion, const std::string& stepper,
                           double duration_s);
inline constexpr double kTrialPlay_s = 2.2;  // when the motion begins

}  // namespace koboshi::test
