#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "base/yaml/yaml_reader.h"

namespace koboshi::simulation {

// Returns the folder of the robots, scenarios and studies that come with the program. It is found from the
// place of the program or of its Python module: the nearest parent that contains robots/ and scenarios/ (a
// build in its source tree), or share/koboshi with them (an installation, wherever it was moved). Otherwise
// the folder that CMake was given, KOBOSHI_DATA_FOLDER.
std::filesystem::path data_folder();

// Returns the repository of a folder: the folder or its nearest parent that contains robots/ and scenarios/,
// or else data_folder().
std::filesystem::path repository_root(const std::filesystem::path& folder);

// Resolves a path that a file in `folder` contains: relative to that folder, then to the repository's root,
// to the user's data ($XDG_DATA_HOME/koboshi, by default ~/.local/share/koboshi) and to data_folder(). Empty
// if no such file exists.
std::filesystem::path find_referenced(const std::filesystem::path& folder, const std::filesystem::path& path);

// Resolves a value that is a path. Throws InputError if the file does not exist.
std::filesystem::path read_path(const YamlValue& value, const std::filesystem::path& folder);

// Kind of an input file. A name stands for scenarios/NAME.yaml, robots/NAME/robot.sdf (or robot.urdf),
// robots/NAME/gait.yaml or studies/NAME.yaml.
enum class InputKind { kScenario, kRobot, kGait, kStudy, kLearningStudy };

// Resolves the path of a file or folder that a user names. What exists wins. A relative path is then searched
// as find_referenced() does from the working folder. Returns a path that is not found as it is, for its
// reader to refuse.
[[nodiscard]] std::filesystem::path find_path(const std::filesystem::path& given);

// Resolves the path, or the name, of an input file as find_path() does. A name, which is a path without a
// slash, is then searched in the same folders as InputKind says. Throws InputError for a name that is not
// found, with the folders searched and the nearest names; returns a path that is not found as it is, for its
// reader to refuse. A folder with a robot's file stands for that file.
[[nodiscard]] std::filesystem::path find_input(InputKind kind, const std::filesystem::path& given);

// Resolves a motion file of a robot as find_input() does; a name is motions/NAME.yaml in the folder of the
// robot's file. The path may be that of a folder of motions.
[[nodiscard]] std::filesystem::path find_motion(const std::filesystem::path& given,
                                                const std::filesystem::path& robot);

// Returns the names that find_input() knows, in alphabetical order.
[[nodiscard]] std::vector<std::string> input_names(InputKind kind);

// Returns the names of the motions in the folder of a robot's file, in alphabetical order.
[[nodiscard]] std::vector<std::string> robot_motion_names(const std::filesystem::path& robot);

// Returns the override that replaces the robot of a scenario by the one that a user names: its file, its
// folder or its name. Throws InputError as find_input() does. Empty: an override without a value.
[[nodiscard]] Override robot_override(const std::string& given);

// Resolves a value of a file in `folder` that is a path or a name. Throws InputError if neither exists.
std::filesystem::path read_input(const YamlValue& value, const std::filesystem::path& folder, InputKind kind);
// The same for a file that belongs to a robot: a path as read_path() resolves it, or relative to the folder
// of the robot's file or a subfolder of it, or to that of the robot of the same name that find_input() knows.
// The extension .yaml may be left out there.
std::filesystem::path read_robot_file(const YamlValue& value, const std::filesystem::path& folder,
                                      const std::filesystem::path& robot,
                                      const std::filesystem::path& subfolder = {});
// Returns whether that file exists.
[[nodiscard]] bool has_robot_file(const YamlValue& value, const std::filesystem::path& folder,
                                  const std::filesystem::path& robot,
                                  const std::filesystem::path& subfolder = {});

// Returns how a message calls a robot, and what the user types: the folder of its file, relative to the
// working folder where it lies in it.
[[nodiscard]] std::string robot_text(const std::filesystem::path& robot);
// Returns the remedy for a robot without files of its own, such as after `koboshi model import`.
[[nodiscard]] std::string bring_up_remedy(const std::filesystem::path& robot);

}  // namespace koboshi::simulation
