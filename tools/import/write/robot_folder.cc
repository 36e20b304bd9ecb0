#include "tools/import/write/robot_folder.h"

#include <algorithm>
#include <cctype>
#include <system_error>

#include <fmt/format.h>

#include "base/file/output_file.h"
#include "base/text/error.h"
#include "base/text/text.h"
#include "tools/import/mesh/merge.h"

namespace koboshi::tools {
namespace {

namespace fs = std::filesystem;

constexpr const char* kDecisions = "import.yaml";

// Letters, digits and underscores only: a name of a stranger's file must not lead out of the folder.
std::string file_name(const std::string& name) {
  std::string result;
  for (const char c : name) result += std::isalnum(static_cast<unsigned char>(c)) != 0 ? c : '_';
  return result;
}

bool is_licence(const fs::path& file) {
  std::string name = file.filename().string();
  for (char& c : name) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return name.starts_with("LICENSE") || name.starts_with("LICENCE") || name.starts_with("COPYING") ||
         name.starts_with("NOTICE");
}

}  // namespace

std::map<std::string, std::vector<LinkMesh>> make_link_meshes(const ImportedRobot& robot,
                                                              std::size_t max_triangles, FolderFiles& files,
                                                              ImportReport& report) {
  using Colour = std::optional<std::array<float, 3>>;
  std::map<std::string, std::vector<LinkMesh>> result;
  for (const ImportedLink& link : robot.links) {
    std::map<Colour, view::Mesh> by_colour;
    std::size_t found = 0;
    for (const ImportedShape& shape : link.visuals.empty() ? link.collisions : link.visuals) {
      if (!shape.surface) continue;
      append_surface(by_colour[shape.colour], *shape.surface, shape.X_LG);
      found += shape.surface->triangles.size();
    }
    std::size_t taken = 0;
    for (const auto& [colour, whole] : by_colour) {
      // Each part in proportion, so that the link as a whole keeps to the number.
      const std::size_t share =
          std::max<std::size_t>(max_triangles * whole.triangles.size() / std::max<std::size_t>(found, 1), 12);
      const view::Mesh mesh = simplified(whole, share);
      if (mesh.triangles.empty()) continue;
      taken += mesh.triangles.size();
      std::string file = "meshes/" + file_name(link.name) +
                         (by_colour.size() > 1 ? "_" + std::to_string(result[link.name].size() + 1) : "") +
                         ".stl";
      while (files.contains(file)) file.insert(file.size() - 4, "_");
      files[file] = stl_bytes(mesh);
      result[link.name].push_back({file, colour});
    }
    if (taken < found)
      report.normalised.push_back(fmt::format("{}: {} triangles -> {}", link.name, found, taken));
  }
  return result;
}

void add_licences(const fs::path& source, FolderFiles& files, ImportReport& report) {
  constexpr std::uintmax_t kMaxLicence_bytes = 1 << 20;
  std::error_code ignored;
  fs::path folder = fs::absolute(source, ignored).parent_path();
  for (int i = 0; i < 3 && folder.has_relative_path(); ++i, folder = folder.parent_path()) {
    bool found = false;
    for (const auto& entry : fs::directory_iterator(folder, ignored)) {
      if (!entry.is_regular_file(ignored) || !is_licence(entry.path()) ||
          entry.file_size(ignored) > kMaxLicence_bytes)
        continue;
      files[entry.path().filename().string()] = read_text_file(entry.path(), "a licence");
      found = true;
    }
    if (found) return;
  }
  report.warnings.push_back("no licence file beside the source: ask its author before you publish the robot");
}

void check_import_folder(const fs::path& folder) {
  std::error_code error;
  if (!fs::exists(folder, error)) return;
  if (fs::is_directory(folder, error) &&
      (fs::is_empty(folder, error) || fs::exists(folder / kDecisions, error)))
    return;
  throw InputError(folder, 0, "something that is no import of a robot",
                   "a new folder, or one with the import.yaml of an earlier import");
}

void write_import_folder(const fs::path& folder, const FolderFiles& files) {
  fs::create_directories(folder / "meshes");
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(folder / "meshes", ignored))
    if (entry.path().extension() == ".stl" && !files.contains("meshes/" + entry.path().filename().string()))
      fs::remove(entry.path(), ignored);
  // The decisions last: an import that was interrupted is not taken for a whole one by its user.
  for (const auto& [file, text] : files) {
    if (file == kDecisions) continue;
    fs::create_directories((folder / file).parent_path());
    write_whole_file(folder / file, text);
  }
  write_whole_file(folder / kDecisions, files.at(kDecisions));
}

}  // namespace koboshi::tools
