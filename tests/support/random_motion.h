#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace koboshi::test {

// Returns the text of a slow random motion for the default robot: from standing to a random pose and back, each
// held for half a second, by linear moves or by minimum jerk in ten pieces, in 1.2 to 3 s. The pose leans the
// trunk, shifts and lowers the hips on both flat feet (6 of 10), shifts to one foot before it lifts the other (3
// of 10), or bends the legs differently, so that the soles are not in one plane (1 of 10). Arms and head are
// anywhere. Many poses are out of balance.
std::string random_motion(std::uint64_t seed);

// The text of a scenario in which the robot stands up from its stand and plays `motion`; it does not get up
// from a fall.
std::string trial_scenario(const std::filesystem::path& motion, const std::string& stepper,
                           double duration_s);
inline constexpr double kTrialPlay_s = 2.2;  // when the motion begins

}  // namespace koboshi::test
