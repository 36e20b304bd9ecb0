#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "firmware/motion/motion.h"
#include "sim_board/input/yaml_tree.h"
#include "simulation/model/robot_model.h"
#include "simulation/motion/source.h"

namespace koboshi::simulation {

// Compiles a motion to the image that the firmware plays on this robot. The same motion gives the same bytes.
// Throws sim::InputError with the line of the error: a move too fast for a joint, a label that is missing,
// duplicate or in another loop, a loop without time, or any other error that the firmware would reject.
[[nodiscard]] std::vector<std::byte> compile_motion(const MotionSource& motion, const NamedModel& robot);

// Reads and compiles a motion file with the given overrides.
[[nodiscard]] std::vector<std::byte> compile_motion(const std::filesystem::path& file,
                                                    const NamedModel& robot,
                                                    std::span<const sim::Override> overrides = {});

// Describes why the firmware rejects a motion.
[[nodiscard]] std::string describe(motion::MotionStatus status);

}  // namespace koboshi::simulation
