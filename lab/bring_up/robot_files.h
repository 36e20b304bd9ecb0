#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/file/temporary_folder.h"
#include "base/yaml/yaml_tree.h"
#include "simulation/assembly/prepared_scenario.h"

namespace koboshi::lab {

// The first line of every file that bring-up writes contains this text, and it overwrites no other.
inline constexpr const char* kOrigin = "Written by koboshi bring-up";

// Files of a robot by their paths relative to its folder: "motions/stand.yaml".
using RobotFiles = std::map<std::filesystem::path, std::string>;

// The names of the motions among the files, `stand` first: a robot that is enabled goes to the first pose of
// the first motion.
[[nodiscard]] std::vector<std::string> motion_names(const RobotFiles& files);

// Prepares the scenario `go.yaml` of `files` for the robot of this file, whose own folder is only read. The
// parameters and motions are those of `files`. Throws InputError.
[[nodiscard]] std::shared_ptr<const simulation::PreparedScenario> prepare_files(
    const RobotFiles& files, const std::filesystem::path& robot, const TemporaryFolder& scratch,
    std::span<const Override> overrides);

// Returns the text of a file that bring-up has written; nothing if there is no file. Throws InputError for a
// file of somebody else.
[[nodiscard]] std::optional<std::string> read_own(const std::filesystem::path& file);
// Returns whether there is a file that bring-up has not written.
[[nodiscard]] bool is_foreign(const std::filesystem::path& file);

// A hash of a text: 16 hexadecimal digits.
[[nodiscard]] std::string hash_of(const std::string& text);

}  // namespace koboshi::lab
