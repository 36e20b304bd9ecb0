#include "tools/import/mesh/mesh_paths.h"

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <string_view>
#include <system_error>

namespace koboshi::tools {
namespace {

namespace fs = std::filesystem;

void add_list(const char* variable, const char* below, std::vector<fs::path>& folders) {
  const char* const value = std::getenv(variable);
  if (value == nullptr) return;
  std::string_view rest = value;
  while (!rest.empty()) {
    const std::size_t end = std::min(rest.find(':'), rest.size());
    if (end > 0) folders.push_back(fs::path(rest.substr(0, end)) / below);
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
}

bool is_file(const fs::path& path) {
  std::error_code ignored;
  return fs::is_regular_file(path, ignored);
}

std::string lower_case(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

// The entry of a folder with a name, whatever the case of its letters; empty without one.
fs::path entry_of(const fs::path& folder, const std::string& name) {
  std::error_code ignored;
  if (fs::exists(folder / name, ignored)) return folder / name;
  std::vector<fs::path> found;
  for (const auto& entry : fs::directory_iterator(folder, ignored))
    if (lower_case(entry.path().filename().string()) == lower_case(name)) found.push_back(entry.path());
  std::ranges::sort(found);  // the order of a folder's entries differs between machines
  return found.empty() ? fs::path() : found.front();
}

}  // namespace

MeshPaths::MeshPaths(const fs::path& robot_file, const std::vector<fs::path>& folders)
    : folder_(robot_file.parent_path()), packages_(folders) {
  add_list("ROS_PACKAGE_PATH", "", packages_);
  add_list("GAZEBO_MODEL_PATH", "", packages_);
  add_list("AMENT_PREFIX_PATH", "share", packages_);
  constexpr int kMaxParents = 4;
  std::error_code ignored;
  fs::path parent = fs::absolute(folder_.empty() ? "." : folder_, ignored);
  for (int i = 0; i < kMaxParents && parent.has_relative_path(); ++i, parent = parent.parent_path())
    packages_.push_back(parent);
}

fs::path MeshPaths::find(const std::string& uri) const {
  constexpr std::string_view kFile = "file://";
  if (uri.starts_with(kFile)) {
    const fs::path file = uri.substr(kFile.size());
    return is_file(file) ? file : fs::path();
  }
  for (const std::string_view scheme : {"package://", "model://"}) {
    if (!uri.starts_with(scheme)) continue;
    const fs::path path = fs::path(uri.substr(scheme.size())).relative_path();
    const fs::path in_package = path.lexically_relative(path.begin() == path.end() ? path : *path.begin());
    for (const fs::path& folder : packages_) {
      if (is_file(folder / path)) return folder / path;
      // The folder may be the package itself, under another name.
      if (is_file(folder / in_package)) return folder / in_package;
    }
    return {};
  }
  if (is_file(folder_ / uri)) return folder_ / uri;
  for (const fs::path& folder : packages_)
    if (is_file(folder / uri)) return folder / uri;
  return {};
}

fs::path MeshPaths::find_by_end(const std::string& uri) const {
  std::string path = uri;
  std::ranges::replace(path, '\\', '/');
  std::vector<std::string> names;
  for (const fs::path& name : fs::path(path).relative_path())
    if (!name.empty() && name != ".") names.push_back(name.string());
  std::vector<fs::path> folders{folder_.empty() ? "." : folder_};
  folders.insert(folders.end(), packages_.begin(), packages_.end());
  for (std::size_t first = 0; first < names.size(); ++first) {
    if (std::ranges::find(names.begin() + static_cast<std::ptrdiff_t>(first), names.end(), "..") !=
        names.end())
      continue;
    for (const fs::path& folder : folders) {
      fs::path at = folder;
      for (std::size_t i = first; i < names.size() && !at.empty(); ++i) at = entry_of(at, names[i]);
      if (!at.empty() && is_file(at)) return at;
    }
  }
  return {};
}

}  // namespace koboshi::tools
