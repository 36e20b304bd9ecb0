#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "tools/motion_check/check.h"

namespace koboshi::test {

// The physics of the simulated trials.
struct Physics {
  std::string stepper;
  double step_ms = 1.0;
};

struct Trial {
  tools::Balance balance = tools::Balance::kNotJudged;
  double margin_mm = 0.0;
  bool detected = false;  // by the check's fall detector
  bool refused = false;   // for another error than balance
  bool fell = false;
};

// Checks the random slow motion of a seed, and plays it in the simulation unless the check refuses it for
// another reason than balance. Writes into `folder`.
Trial run_trial(tools::MotionChecker& checker, const std::filesystem::path& folder, std::uint64_t seed,
                const Physics& physics);

}  // namespace koboshi::test
