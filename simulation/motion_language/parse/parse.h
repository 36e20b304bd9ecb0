#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include "base/yaml/yaml_tree.h"
#include "simulation/model/robot_model.h"
#include "simulation/motion_language/parse/source.h"

namespace koboshi::simulation {

// A motion file as read: its text for messages, and its tree with the overrides.
struct MotionFile {
  std::filesystem::path path;
  std::string text;
  YamlNode tree;
};

// Returns whether these bytes begin as the image of a motion does.
[[nodiscard]] bool is_motion_image(std::string_view bytes);

// Reads a motion file of at most 1 MiB. Throws MotionError for anything that is no YAML.
[[nodiscard]] MotionFile read_motion_file(const std::filesystem::path& file,
                                          std::span<const Override> overrides = {});
// Uses a text; messages name `path`.
[[nodiscard]] MotionFile read_motion_text(const std::filesystem::path& path, std::string text,
                                          std::span<const Override> overrides = {});

// Parses a motion for this robot. Adds errors to `diagnostics`; the result is complete only if there are
// none. Throws MotionError at the 20th.
[[nodiscard]] MotionSource parse_motion(const MotionFile& file, const NamedModel& robot,
                                        Diagnostics& diagnostics);
// The same for the tree of a file that the caller keeps.
[[nodiscard]] MotionSource parse_motion(const std::filesystem::path& file, const YamlNode& tree,
                                        const NamedModel& robot, Diagnostics& diagnostics);

// Reads and parses a motion file. Throws MotionError with all errors of a missing, unknown or duplicate key,
// of a value beyond a joint's limits, or if the file is for another robot.
[[nodiscard]] MotionSource parse_motion(const std::filesystem::path& file, const NamedModel& robot,
                                        std::span<const Override> overrides = {});

}  // namespace koboshi::simulation
