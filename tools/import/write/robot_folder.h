#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "tools/import/robot/imported_robot.h"
#include "tools/import/robot/report.h"
#include "tools/import/write/robot_sdf.h"

namespace koboshi::tools {

// Files of a folder, by path relative to it. No path leaves the folder.
using FolderFiles = std::map<std::string, std::string>;

// Merges the visuals of each link, or its collision shapes if it has none, into one STL file for each colour,
// of at most `max_triangles` triangles a link, and adds the files.
[[nodiscard]] std::map<std::string, std::vector<LinkMesh>> make_link_meshes(const ImportedRobot& robot,
                                                                            std::size_t max_triangles,
                                                                            FolderFiles& files,
                                                                            ImportReport& report);

// Adds the licence files beside the source and in the two folders above it: LICENSE, COPYING, NOTICE.
void add_licences(const std::filesystem::path& source, FolderFiles& files, ImportReport& report);

// Throws InputError unless the folder is new, empty, or that of an earlier import.
void check_import_folder(const std::filesystem::path& folder);
// Writes the files, and removes meshes of an earlier import that are not among them.
void write_import_folder(const std::filesystem::path& folder, const FolderFiles& files);

}  // namespace koboshi::tools
