#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "simulation/assembly/simulation.h"
#include "simulation/observe/run_recorder.h"

namespace koboshi::test {

// Trials of the motions of docs/reference/motions.md: each has a criterion of success, which the simulation's
// ground truth decides.

// The names of the trials: those of the motions, but for sit, which plays sit_down and sit_up.
[[nodiscard]] const std::vector<std::string>& library_trials();

struct LibraryOutcome {
  std::string failure{};   // what was missing; empty: success
  std::string measured{};  // the quantity that decides, with its unit
};

// Plays a trial in the world that a seed draws (docs/reference/worlds.md), or as the files are with no name
// of a world. Throws InputError.
[[nodiscard]] LibraryOutcome play_library_trial(std::string_view trial, std::string_view stepper,
                                                std::string_view world, std::uint64_t seed);

}  // namespace koboshi::test
