#pragma once

#include <filesystem>
#include <span>

#include "sim_board/input/yaml_tree.h"
#include "simulation/model/robot_model.h"
#include "simulation/motion/source.h"

namespace koboshi::simulation {

// Reads a motion file for this robot. Throws sim::InputError with the line of a missing, unknown or duplicate
// key, of a value beyond a joint's limits, or if the file is for another robot.
[[nodiscard]] MotionSource parse_motion(const std::filesystem::path& file, const NamedModel& robot,
                                        std::span<const sim::Override> overrides = {});

}  // namespace koboshi::simulation
