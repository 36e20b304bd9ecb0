#pragma once

#include <optional>
#include <vector>

#include "firmware/motion/motion.h"
#include "simulation/motion_language/parse/source.h"

namespace koboshi::simulation {

// The steps of an image, with the place of the source from which each was made.
struct LoweredMotion {
  std::vector<motion::Step> steps;
  std::vector<Place> places;
  std::size_t variables = 0;             // those of the file and those of intermediate results
  std::uint16_t exit = motion::kNoStep;  // step at which the exit path begins
};

// Lowers the structured steps of a motion to those of an image: `if`, `while` and mixed conditions become
// branches, expressions assignments, and settings of one step become steps before and after it.
// `pose_numbers`: number in the image of each pose; none for one without joints, a move to which is a wait.
// Adds errors to `diagnostics`; the result is complete only if there are none.
[[nodiscard]] LoweredMotion lower_motion(const MotionSource& motion,
                                         const std::vector<std::optional<std::uint16_t>>& pose_numbers,
                                         Diagnostics& diagnostics);

}  // namespace koboshi::simulation
