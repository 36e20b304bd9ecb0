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

// The image that the firmware plays on this robot: the same bytes for the same motion. Throws sim::InputError
// with the line of a move that is too fast for a joint, a label that is missing, doubled or in another loop,
// a loop in which no time passes, or whatever else the firmware would refuse.
[[nodiscard]] std::vector<std::byte> compile_motion(const MotionSource& motion, const NamedModel& robot);

// Reads and compiles a motion file, some of its values replaced.
[[nodiscard]] std::vector<std::byte> compile_motion(const std::filesystem::path& file,
                                                    const NamedModel& robot,
                                                    std::span<const sim::Override> overrides = {});

// Why the firmware refuses a motion, in words.
[[nodiscard]] std::string describe(motion::MotionStatus status);

}  // namespace koboshi::simulation
