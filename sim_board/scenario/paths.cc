#include "sim_board/scenario/paths.h"

namespace koboshi::sim {

namespace fs = std::filesystem;

fs::path repository_root(const fs::path& folder) {
  fs::path candidate = folder.empty() ? fs::current_path() : fs::absolute(folder).lexically_normal();
  while (true) {
    if (fs::is_directory(candidate / "robots") && fs::is_directory(candidate / "scenarios")) return candidate;
    if (candidate == candidate.parent_path()) return KOBOSHI_SOURCE_DIR;
    candidate = candidate.parent_path();
  }
}

fs::path find_referenced(const fs::path& folder, const fs::path& path) {
  for (const fs::path& base : {folder, repository_root(folder)}) {
    const fs::path file = (base / path).lexically_normal();
    std::error_code ignored;  // of a name that is too long
    if (fs::is_regular_file(file, ignored)) return file;
  }
  return {};
}

fs::path read_path(const YamlValue& value, const fs::path& folder) {
  const fs::path file = find_referenced(folder, value.text());
  if (file.empty()) {
    throw value.error("no file " + one_line(value.text()),
                      "a path relative to the scenario's folder or to the repository's root");
  }
  return file;
}

}  // namespace koboshi::sim
