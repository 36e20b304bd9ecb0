#pragma once

#include <string>
#include <vector>

#include "simulation/motion_language/parse/source.h"

namespace koboshi::simulation {

// Returns the index of a routine; the number of routines for an unknown name.
[[nodiscard]] std::size_t routine_index(const MotionSource& motion, const std::string& name);

// Returns the routines in the order of the image: each after those that call it, otherwise as in the file.
// Omits routines that nothing calls, with a warning. Reports routines that call themselves, directly or
// through others.
[[nodiscard]] std::vector<std::size_t> order_of_routines(const MotionSource& motion,
                                                         Diagnostics& diagnostics);

}  // namespace koboshi::simulation
