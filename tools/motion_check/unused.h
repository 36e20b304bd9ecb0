#pragma once

#include <vector>

#include "firmware/motion/motion.h"
#include "simulation/motion_language/compile/compile.h"
#include "simulation/motion_language/parse/diagnostic.h"
#include "simulation/motion_language/parse/source.h"

namespace koboshi::tools {

// Returns a warning for each pose, label and variable of the source that no step uses, and for the first step
// of each part of the program that no step leads to.
[[nodiscard]] std::vector<simulation::Diagnostic> find_unused(const simulation::MotionSource& source,
                                                              const simulation::CompiledMotion& compiled,
                                                              const motion::Motion& motion);

}  // namespace koboshi::tools
