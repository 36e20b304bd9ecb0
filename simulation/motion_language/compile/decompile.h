#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "simulation/model/robot_model.h"

namespace koboshi::simulation {

// Returns the source, version 2, of an image for this robot. It compiles to the same bytes, if each angle is
// the one nearest to an angle within its joint's limits, as compile_motion writes them. Names of poses,
// variables, labels and routines are numbers; branches are the low-level steps `branch` and `await`. `source`
// names the image in messages. Throws InputError for an image that the firmware rejects.
[[nodiscard]] std::string decompile_motion(std::span<const std::byte> image, const NamedModel& robot,
                                           const std::string& source);

}  // namespace koboshi::simulation
