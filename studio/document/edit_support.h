#pragma once

#include <functional>
#include <map>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/edit/yaml_document.h"
#include "base/yaml/yaml_tree.h"
#include "studio/document/motion_document.h"

namespace koboshi::studio {

// Functions shared by the edits of MotionDocument.

using Steps = std::vector<std::string>;  // of a YamlPath

[[nodiscard]] YamlPath joined(const YamlPath& path, const Steps& more);
[[nodiscard]] YamlPath pose_path(const std::string& pose);

// Returns the value at a path; nullptr if there is none.
[[nodiscard]] const YamlNode* find_node(const YamlNode& root, const YamlPath& path);
// Returns the text of a scalar; empty if there is none.
[[nodiscard]] std::string scalar_at(const YamlNode& root, const YamlPath& path);
// The version of the motion language in which the file is written; 1 if it does not say.
[[nodiscard]] int version_of(const YamlNode& tree);

// Calls `visit` for each step of a list, with its body, in the order of the file.
using StepVisitor = std::function<void(const YamlNode& step, const YamlPath& path)>;
void for_each_step(const YamlNode& list, const YamlPath& path, const StepVisitor& visit);
// Calls `visit` for all steps of a motion: those of the program and of the routines.
void for_each_step(const YamlNode& tree, const StepVisitor& visit);

// A place that names a pose: a step, or a pose that is derived from it.
struct PoseReference {
  YamlPath path;
  std::string pose;
};
[[nodiscard]] std::vector<PoseReference> pose_references(const YamlNode& tree);
// Renames poses with all references, at once. `names`: new names by the old ones.
void rename_poses(YamlDocument& yaml, const std::map<std::string, std::string>& names);

// Writes a text as a YAML value or key, with quotes where it needs them.
[[nodiscard]] std::string yaml_scalar(const std::string& text);
// Indents the lines of a block by two.
[[nodiscard]] std::string indented(const std::string& block);
// Writes a number rounded to a decimal place. `step`: 0.01.
[[nodiscard]] std::string rounded_text(double value, double step);
// Writes a time, rounded to 0.001 s. Throws InputError, which names `source`, beyond that of a step.
[[nodiscard]] std::string time_text(double time_s, int line, const std::filesystem::path& source);
// Writes an angle in degrees, rounded to 0.01 within the joint's limits. Throws InputError, which names
// `source`, for an angle more than half a unit beyond them.
[[nodiscard]] std::string angle_text(const MotionRobot& robot, const JointAngle& angle,
                                     const std::filesystem::path& source);
// Writes a pose of all joints of `allowed` (mask) in flow style, as short as it can.
[[nodiscard]] std::string pose_text(const MotionRobot& robot, std::span<const double> angles_rad,
                                    std::uint32_t allowed, const std::filesystem::path& source);
// Mask of the joints that the motion may move: its list `joints`.
[[nodiscard]] std::uint32_t allowed_joints(const MotionRobot& robot, const YamlNode& tree);

// Returns `wish`, or with a number behind it the first name that is not taken.
[[nodiscard]] std::string fresh_name(const std::set<std::string>& taken, const std::string& wish);
// The same among the poses of a file.
[[nodiscard]] std::string fresh_pose_name(const YamlNode& tree, const std::string& wish);
// Adds poses, a block of entries, behind the entry `index`; creates the map if it is missing.
void add_poses(YamlDocument& yaml, std::size_t index, const std::string& block);

// Returns the rows as runs in the order of the rows. A row stands for its body as well, so that selected
// rows of the body are left out. Throws InputError without a row, and for one that does not exist.
[[nodiscard]] std::vector<YamlItems> runs_of(const MotionRows& rows, std::span<const std::size_t> selected,
                                             const std::filesystem::path& source);
// Returns the selected rows, each once, in order.
[[nodiscard]] std::vector<std::size_t> each_once(const MotionRows& rows,
                                                 std::span<const std::size_t> selected,
                                                 const std::filesystem::path& source);
// Returns all selected rows and those of their bodies, each once, in order.
[[nodiscard]] std::vector<std::size_t> with_bodies(const MotionRows& rows,
                                                   std::span<const std::size_t> selected,
                                                   const std::filesystem::path& source);

}  // namespace koboshi::studio
