#pragma once

// The motion compiler turns a motion file into the image that the firmware plays
// (docs/reference/motion-language.md), in these stages:
//
//   parse.h    reads the YAML file into a MotionSource (source.h): parse_steps.h reads the steps with their
//              expressions (expression.h) and settings, poses.h the poses
//   poses.h    computes the angles of derived, mirrored and Cartesian poses (body_targets.h)
//   speed.h    checks the speeds of the moves
//   lower.h    turns structured steps, conditions and expressions into the steps of the image
//   compile.h  writes poses and steps into the image, which the firmware's own validator then checks
//
// All stages add their errors to one list (diagnostic.h), so that one run reports several mistakes.
// decompile.h is the reverse: it writes an image as a file that compiles to the same bytes.

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "base/yaml/yaml_tree.h"
#include "firmware/motion/motion.h"
#include "simulation/model/robot_model.h"
#include "simulation/motion_language/parse/source.h"

namespace koboshi::simulation {

// An image with the places of the source from which its parts were made.
struct CompiledMotion {
  std::vector<std::byte> image;
  std::vector<Place> step_places;       // by step of the image
  std::vector<Place> pose_places;       // by pose of the image
  std::vector<std::string> pose_names;  // by pose of the image; empty for poses of a step
};

// Compiles a motion to the image that the firmware plays on this robot. The same motion gives the same bytes.
// Adds errors to `diagnostics`: a move too fast for a joint, a label that is missing, duplicate or in another
// loop, a loop without time, or any other error that the firmware would reject. The result is empty if there
// is an error.
[[nodiscard]] CompiledMotion compile_motion(const MotionSource& motion, const NamedModel& robot,
                                            Diagnostics& diagnostics);

// As above. Throws MotionError.
[[nodiscard]] std::vector<std::byte> compile_motion(const MotionSource& motion, const NamedModel& robot);

// Reads and compiles a motion file with the given overrides. Throws MotionError.
[[nodiscard]] std::vector<std::byte> compile_motion(const std::filesystem::path& file,
                                                    const NamedModel& robot,
                                                    std::span<const Override> overrides = {});

// Describes why the firmware rejects a motion.
[[nodiscard]] std::string describe(motion::MotionStatus status);

}  // namespace koboshi::simulation
