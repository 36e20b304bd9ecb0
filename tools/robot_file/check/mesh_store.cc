#include "tools/robot_file/check/mesh_store.h"

#include <system_error>

namespace koboshi::tools {

const MeshStore::Entry& MeshStore::of(const std::filesystem::path& file) {
  std::error_code ignored;
  const State state{std::filesystem::file_size(file, ignored),
                    std::filesystem::last_write_time(file, ignored)};
  const auto [place, is_new] = entries_.try_emplace(file);
  auto& [known, entry] = place->second;
  if (!is_new && known == state) return entry;
  known = state;
  entry = {.stl = view::read_stl(file)};
  if (entry.stl.mesh) entry.faults = find_mesh_faults(*entry.stl.mesh);
  ++reads_;
  return entry;
}

}  // namespace koboshi::tools
