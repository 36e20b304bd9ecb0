#pragma once

#include "firmware/fixed/literals.h"

namespace koboshi::behaviour {

// Limits of the lean of the trunk, as cosines, and of its rate, by which the firmware tells the postures of a
// robot apart. Host code that judges a run uses the same ones (simulation/observe/posture.h). Set by hand
// (2026-11-22) with the pushes of docs/experiment/stand-up.md.
//
// A robot that stands: 15 degrees.
inline constexpr auto kUprightCosine = fixed::literals::operator""_ratio(0.966L);
// A robot that rests on its feet, or is up again after a fall: 30 degrees.
inline constexpr auto kRestsOnFeetCosine = fixed::literals::operator""_ratio(0.866L);
// A robot that sits: 53 degrees.
inline constexpr auto kSittingCosine = fixed::literals::operator""_ratio(0.6L);
// Beyond this lean the feet no longer carry the robot: 60 degrees.
inline constexpr auto kDownCosine = fixed::literals::operator""_ratio(0.5L);
// The rate about each axis below which Stelter and Bestmann (2021) count a robot as standing after a stand-up
// motion.
inline constexpr auto kStillRate = fixed::literals::operator""_rad_per_s(0.15L);

}  // namespace koboshi::behaviour
